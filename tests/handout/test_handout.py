"""Documents of derivations: right formulas, in three formats, with exercises and their keys."""

import json
import re
import shutil
import subprocess
import sys
from dataclasses import replace
from functools import cache
from html.parser import HTMLParser
from importlib import import_module
from pathlib import Path

import nbformat
import pytest
import sympy as sp
from folders import ROOT

from derive import Derivation, Parameter, load, names
from derive.commands.regenerate import main
from derive.formulas.expression import FUNCTIONS, parse
from derive.formulas.generic_values import STATES, sample
from derive.formulas.numeric import Evaluator
from derive.handout.derivation_document import document, write_document
from derive.handout.derived_letters import DerivedLetters
from derive.handout.document_model import Code, HandoutDocument, NumberedEquation, Paragraph
from derive.handout.exercises import planted, with_exercises
from derive.handout.formats.notebook import notebook
from derive.handout.formats.page import BLANK, page
from derive.handout.formats.tex import declarations, tex
from derive.handout.numbering import Numbering

#: A system with friction, a driving force, a spring, and letters of derived quantities.
DAMPED = """
title = "Pendulum on a sprung & driven cart, 100 % friction, θ < 180°"
dissipation = "c*x_dot**2/2 + gamma_p*theta_dot**2/2"
potential = "k*x**2/2"
gravity = ["0", "-g"]
forces = { x = "F*cos(omega*t)" }
[coordinates]
x = { unit = "m", meaning = "position of the `cart`_#1" }
theta = {}
[parameters]
M = { value = 2, unit = "kg" }
m = { value = 1, unit = "kg" }
L = { value = "1/2", unit = "m" }
k = { value = 10, unit = "N/m" }
c = { value = 0.1, unit = "N s/m" }
gamma_p = { value = 0.1, unit = "N m s" }
F = { value = 1, unit = "N", meaning = "force, Łódź naïve 力" }
omega = { value = 3, unit = "rad/s" }
g = { value = 9.81, unit = "m/s^2" }
[[masses]]
mass = "M"
position = ["x", "0"]
[[masses]]
mass = "m"
position = ["x + L*sin(theta)", "-L*cos(theta)"]
"""
L_SYS = sp.Symbol("L_sys", positive=True)
WRITERS = {"html": page, "ipynb": notebook, "tex": tex}
SYSTEMS = (*names(), "damped")

needs_latex = pytest.mark.skipif(shutil.which("pdflatex") is None, reason="needs pdflatex")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("handout")
    (folder / "damped.toml").write_text(DAMPED, encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def derivation(folder: Path):
    @cache
    def derived(name: str) -> Derivation:
        return Derivation(load(folder / "damped.toml" if name == "damped" else name))

    return derived


@pytest.fixture(scope="module")
def documents(derivation):
    return cache(lambda name: document(derivation(name)))


def compiled(folder: Path, text: str) -> str:
    """The log of LaTeX, which fails the test at an error."""
    (folder / "document.tex").write_text(text, encoding="utf-8")
    command = ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "document.tex"]
    run = subprocess.run(command, cwd=folder, capture_output=True, check=False)
    log = run.stdout.decode(errors="replace")
    assert run.returncode == 0, log[-2000:]
    return log


class Tags(HTMLParser):
    """The elements of a page, which must be closed in order."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.attributes: list[tuple[str, str | None]] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.attributes += attrs
        if tag not in ("link", "meta", "mspace"):
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert tag == "mspace" or self.open.pop() == tag


@pytest.mark.long("more cases of the same kind", keep=5)
@pytest.mark.parametrize("name", SYSTEMS)
def test_formulas_are_numbered_without_gaps(documents, name: str) -> None:
    numbers = [equation.number for equation in documents(name).equations]
    assert numbers == [*range(1, len(numbers) + 1)]
    assert len(numbers) > 15


@pytest.mark.long("more cases of the same kind", keep=8)
@pytest.mark.parametrize("name", SYSTEMS)
def test_every_number_is_in_every_format(documents, name: str) -> None:
    count = len([*documents(name).equations])
    texts = {suffix: writer(documents(name)) for suffix, writer in WRITERS.items()}
    for number in range(1, count + 1):
        assert texts["html"].count(f'id="formula-{number}"') == 1
        assert texts["tex"].count(rf"\tag{{{number}}}") == 1
        assert texts["ipynb"].count(rf"\\tag{{{number}}}") == 1


@pytest.mark.long("more cases of the same kind", keep=8)
@pytest.mark.parametrize("name", SYSTEMS)
def test_a_page_is_one_file_of_balanced_elements(documents, name: str) -> None:
    tags = Tags(page(documents(name)))
    assert tags.open == []
    assert [pair for pair in tags.attributes if pair[0] in ("src", "href")] == [("href", "data:,")]


@pytest.mark.long("more cases of the same kind", keep=8)
@pytest.mark.parametrize("name", SYSTEMS)
def test_a_notebook_is_valid(documents, name: str) -> None:
    nbformat.validate(nbformat.reads(notebook(documents(name)), as_version=4))


@pytest.mark.long("other tests reach its code")
@pytest.mark.slow
def test_the_cells_of_a_notebook_run(documents, derivation) -> None:
    from nbclient import NotebookClient

    import generated.double_pendulum as dp

    executed = nbformat.reads(notebook(documents("double_pendulum")), as_version=4)
    NotebookClient(executed, timeout=60).execute()
    (output,) = executed.cells[-2].outputs
    assert output.data["text/plain"] == repr(dp.rhs(0, (0.1,) * 4, dp.DEFAULTS))


@pytest.mark.parametrize("name", names())
def test_the_python_code_has_the_values_of_the_generated_module(documents, name: str) -> None:
    module = __import__(f"generated.{name}", fromlist=["rhs"])
    codes = [b for s in documents(name).sections for b in s.blocks if isinstance(b, Code)]
    namespace: dict[str, object] = {}
    for code in codes:
        if code.is_executable:
            exec(code.text, namespace)
    state = namespace["y"]
    assert namespace["rhs"](0.3, state, namespace["params"]) == module.rhs(
        0.3, state, module.DEFAULTS
    )  # type: ignore[operator]


@needs_latex
@pytest.mark.slow
@pytest.mark.parametrize("name", [*SYSTEMS, "chain_5"])
def test_latex_compiles_and_nothing_is_wider_than_the_page(documents, tmp_path, name) -> None:
    log = compiled(tmp_path, tex(documents(name)))
    assert "Overfull" not in log
    assert "Undefined" not in log


def test_characters_beyond_ascii_are_declared_in_latex() -> None:
    assert declarations(["é ł θ ² 力 –"]) == [
        r"\DeclareUnicodeCharacter{00B2}{\ensuremath{^{2}}}",
        r"\DeclareUnicodeCharacter{00E9}{\'{e}}",
        r"\DeclareUnicodeCharacter{0142}{\l{}}",
        r"\DeclareUnicodeCharacter{03B8}{\ensuremath{\theta}}",
        r"\DeclareUnicodeCharacter{529B}{[U+529B]}",
    ]


def test_tables_repeat_their_heads_on_every_page(documents) -> None:
    text = tex(documents("double_pendulum"))
    assert "coordinate & unit & meaning \\\\\n\\hline\n\\endhead\n$\\theta_1$ & rad &" in text


@pytest.mark.parametrize(("name", "words"), [
    ("spherical_pendulum", "The momentum `p_phi` of the cyclic coordinate `phi` is constant."),
    ("heavy_top", "of the cyclic coordinates are constant."),
])  # fmt: skip
def test_cyclic_coordinates_are_one_or_several(documents, name: str, words: str) -> None:
    paragraphs = [
        block.text
        for section in documents(name).sections
        for block in section.blocks
        if isinstance(block, Paragraph)
    ]
    assert any(words in text for text in paragraphs)


@needs_latex
@pytest.mark.slow
@pytest.mark.parametrize("kind", ["blank", "mistakes"])
def test_latex_with_exercises_compiles(documents, tmp_path: Path, kind) -> None:
    for one in with_exercises(documents("damped"), kind, 0):
        assert "Overfull" not in compiled(tmp_path, tex(one))


def test_letters_of_the_system_are_not_those_of_derived_quantities(documents, derivation) -> None:
    left = {side for equation in documents("damped").equations for side in equation.before}
    assert {"T", "V", "M_sys", "L_sys", "E"} <= left
    system = derivation("damped").system
    assert not {s.name for s in system.params} & left
    taken = replace(system, parameters=[*system.parameters, Parameter(L_SYS, "m", 1.0, "")])
    assert DerivedLetters(taken).letter("L") == "L_sys2"


def test_a_matrix_that_is_too_wide_is_written_by_entries(documents) -> None:
    text = tex(documents("chain_5"))
    assert r"M_{15} & =" in text
    assert r"K_{0,15} & =" not in text  # zero
    assert "The solution is too long to read" in text


def test_a_value_of_very_many_parts_does_not_fit_on_a_line() -> None:
    numbering = Numbering(DerivedLetters(load("single_pendulum")))
    theta = sp.Symbol("theta")
    assert numbering.fits(sp.Add(*[theta] * 9, evaluate=False))
    assert not numbering.fits(sp.Matrix([[0] * 5_000]))


@pytest.mark.parametrize(("width", "last"), [(9, "G_29"), (10, "G_2_10")])
def test_entries_of_wide_matrices_have_names_that_are_read_in_one_way(
    width: int, last: str
) -> None:
    long = sum(sp.symbols("theta:30"))
    blocks = [*Numbering(DerivedLetters(load("chain_3"))).rows("G", sp.ones(2, width) * long)]
    names = [one.before[0] for one in blocks if isinstance(one, NumberedEquation)]
    assert (len(names), names[-1]) == (2 * width, last)


@pytest.mark.parametrize(
    "name", ["single_pendulum", "spherical_pendulum", "driven_pendulum", "henon_heiles", "duffing"]
)
def test_sentences_hold_for_the_numbers_of_the_generated_module(documents, name: str) -> None:
    module = import_module(f"generated.{name}")
    blocks = [block for section in documents(name).sections for block in section.blocks]
    text = " ".join(block.text for block in blocks if isinstance(block, Paragraph))
    n = len(module.COORDINATES)
    masses = module.positions(0.0, [0.1] * (2 * n), module.DEFAULTS)
    assert ("The positions of the masses" in text) == (len(masses) > 1)
    assert ("The position of the mass" in text) == (len(masses) == 1)
    assert ("with the mass matrix" in text) == (n > 1)
    assert ("with the inertia" in text) == (n == 1)
    is_conservative = not hasattr(module, "power")
    assert ("The energy of a motion is constant" in text) == is_conservative
    state = [0.3 + 0.1 * k for k in range(2 * n)]
    positions = [module.positions(t, state, module.DEFAULTS) for t in (0.0, 0.7)]
    assert ("Jacobi's integral" in text) == (positions[0] != positions[1])
    for k, q in enumerate(module.COORDINATES):
        turned = [y + (i == k) for i, y in enumerate(state)]
        energies = [module.energy(0.0, y, module.DEFAULTS) for y in (state, turned)]
        is_cyclic = energies[0] == pytest.approx(energies[1], rel=1e-14)
        assert (f"the momentum `p_{q}` is constant" in text) == (is_cyclic and is_conservative)


SENTENCES = {
    "potential energy is that of the weight": {
        "single_pendulum",
        "double_bar_pendulum",
        "heavy_top",
    },
    "potential energy includes that of the weight": {"elastic_pendulum"},
    "potential energy belongs to the definition": {"henon_heiles", "chaplygin_sleigh"},
    "half its moment of inertia times the square": {"double_bar_pendulum", "chaplygin_sleigh"},
    "and the energy of its rotation": {"heavy_top"},
    "These are centres of mass of rigid bodies": {
        "double_bar_pendulum",
        "chaplygin_sleigh",
        "heavy_top",
    },
    "that are not integrable": {"chaplygin_sleigh"},
    "Lagrangian of the other coordinates": {"heavy_top"},
}


def test_sentences_stand_where_they_apply(documents) -> None:
    for name in sorted(set().union(*SENTENCES.values())):
        blocks = [block for section in documents(name).sections for block in section.blocks]
        text = " ".join(block.text for block in blocks if isinstance(block, Paragraph))
        for sentence, systems in SENTENCES.items():
            assert (sentence in text) == (name in systems), (name, sentence)


def test_reasons_are_given_where_there_are_no_normal_modes(documents) -> None:
    assert "have applied forces." in page(documents("damped"))
    assert "There are no normal modes: small motions of" in page(documents("foucault_pendulum"))
    assert "no equilibrium at" in page(documents("swinging_atwood"))
    assert "the mass matrix is not positive definite" in page(documents("spherical_pendulum"))


def test_normal_modes_have_the_frequencies_of_textbooks(documents) -> None:
    (row,) = modes(documents("single_pendulum"))
    assert row[:2] == (f"{9.81 / 2:.4g}", f"{(9.81 / 2) ** 0.5:.4g}")
    cart = modes(documents("cart_3"))
    assert cart[0] == ("0", "none", "none", "1, 0, 0, 0")  # the cart moves freely


def test_characteristic_equations_are_those_of_two_coordinates(documents) -> None:
    sentence = "of a normal mode solves this equation"
    assert sentence in page(documents("double_pendulum"))
    assert len(modes(documents("chain_3"))) == 3
    assert sentence not in page(documents("chain_3"))


def modes(one: HandoutDocument) -> tuple[tuple[str, ...], ...]:
    (section,) = (section for section in one.sections if section.title == "Small oscillations")
    rows: tuple[tuple[str, ...], ...] = section.blocks[-1].rows  # type: ignore[union-attr]
    return rows


# exercises


@pytest.mark.long("more cases of the same kind", keep=12)
@pytest.mark.parametrize("name", SYSTEMS)
def test_blank_exercises_show_no_derived_formula(documents, name: str) -> None:
    exercises, key = with_exercises(documents(name), "blank", 0)
    blank = {equation.number for equation in exercises.equations if equation.is_blank}
    assert blank == {equation.number for equation in key.equations}
    for equation in exercises.equations:
        assert equation.is_blank != (equation.is_given or equation.value is None)
    solutions = {equation.number: equation for equation in documents(name).equations}
    assert all(solutions[equation.number] == equation for equation in key.equations)
    for writer in WRITERS.values():
        assert not any(isinstance(b, Code) for s in exercises.sections for b in s.blocks)
        assert writer(exercises) != writer(documents(name))
    assert page(exercises).count(BLANK) == len(blank)
    assert BLANK not in page(documents(name))


def test_blank_exercises_state_the_constraints(documents, derivation) -> None:
    exercises, _ = with_exercises(documents("four_bar"), "blank", 0)
    stated = [equation.value for equation in exercises.equations if not equation.is_blank]
    conditions = derivation("four_bar").system.conditions
    assert conditions
    assert all(one.formula in stated for one in conditions)


def test_blank_exercises_state_the_positions_from_which_all_follows(documents, derivation) -> None:
    exercises, key = with_exercises(documents("double_pendulum"), "blank", 0)
    requested = [equation.value for equation in key.equations]
    stated = [equation.value for equation in exercises.equations if not equation.is_blank]
    system = derivation("double_pendulum").system
    velocities = [sp.Matrix(mass.position).jacobian(system.q) * sp.Matrix(system.qdot)
        for mass in system.masses]  # fmt: skip
    for mass, velocity in zip(system.masses, velocities, strict=True):
        assert sp.Matrix(mass.position) in stated
        assert velocity in requested


@pytest.mark.long("more cases of the same kind", keep=3, daily=24)
@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize("name", SYSTEMS)
def test_every_planted_mistake_is_wrong_and_its_key_right(documents, name, seed: int) -> None:
    exercises, key = with_exercises(documents(name), "mistakes", seed)
    right = {equation.number: equation for equation in documents(name).equations}
    answers = {equation.number: equation for equation in key.equations}
    for equation in exercises.equations:
        solution = right[equation.number]
        if equation.number in answers:
            assert answers[equation.number] == solution
            assert differs(solution, equation)
            assert is_similar(solution, equation)
            assert not solution.is_given
        else:
            assert equation == solution
            assert f"({equation.number})" in exercises.sections[0].blocks[0].text  # type: ignore[union-attr]
    derived = [e for e in right.values() if e.value is not None and not e.is_given]
    assert {e.number for e in derived} - {*answers} <= {e.number for e in derived if is_zero(e)}


def is_zero(equation: NumberedEquation) -> bool:
    return bool(sp.Matrix([equation.value]).is_zero_matrix)


def differs(right: NumberedEquation, wrong: NumberedEquation) -> bool:
    """Whether values differ at a generic state; also from every multiple where they are zero."""
    difference = sp.Matrix([wrong.value]) - sp.Matrix([right.value])
    for index in range(STATES):
        values = Evaluator(sample([*right.order.kinds], index))
        if not all(values(entry).is_zero for entry in difference):
            return True
    return False


def is_similar(right: NumberedEquation, wrong: NumberedEquation) -> bool:
    """Whether no entry is much longer or shorter than the right one."""
    pairs = zip(sp.Matrix([right.value]), sp.Matrix([wrong.value]), strict=True)
    return all(abs(a.count_ops() - b.count_ops()) <= 2 for a, b in pairs)


def test_the_key_names_the_part_that_is_wrong_and_the_right_one(documents) -> None:
    exercises, key = with_exercises(documents("double_pendulum"), "mistakes", 0)
    right, wrong = ({e.number: e for e in one.equations} for one in (key, exercises))
    blocks = key.sections[0].blocks
    texts = [block.text for block in blocks if isinstance(block, Paragraph)]
    assert len(texts) == len(right)
    for text in texts:
        number, *parts = re.findall(r"\((\d+)\).*`(.*)` instead of `(.*)`\.", text)[0]
        solution, exercise = right[int(number)], wrong[int(number)]
        namespace = FUNCTIONS | {symbol.name: symbol for symbol in solution.order.kinds}
        bad, good = (parse(part, namespace) for part in parts)
        assert exercise.value.has(bad)
        assert solution.value.has(good)


def test_all_kinds_of_mistakes_are_planted(documents) -> None:
    (lagrangian,) = (e for e in documents("double_pendulum").equations if e.before[0] == "L")
    mistakes = [planted(lagrangian, str(seed)) for seed in range(30)]
    assert {mistake.kind for mistake in mistakes if mistake} == {
        "sign",
        "index",
        "power",
        "function",
        "factor",
    }


def test_no_planted_mistake_lets_a_formula_vanish(derivation) -> None:
    """With equal indices of the masses, three operations are gone."""
    order = DerivedLetters(derivation("double_pendulum").system).order
    symbols = {s.name: s for s in order.kinds}
    value = symbols["m1"] * symbols["g"] - symbols["m2"] * symbols["g"]
    for seed in map(str, range(20)):
        mistake = planted(NumberedEquation(1, ("F",), value, (), order), seed)
        assert mistake is not None
        assert mistake.equation.value != 0


def test_a_formula_without_values_has_no_mistake(derivation) -> None:
    order = DerivedLetters(derivation("single_pendulum").system).order
    theta = next(s for s in order.kinds if s.name == "theta")
    value = theta / (sp.sin(theta) ** 2 + sp.cos(theta) ** 2 - 1)
    assert planted(NumberedEquation(1, ("F",), value, (), order), "0") is None


def test_a_multiple_of_zero_and_another_zero_of_energy_are_no_mistakes(derivation) -> None:
    order = DerivedLetters(derivation("rotating_hoop").system).order
    symbols = {s.name: s for s in order.kinds}
    zero = NumberedEquation(1, (), symbols["R"] * symbols["theta_ddot"], ("0",), order)
    for seed in map(str, range(20)):
        mistake = planted(zero, seed)
        assert mistake is None or mistake.kind == "power"
    potential = NumberedEquation(
        1, ("V",), symbols["R"] - symbols["R"] * sp.cos(symbols["theta"]), (), order
    )
    for seed in map(str, range(20)):
        mistake = planted(potential, seed)
        assert mistake is not None
        assert (mistake.equation.value - potential.value).has(symbols["theta"])


@pytest.mark.long("three documents, each in another process")
def test_equal_seeds_give_equal_bytes_and_others_give_others(tmp_path: Path) -> None:
    def written(seed: str, hash_seed: str) -> list[str]:
        command = [sys.executable, "-m", "derive", "single_pendulum", "--document", "sheet.tex"]
        subprocess.run(
            [*command, "--exercises", "mistakes", "--seed", seed],
            cwd=tmp_path,
            env={"PYTHONHASHSEED": hash_seed, "PYTHONPATH": str(ROOT)},
            check=True,
        )
        return [(tmp_path / f"sheet{end}.tex").read_text() for end in ("", "_key")]

    first = written("1", "1")
    assert written("1", "2") == first
    assert written("2", "1") != first


# the command


@pytest.mark.parametrize("suffix", WRITERS)
def test_the_command_writes_a_document_and_the_key_of_its_exercises(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], suffix: str
) -> None:
    path = tmp_path / "new" / f"pendulum.{suffix}"
    assert main(["single_pendulum", "--document", str(path)]) == 0
    assert main(["single_pendulum", "--document", str(path), "--exercises", "blank"]) == 0
    key = path.with_name(f"pendulum_key.{suffix}")
    assert capsys.readouterr().out == f"wrote {path}\nwrote {path}\nwrote {key}\n"
    assert {*path.parent.iterdir()} == {path, key}  # nothing temporary
    if suffix == "ipynb":
        assert json.loads(key.read_text())["nbformat"] == 4


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["single_pendulum", "--document", "a.pdf"], "known are .html, .tex, .ipynb"),
        (["single_pendulum", "--document", "a"], "the suffix '' names no format"),
        (["--document", "a.tex"], "takes one system, got none"),
        (["chain_1", "chain_2", "--document", "a.tex"], "takes one system, got chain_1, chain_2"),
        (["single_pendulum", "--document", "a.tex", "--check"], "omit --check and --output"),
        (["single_pendulum", "--document", "a.tex", "--output", "b"], "omit --check and"),
        (["single_pendulum", "--exercises", "blank"], "name its file with --document FILE"),
        (["single_pendulum", "--seed", "1"], "name its file with --document FILE"),
        (["single_pendulum", "--document", "a.tex", "--seed", "1"], "add --exercises mistakes"),
        (["chain_11", "--document", "a.tex"], "at most 10 are allowed"),
        (["singel_pendulum", "--document", "a.tex"], "did you mean"),
    ],
)
def test_options_that_do_not_fit_are_refused(
    arguments: list[str], message: str, capsys, tmp_path: Path, monkeypatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(arguments) == 2
    assert message in capsys.readouterr().err
    assert [*tmp_path.iterdir()] == []


def test_a_file_that_cannot_be_written_is_named(tmp_path: Path, capsys) -> None:
    (tmp_path / "file").write_text("")
    assert main(["single_pendulum", "--document", str(tmp_path / "file" / "a.tex")]) == 4
    error = capsys.readouterr().err
    assert str(tmp_path / "file") in error
    assert "with --document" in error


def test_both_files_of_exercises_are_complete_before_one_is_replaced(
    derivation, tmp_path: Path, monkeypatch
) -> None:
    path = tmp_path / "a.tex"
    path.write_text("before")
    (tmp_path / "a_key.tex").mkdir()  # which no file replaces
    with pytest.raises(OSError, match="directory"):
        write_document(derivation("single_pendulum"), path, "blank")
    assert {p.name for p in tmp_path.iterdir()} == {"a.tex", "a_key.tex"}
