"""Files of hand derivations: their names, columns in them, and marks of many files."""

import json
from itertools import product
from keyword import kwlist
from pathlib import Path

import pytest

from derive.verification.hand_derivation_files import EQUATIONS, judge
from solvers.app.cli import main
from solvers.io.toml_input import InputError

SPRING = 'system = "elastic_pendulum"\n'
PENDULUM = 'system = "single_pendulum"\n'
RIGHT, WRONG, ODD = "l*theta_ddot + g*sin(theta)", "l*theta_ddot - g*sin(theta)", "?"


def written(folder: Path, text: str, name: str = "page.toml") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


COLUMNS = ["(r_dot, r*theta_dot)", "(r,)", "[[r, theta], [1, 2]]"]
FORMULAS = ["v", "-v", "v**3", "sin(v)", "sqrt(v)", "exp(v_dot)", "1/v", "v/v"]


@pytest.mark.long("more cases of the same kind", keep=4)
@pytest.mark.parametrize(("column", "key"), [*product(COLUMNS, EQUATIONS)])
def test_columns_and_functions_of_them_are_unreadable(
    column: str, key: str, tmp_path: Path
) -> None:
    for formula in FORMULAS:
        text = {
            "euler_lagrange": f'["{formula} = 0", "m*r_ddot = {formula}"]',
            "momenta": f'{{ r = "{formula}" }}',
            "accelerations": f'{{ r = "{formula}" }}',
            "hamilton": f'{{ p_r = "{formula}" }}',
        }.get(key, f'"{formula}"')
        path = written(tmp_path, f'{SPRING}{key} = {text}\n[names]\nv = "{column}"\n')
        for equation in judge(path).equations:
            assert equation.verdict == "unreadable", equation


@pytest.mark.parametrize("energy", ["m*v**2/2", "m*v*v/2"])
def test_the_square_of_a_column_is_that_of_its_length(energy: str, tmp_path: Path) -> None:
    text = f'{SPRING}kinetic_energy = "{energy}"\n[names]\nv = "(r_dot, r*theta_dot)"\n'
    (equation,) = judge(written(tmp_path, text)).equations
    assert equation.verdict == "verified"
    (slip,) = judge(written(tmp_path, text.replace("r*theta", "2*r*theta"))).equations
    assert slip.verdict == "wrong"


@pytest.mark.parametrize("column", ["(1, 2)", "(l, k)", "[[1]]"])
def test_a_parameter_that_is_a_column_is_refused(column: str, tmp_path: Path) -> None:
    path = written(tmp_path, f'{SPRING}lagrangian = "r"\n[equal]\nm = "{column}"\n')
    with pytest.raises(InputError, match=r"page\.toml: equal\.m: .* is a column or matrix"):
        judge(path)


@pytest.mark.long("more cases of the same kind", keep=8)
@pytest.mark.parametrize("name", kwlist)
def test_a_word_of_python_can_be_a_name(name: str, tmp_path: Path) -> None:
    path = written(
        tmp_path,
        f"""{PENDULUM}
        lagrangian = "m*l**2*{name}_dot**2/2 + m*g*l*cos({name})"
        euler_lagrange = ["l*{name}_ddot + g*sin({name}) = 0", "l*{name}_ddot = g*sin({name})"]
        momenta = {{ {name} = "m*l**2*{name}_dot" }}
        names = {{ {name} = "theta" }}
    """,
    )
    *verified, wrong = sorted(judge(path).equations, key=lambda one: one.verdict)
    assert [one.verdict for one in verified] == ["verified"] * 3
    assert [one.wrong for one in wrong.corrections] == [f"g*sin({name})"]


def test_source_and_note_of_a_derivation_are_printed_before_its_verdicts(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    text = f'{PENDULUM}source = "A book, page 7"\nnote = "its angle is from hanging"\n'
    written(tmp_path, f'{text}euler_lagrange = ["{RIGHT} = 0"]\n')
    assert main(["verify", "page.toml"]) == 0
    first, second, third, *_ = capsys.readouterr().out.splitlines()
    assert first == "page.toml: single_pendulum: A book, page 7"
    assert second == "its angle is from hanging"
    assert "verified" in third


def test_a_greek_letter_has_one_name_in_all_its_shapes(tmp_path: Path) -> None:
    text = f'{PENDULUM}momenta = {{ "#" = "m*l**2*#_dot" }}\nnames = {{ "#" = "theta" }}'
    (equation,) = judge(written(tmp_path, text.replace("#", "\u03d5"))).equations
    assert equation.verdict == "verified"


@pytest.mark.parametrize("name", ["", "a b", "x-y", "2x", "x'"])
def test_a_name_that_no_formula_can_contain_is_refused(name: str, tmp_path: Path) -> None:
    path = written(tmp_path, f'{PENDULUM}lagrangian = "m"\n[names]\n"{name}" = "theta"\n')
    with pytest.raises(InputError, match=r"page\.toml: names: .* is no name: use letters, digits"):
        judge(path)


def test_every_message_about_a_file_names_the_file(tmp_path: Path) -> None:
    for text in (
        'names = { x = "y" }', 'equal = { m = "y" }', 'equal = { m = "0" }', 'equal = { k = "1" }',
        'momenta = { x = "1" }', "names = 3", "system = 1", "lagranian = 1", "note = [",
    ):  # fmt: skip
        head = "" if "system" in text else PENDULUM
        path = written(tmp_path, f"{head}lagrangian = 1\n{text}\n")
        with pytest.raises(InputError) as refusal:
            judge(path)
        assert str(refusal.value).count(str(path)) == 1


@pytest.fixture
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Files in the working folder with different marks; the last one is no TOML."""
    monkeypatch.chdir(tmp_path)
    contents = {
        "ada.toml": [RIGHT, RIGHT, WRONG],
        "a_name_that_is_much_longer_than_its_column.toml": [RIGHT, ODD],
        "emmy.toml": [RIGHT],
    }
    for name, equations in contents.items():
        text = f'{PENDULUM}source = "exercise 3"\neuler_lagrange = {equations}\n'
        written(tmp_path, text, name)
    written(tmp_path, "= 1", "broken.toml")
    return [*contents, "broken.toml"]


def test_many_files_end_with_a_table_of_marks(
    files: list[str], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    assert main(["verify", *files, "rotating_hoop"]) == 1
    output, errors = capsys.readouterr()
    assert "broken.toml is not valid TOML" in errors
    assert f"\n\n{files[2]}: single_pendulum: exercise 3\n" in output
    head, *rows = output.rpartition("\n\n")[2].splitlines()
    assert head.split() == ["file", "verified", "equivalent", "misprint", "wrong", "unreadable"]
    assert [row.split()[1:] for row in rows] == [
        ["2", "0", "0", "1", "0"],
        ["1", "0", "0", "0", "1"],
        ["1", "0", "0", "0", "0"],
        ["-"] * 5,
        ["1", "1", "0", "0", "0"],
        ["5", "1", "0", "1", "1"],
    ]
    assert all(len(row) <= 80 for row in rows)
    assert [row.split()[0] for row in rows[-2:]] == ["rotating_hoop", "total"]
    assert rows[1].startswith("...")
    assert "its_column.toml" in rows[1]
    assert main(["verify", *files[:1]]) == 1
    assert "total" not in capsys.readouterr().out
    assert main(["verify", *files[1:]]) == 2  # nothing is wrong, but two files are unreadable


def test_json_contains_the_name_of_each_file(
    files: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["verify", "--json", *files, "single_pendulum"]) == 1
    derivations = json.loads(capsys.readouterr().out)
    assert [one["file"] for one in derivations] == [*files[:3], "single_pendulum"]
    assert {one["system"] for one in derivations} == {"single_pendulum"}


def test_a_single_file_that_is_not_readable_prints_no_table(
    files: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["verify", files[3]]) == 2
    output, errors = capsys.readouterr()
    assert output == ""
    assert errors.startswith(f"holonomic verify: {files[3]} is not valid TOML")


@pytest.mark.parametrize("line", ["euler_lagrange = []", "momenta = {}", "accelerations = {}"])
def test_a_kind_of_equations_that_is_empty_is_refused(line: str, tmp_path: Path) -> None:
    path = written(tmp_path, f'{PENDULUM}lagrangian = "m*l**2*theta_dot**2/2"\n{line}\n')
    with pytest.raises(InputError, match=rf"page\.toml: {line.split()[0]} is empty: give at least"):
        judge(path)
