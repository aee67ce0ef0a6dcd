"""The command line: its output and its exit codes."""

import json
import os
import re
import subprocess
import sys
import warnings
from pathlib import Path

import pytest
from folders import ROOT
from sharing import Shared

from derive.verification.report import contexts
from derive.verification.report.equation import ReportEquation
from solvers.app import report_verdicts as report
from solvers.app.cli import COMMANDS, command_parser, main
from solvers.app.commands import verify
from solvers.app.commands.options import shipped
from solvers.app.report_verdicts import counted, report_verdicts, tables
from solvers.runge_kutta.order_conditions import order


@pytest.fixture(scope="module")
def verdicts(shared: Shared) -> dict[str, list[dict[str, str]]]:
    return shared("report_verdicts", report_verdicts)


def test_help_lists_every_command_and_each_command_shows_an_example(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main([]) == 0
    text = capsys.readouterr().out
    with pytest.raises(SystemExit, match="0"):
        main(["--help"])
    assert capsys.readouterr().out == text
    assert all(f"  {name} " in text for name in COMMANDS)
    for name in COMMANDS:
        with pytest.raises(SystemExit, match="0"):
            main([name, "--help"])
        examples = re.search(r"^(examples?):\n((?:  .+\n)+)", capsys.readouterr().out, re.MULTILINE)
        assert examples is not None
        lines = examples[2].splitlines()
        assert all(line.startswith(f"  holonomic {name}") for line in lines)
        assert examples[1] == ("examples" if len(lines) > 1 else "example")
        for line in lines:
            (program, *arguments), *_ = map(str.split, re.split(r" {2,}| > ", line.strip()))
            assert program == "holonomic"
            assert command_parser().parse_args(arguments).command == name


@pytest.mark.parametrize(("command", "kind"), [
    ("run", "scenes"), ("chart", "scenes"), ("stability", "scenes"), ("sweep", "sweeps"),
])  # fmt: skip
def test_help_describes_each_scene_and_sweep_that_ships(
    command: str,
    kind: str,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    with pytest.raises(SystemExit, match="0"):
        main([command, "--help"])
    listed = capsys.readouterr().out.partition(f"\n{kind}:\n")[2]
    rows = dict(re.findall(r"^  (\w+) +(\w.*(?:\n {5}.*)*)", listed, re.MULTILINE))
    assert tuple(rows) == shipped(kind)
    assert len({*rows.values()}) == len(rows)
    assert all(len(description.split()) >= 5 for description in rows.values())
    assert all(len(line) <= 80 for line in listed.splitlines())


def test_every_file_of_a_command_is_a_command() -> None:
    files = {path.stem for path in (ROOT / "solvers" / "app" / "commands").glob("*.py")}
    assert files - {"__init__", "options"} == {*COMMANDS}


def test_help_and_completion_load_no_numerical_package() -> None:
    code = (
        "import sys; from solvers.app.cli import main; main(sys.argv[1:]);"
        "print(*({'sympy', 'numpy', 'scipy', 'matplotlib'} & {*sys.modules}), file=sys.stderr)"
    )
    for arguments in ([], ["--version"], ["--print-completion", "bash"]):
        run = subprocess.run(
            [sys.executable, "-c", code, *arguments], capture_output=True, text=True, check=True
        )
        assert run.stdout
        assert run.stderr == "\n"


def test_a_shipped_system_runs_without_sympy(tmp_path: Path) -> None:
    code = (
        "import sys; from solvers.app.cli import main; main(sys.argv[1:]);"
        "print('sympy' in sys.modules, file=sys.stderr)"
    )
    argv = [sys.executable, "-c", code, "run", "single", "--output", str(tmp_path)]
    run = subprocess.run(argv, capture_output=True, text=True, check=True)
    assert run.stderr == "False\n"


@pytest.mark.parametrize(
    ("words", "completions"),
    [
        (["ve"], ["verify"]),
        (["run", "sepa"], ["separatrix"]),
        (["sweep", "fl"], ["flips"]),
        (["derive", "double_p"], ["double_pendulum"]),
        (["run", "report", "--j"], ["--json"]),
    ],
)
def test_a_shell_completes_commands_options_and_names(
    words: list[str], completions: list[str], capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    pytest.importorskip("shtab", reason="needs: pip install shtab")
    assert main(["--print-completion", "bash"]) == 0
    script = capsys.readouterr().out + (
        f"COMP_WORDS=(holonomic {' '.join(words)}); COMP_CWORD={len(words)}\n"
        f'_shtab_holonomic holonomic {words[-1]}; printf "%s\\n" "${{COMPREPLY[@]}}"'
    )
    run = subprocess.run(
        ["bash", "-c", script], capture_output=True, text=True, check=True, cwd=tmp_path
    )
    assert run.stdout.split() == completions


def test_completion_without_its_extra_names_the_extra(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "shtab", None)
    assert main(["--print-completion", "zsh"]) == 4
    message = "holonomic: shtab is not installed: pip install 'holonomic[completion]'\n"
    assert capsys.readouterr().err == message


def test_a_film_plays_at_the_speed_of_the_motion_by_default() -> None:
    assert command_parser().parse_args(["run", "report"]).speed == 1.0


def test_an_unknown_command_or_option_is_invalid_input(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit, match="2"):
        main(["verifi"])
    error = capsys.readouterr().err
    assert "invalid choice: 'verifi'" in error
    assert error.endswith("(did you mean 'verify'?)\n")
    with pytest.raises(SystemExit, match="2"):
        main(["verify", "--yaml"])


def test_verify_prints_json_with_every_verdict(
    capsys: pytest.CaptureFixture[str],
    verdicts: dict[str, list[dict[str, str]]],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(report, "report_verdicts", lambda: verdicts)
    assert main(["verify", "--json"]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert {"id", "verdict", "correction", "residual"} <= set(printed["equations"][0])
    assert len(printed["equations"]) == 150
    assert len(printed["programs"]) == 3
    assert {claim["verdict"] for claim in printed["claims"]} == {
        "supported",
        "contradicted",
        "untestable",
    }
    misprint = next(e for e in printed["equations"] if e["id"] == "eq64")
    assert misprint["verdict"] == "misprint"
    assert "phi2_dot**2" in misprint["correction"]
    assert "theta1_dot**2 - theta2_dot**2" in misprint["residual"]
    states = [one["state"] for one in printed["equations"] if one.get("state")]
    names = [[number.partition(" = ")[0] for number in state.split(", ")] for state in states]
    assert max(map(len, names)) > 9
    # the same order in every process, whatever its hashes are
    order = [*contexts.NUMBERS, "p_theta1", "p_theta2"]
    assert all(row == sorted(row, key=order.index) for row in names)


def test_verify_prints_a_table_that_fits_the_terminal(
    verdicts: dict[str, list[dict[str, str]]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    lines = tables(verdicts).splitlines()
    assert all(len(line) <= 80 for line in lines if " " in line.strip()[:40])
    assert f"equations: {counted(verdicts['equations'])}" in lines
    assert sum(line.startswith("eq") for line in lines) >= 128
    monkeypatch.setenv("COLUMNS", "100")
    figures = [one["figure"] for one in verdicts["claims"] if one["figure"]]
    shown = re.findall(r"see (holonomic \w+)", tables(verdicts))
    assert 4 <= len(shown) == len(figures)


def test_the_readme_of_verification_states_the_numbers_of_verdicts(
    verdicts: dict[str, list[dict[str, str]]],
) -> None:
    text = (ROOT / "derive" / "verification" / "README.md").read_text(encoding="utf-8")
    equations, claims = (
        counted(verdicts[name]).rstrip(")").replace(" (", " | ") for name in ("equations", "claims")
    )
    stopped = sum(bool(program["stops"]) for program in verdicts["programs"])
    assert f"| equations | {equations} |" in text
    assert f"| programs | {len(verdicts['programs'])} | {stopped} do not run" in text
    assert f"| objectives, claims and recommendations | {claims} |" in text


def test_verify_fails_if_an_equation_is_wrong_without_a_proved_correction(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from derive.verification.report import report_judgement

    wrong = ReportEquation(
        "eq47", r"x_1 = l_1 \cos \theta_1", changes=((r"l_1 \cos", r"l_2 \sin"),)
    )
    assert report_judgement.verdict(wrong, order).verdict == "wrong"
    monkeypatch.setattr(report_judgement, "EQUATIONS", {"eq47": wrong})
    for name in ("objectives", "claims", "recommendations"):  # which do not count
        monkeypatch.setattr(report, name, lambda *_: [])
    assert main(["verify"]) == 1
    assert "wrong" in capsys.readouterr().out


def test_an_output_folder_that_cannot_be_created_is_reported_before_the_work(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "file").write_text("")
    assert main(["demo", "--output", str(tmp_path / "file")]) == 4
    shown = capsys.readouterr()
    assert str(tmp_path / "file") in shown.err
    assert shown.out == ""


def test_a_broken_system_ends_with_2_and_is_named(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    from derive import systems

    (tmp_path / "broken_one.py").write_text("system = undefined\n")
    (tmp_path / "broken_two.py").write_text("sytsem = 1\n")
    monkeypatch.setattr(systems, "__path__", [*systems.__path__, str(tmp_path)])
    for name, message in (("broken_one", "NameError"), ("broken_two", "AttributeError")):
        assert main(["derive", name, "--check"]) == 2
        shown = capsys.readouterr().err
        assert f"{name}.py does not define a system: {message}" in shown


@pytest.mark.parametrize(
    ("error", "code"),
    [
        (KeyboardInterrupt(), 130),
        (ValueError("v"), 2),
        (ArithmeticError("a"), 3),
        (MemoryError("m"), 3),
        (OSError("o"), 4),
    ],
)
def test_the_exit_code_states_the_kind_of_error(
    error: BaseException,
    code: int,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    def failing(_: object) -> int:
        raise error

    monkeypatch.setattr(verify, "run", failing)
    assert main(["verify"]) == code
    output = capsys.readouterr()
    assert output.out == ""
    assert output.err == (f"holonomic verify: {error}\n" if str(error) else "")


def test_a_closed_pipe_causes_no_traceback() -> None:
    command = f"'{Path(sys.executable).parent}/holonomic' derive --check single_pendulum"
    run = subprocess.run(
        f"{command} | true; echo ${{PIPESTATUS[0]}}",
        shell=True,
        executable="/bin/bash",
        capture_output=True,
        text=True,
        cwd=ROOT,
        check=False,
        env=os.environ | {"PYTHONUNBUFFERED": "1"},
    )
    assert "Traceback" not in run.stderr
    assert run.stdout in ("0\n", "141\n")


def test_a_warning_is_printed_once_and_the_process_keeps_its_own_display(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def noisy(_: object) -> int:
        for _ in range(3):
            with warnings.catch_warnings():  # which resets the registry of shown warnings
                warnings.warn("integrating in Python: reason", stacklevel=1)
        return 0

    monkeypatch.setattr(verify, "run", noisy)
    before = warnings.showwarning, list(warnings.filters)
    assert main(["verify"]) == 0
    assert (warnings.showwarning, list(warnings.filters)) == before
    assert capsys.readouterr().err == "holonomic verify: integrating in Python: reason\n"


@pytest.mark.parametrize("words", [["help"], ["help", "run"]])
def test_help_is_a_command_as_well(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    printed = []
    for argv in (words, [*words[1:], "--help"]):
        with pytest.raises(SystemExit) as exit_:
            main(argv)
        assert exit_.value.code == 0
        printed.append(capsys.readouterr().out)
    assert printed[0] == printed[1] != ""


def test_the_nearest_option_is_suggested(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["run", "report", "--outptu", "x"])
    assert "--outptu x (did you mean '--output'?)" in capsys.readouterr().err
