"""Project files agree with each other: checks, targets, versions and dependencies."""

import re
import subprocess
import sys
import tomllib
from itertools import product
from pathlib import Path
from random import Random
from types import SimpleNamespace

import pytest
import yaml
from case_choice import cases_beyond, chosen_cases
from folders import ROOT


def read(name: str) -> str:
    return (ROOT / name).read_text(encoding="utf-8")


def test_the_commit_hook_runs_the_first_checks_of_ci() -> None:
    (repository,) = yaml.safe_load(read(".pre-commit-config.yaml"))["repos"]
    (hook,) = repository["hooks"]
    assert hook["entry"] == "make lint types"
    assert hook["entry"] in read(".ci/run").splitlines()
    assert hook["pass_filenames"] is False


def test_help_lists_every_target() -> None:
    command = ["make", "--silent", "help"]
    listed = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    targets = re.findall(r"^\.PHONY: (.*)$", read("Makefile"), re.MULTILINE)[0].split()
    assert [line.split()[0] for line in listed.splitlines()] == targets
    assert all(len(line.split()) > 1 for line in listed.splitlines())


def test_make_check_covers_ci() -> None:
    checked = read("Makefile").partition("\ncheck:")[2].partition("\n\n")[0]
    for line in read(".ci/run").splitlines():
        if line.startswith("make "):
            targets = {one for one in line.split()[1:] if not one.startswith(".")}
            assert targets <= {*checked.split(), "demo"}
        elif line.startswith(".venv/bin/holonomic"):
            assert line.removeprefix(".venv/bin/") in checked.replace("$(BIN)/", "")


def test_citation_package_and_changelog_agree() -> None:
    project = tomllib.loads(read("pyproject.toml"))["project"]
    citation = yaml.safe_load(read("CITATION.cff"))
    assert citation["version"] == project["version"]
    assert citation["license"] == project["license"]
    assert re.search(rf"^## {re.escape(project['version'])}\b", read("CHANGELOG.md"), re.MULTILINE)


def test_the_base_install_needs_four_packages() -> None:
    needed = tomllib.loads(read("pyproject.toml"))["project"]["dependencies"]
    names = [re.split(r"[<>=]", one)[0] for one in needed]
    assert names == ["sympy", "numpy", "scipy", "matplotlib"]


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize("library", ["CDLL", "PyDLL"])  # without and with Python's lock
def test_a_hang_in_compiled_code_fails(library: str, tmp_path: Path) -> None:
    file = tmp_path / "test_hang.py"
    file.write_text(f"import ctypes\n\ndef test_hang():\n    ctypes.{library}(None).sleep(60)\n")
    command = [sys.executable, "-m", "pytest", "-c", str(ROOT / "pyproject.toml"), str(file)]
    watchdog = ["-o", "faulthandler_timeout=1", "-p", "no:cacheprovider"]
    run = subprocess.run([*command, *watchdog], capture_output=True, text=True, timeout=50)
    assert run.returncode == 1
    assert "Timeout" in run.stderr
    assert "in test_hang" in run.stderr


def test_the_watchdog_ends_a_test_after_its_timeout(pytestconfig: pytest.Config) -> None:
    limits = [float(pytestconfig.getini(name)) for name in ("timeout", "faulthandler_timeout")]
    assert 0 < limits[0] < limits[1] <= 300


def test_cases_that_the_short_part_keeps_have_all_values_of_their_arguments() -> None:
    loops, forms, methods = ("python", "compiled"), ("q", "p", "z"), range(5)
    cases = [dict(zip("abc", one, strict=True)) for one in product(loops, forms, methods)]
    choices = set()
    for seed in range(20):
        kept = chosen_cases(cases, 5, Random(seed))
        assert len({*kept}) == 5
        assert [len({cases[k][name] for k in kept}) for name in "abc"] == [2, 3, 5]
        choices.add(frozenset(kept))
        # of fewer cases, too, no two agree as long as there is another value
        first, second = chosen_cases(cases, 2, Random(seed))
        assert all(cases[first][name] != cases[second][name] for name in "abc")
    assert len(choices) > 10
    assert {chosen_cases(cases, 1, Random(seed))[0] % 5 for seed in range(40)} == {*range(5)}
    assert sorted(chosen_cases(cases[:3], 7, Random(0))) == [0, 1, 2]
    assert chosen_cases(cases, 0, Random(0)) == []


def test_long_tests_run_their_daily_cases_with_those_of_the_short_part() -> None:
    class Case:
        """A case of a test, as pytest collects it."""

        def __init__(self, k: int, **counts: int) -> None:
            self.nodeid = f"test_a.py::test_{len(counts)}[{k}]"
            self.callspec = SimpleNamespace(params={"k": k})
            self.marks = {"long": pytest.mark.long("more cases", **counts)} if counts else {}

        def get_closest_marker(self, name: str) -> object:
            return self.marks.get(name)

    daily = [Case(k, keep=2, daily=5) for k in range(9)]
    whole = [Case(k, keep=2) for k in range(9)]
    plain = [Case(k) for k in range(9)]
    choices = set()
    for seed in "abcdefgh":
        short, long = (
            {*cases_beyond([*daily, *whole, *plain], key, seed)} for key in ("keep", "daily")
        )
        assert [len({*some} - short) for some in (daily, whole, plain)] == [2, 2, 9]
        assert [len({*some} - long) for some in (daily, whole, plain)] == [5, 9, 9]
        assert long < short
        choices.add(frozenset({*daily} - long))
    assert len(choices) > 4
