"""The command line: what it prints, and with which code it ends."""

import json
import os
import subprocess
import sys
import warnings
from collections import Counter
from pathlib import Path

import pytest

from derive.verification.report.equation import Equation
from solvers.app import cli
from solvers.app.cli import COMMANDS, main
from solvers.app.tables import counted, report
from solvers.runge_kutta.order_conditions import order

ROOT = Path(__file__).parent.parent


@pytest.fixture(scope="module")
def judged() -> dict[str, list[dict[str, str]]]:
    return cli.judgement()


def test_help_names_every_command_and_each_command_shows_an_example(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main([]) == main(["--help"]) == 0
    shown = capsys.readouterr().out
    assert all(f"  {name}" in shown for name in COMMANDS)
    for name in COMMANDS:
        with pytest.raises(SystemExit, match="0"):
            main([name, "--help"])
        shown = capsys.readouterr().out
        assert "example" in shown
        assert f"  holonomic {name}" in shown


def test_an_unknown_command_or_option_is_bad_input(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["verifi"]) == 2
    assert "unknown command 'verifi'" in capsys.readouterr().err
    with pytest.raises(SystemExit, match="2"):
        main(["verify", "--yaml"])


def test_verify_prints_json_with_every_verdict(
    capsys: pytest.CaptureFixture[str],
    judged: dict[str, list[dict[str, str]]],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(cli, "judgement", lambda: judged)
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


def test_verify_prints_a_table_for_people_within_the_width_of_the_terminal(
    judged: dict[str, list[dict[str, str]]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    lines = report(judged).splitlines()
    assert all(len(line) <= 80 for line in lines if " " in line.strip()[:40])
    assert f"equations: {counted(judged['equations'])}" in lines
    assert sum(line.startswith("eq") for line in lines) >= 128


def test_readme_states_the_verdicts_as_they_are(
    judged: dict[str, list[dict[str, str]]],
) -> None:
    text = " ".join((ROOT / "README.md").read_text(encoding="utf-8").split())
    equations, claims = (
        Counter(row["verdict"] for row in judged[name]) for name in ("equations", "claims")
    )
    stopped = sum(bool(program["stops"]) for program in judged["programs"])
    assert f"{equations['verified']} hold, {equations['misprint']} are misprints" in text
    assert f"{equations['definition']} are definitions and {equations['context']} concern" in text
    assert f"three programs {stopped} would not run" in text
    assert (
        f"{claims.total()} objectives, claims and recommendations {claims['supported']} hold, "
        f"{claims['contradicted']} do not, and {claims['untestable']} cannot"
    ) in text


def test_verify_fails_where_an_equation_is_neither_right_nor_mended(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from derive.verification.report import judgement

    wrong = Equation("eq47", "x1 = l1*cos(theta1)", corrected="x1 = l2*sin(theta1)")
    assert judgement.verdict(wrong, order).verdict == "wrong"
    monkeypatch.setattr(judgement, "EQUATIONS", (wrong,))
    assert main(["verify"]) == 1
    assert "wrong" in capsys.readouterr().out


def test_a_place_that_cannot_be_written_to_is_named_before_the_work(
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


def test_an_interrupted_command_ends_with_130(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(_: object) -> int:
        raise KeyboardInterrupt

    monkeypatch.setitem(COMMANDS, "verify", interrupted)
    assert main(["verify"]) == 130


def test_a_reader_who_leaves_early_causes_no_traceback() -> None:
    run = subprocess.run(
        f"{Path(sys.executable).parent}/holonomic derive --check | true; echo ${{PIPESTATUS[0]}}",
        shell=True, executable="/bin/bash", capture_output=True, text=True, cwd=ROOT, check=False,
        env=os.environ | {"PYTHONUNBUFFERED": "1"},
    )  # fmt: skip
    assert "Traceback" not in run.stderr
    assert run.stdout in ("0\n", "141\n")


def test_a_notice_is_told_once_however_often_it_comes(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def noisy(_: object) -> int:
        for _ in range(3):
            with warnings.catch_warnings():  # which forgets what was told
                warnings.warn("integrating in Python: why", stacklevel=1)
        return 0

    monkeypatch.setitem(COMMANDS, "verify", noisy)
    with warnings.catch_warnings():
        assert main(["verify"]) == 0
    assert capsys.readouterr().err == "holonomic verify: integrating in Python: why\n"
