"""One file adds a target language: exports of functions and of simulations find it."""

import shutil
import subprocess
import sys
from collections.abc import Iterator
from math import pi
from pathlib import Path

import pytest

from derive import Simulation, export, load
from derive.codegen.export import targets
from derive.codegen.export.target import find_targets
from solvers.runge_kutta import method_catalogue

TARGET = '''
"""Perl: one file, with vectors as references to arrays."""

from derive.codegen.export.target import Target


class Perl(Target):
    """Subroutines."""

    title, suffix, command = "Perl", ".pl", "perl {file}"
    row = """
sub print_row {{
    my ($t, $values) = @_;
    print join(",", map {{ sprintf("%.17g", $_) }} ($t, @$values)), "\\\\n";
}}
"""
    main = 'print "{heading}\\\\n"; exit(simulate() ? 0 : 3);'
    comment, truth = "# {}", ("0", "1")
    variable = fixed = "my {name} = {value};"
    vector = "my {name} = [(0.0) x ({size})];"
    loop = "for (my {name} = {start}; {name} < {stop}; {name}++) {{"
    another, leave = "}} elsif ({test}) {{", "last;"
    element, conversion = "{name}->[{index}]", "{}"
    functions = {"floor": "POSIX::floor"}
    integer = real = "my ${name} = {value};"
    table = "my ${name} = [", "];"

    def name(self, name):
        return f"${name}"

    def head(self):
        return "use strict; use warnings; use POSIX ();"

    def signature(self):
        return f"sub {self.routine.name} {{"

    def declarations(self):
        yield f"my ({', '.join(map(self.name, self.routine.parameters))}) = @_;"


target = Perl
'''


@pytest.fixture
def perl(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """The name of a target whose file lies in a temporary folder."""
    folder = tmp_path / "languages"
    folder.mkdir()
    (folder / "perl.py").write_text(TARGET.lstrip())
    monkeypatch.setattr(targets, "__path__", [*targets.__path__, str(folder)])
    yield "perl"
    sys.modules.pop("derive.codegen.export.targets.perl", None)


def test_the_targets_that_ship_are_files_of_at_most_150_lines() -> None:
    files = {path.stem: path for path in Path(targets.__path__[0]).glob("[a-z]*.py")}
    assert set(files) == set(find_targets())
    assert max(len(path.read_text().splitlines()) for path in files.values()) <= 150


def test_it_is_listed_among_the_others_by_name(perl: str) -> None:
    found = [*find_targets()]
    assert perl in found
    assert found == sorted(found)


@pytest.mark.skipif(shutil.which("perl") is None, reason="needs Perl")
def test_its_simulation_has_the_bits_of_other_targets(perl: str, tmp_path: Path) -> None:
    method = method_catalogue.load("verner853")
    simulation = Simulation(method, (1, 1, 2, 2, 9.81), (pi / 2, pi, 0, 0), 5.0, samples=5)
    rows = []
    for target, program in ((perl, "perl"), ("python", sys.executable)):
        path = export(load("double_pendulum"), target, tmp_path, simulation=simulation)
        run = subprocess.run([program, path], capture_output=True, text=True, check=True)
        rows.append([[*map(float, line.split(","))] for line in run.stdout.splitlines()[1:]])
    assert rows[0] == rows[1]
    assert len(rows[0]) == 6


@pytest.mark.skipif(shutil.which("perl") is None, reason="needs Perl")
def test_its_functions_have_the_values_of_the_python_functions(perl: str, tmp_path: Path) -> None:
    import generated.double_pendulum as dp

    path = export(load("double_pendulum"), perl, tmp_path)
    y, params = [1.0, 2.0, 0.5, -0.3], list(dp.DEFAULTS)
    call = f"my $r = []; rhs_hamiltonian(0, {y}, {params}, $r); printf('%.17g ', $_) for @$r;"
    run = subprocess.run(
        ["perl", "-e", f"do '{path}'; {call}"], capture_output=True, text=True, check=True
    )
    assert tuple(map(float, run.stdout.split())) == dp.rhs_hamiltonian(0.0, y, params)
