"""Mistakes in sweep files are reported with the key, its value and the allowed values."""

import json
import tomllib
from contextlib import suppress
from dataclasses import MISSING, fields
from pathlib import Path

import pytest
from sweep_file import FILE, write_sweep

from solvers.app.cli import main
from solvers.app.modules import load as load_module
from solvers.io import figures
from solvers.io.toml_input import InputError
from solvers.sweeps.definition import map_kinds
from solvers.sweeps.definition.axes import Random
from solvers.sweeps.definition.map_table import MapTable
from solvers.sweeps.definition.sweep_reading import find


@pytest.mark.parametrize(("change", "words"), [
    (('"double_pendulum"', '"double_pendlum"'), "no system is called|did you mean"),
    (("duration", "duratoin"), "no key 'duratoin' .did you mean 'duration'"),
    (("duration = 30", ""), "duration is missing: give that of each motion"),
    (("duration = 30", 'duration = "30 kg"'), "duration: '30 kg' has another unit"),
    (("duration = 30", "duration = -1"), "duration = -1.0 must be positive"),
    (("[axes]", "[axis]"), "no key 'axis' .did you mean 'axes'"),
    (("theta1 = {", "theta3 = {"), "'theta3' .did you mean"),
    (("from = -3, to = 3, count = 120", "from = -3, to = 3"), "axes.theta1.count is missing"),
    (("from = -3, to = 3, count = 120", "from = -3, count = 120"), "axes.theta1.to is missing"),
    (("count = 120", "count = 1.5"), "count = 1.5 must be a whole number"),
    (("count = 120", "count = 0"), "count = 0 must be a whole number from 1"),
    (("count = 120", "cuont = 120"), "no key 'cuont'"),
    (('kind = "final"', 'kind = "finl"'), "kind = 'finl' .did you mean 'final'.. must be"),
    (('kind = "final"', 'kind = "first"'), "maps.end.of = .* must be a table"),
    (('kind = "final"', 'kind = "section"\ncount = 3'), "where = None must be one of theta1"),
    (('kind = "final"', 'kind = "samples"'), "maps.end.count is missing"),
    (('kind = "final"', 'kind = "final"\nbarrier = []'), "no key 'barrier'"),
    (('kind = "final"\nof = ["theta1", "theta2"]',
      'kind = "first"\nof = { theta1 = 3 }\nbarrier = []'),
     "maps.end.barrier = .. must list positions, or be left out"),
    (('of = ["theta1", "theta2"]', 'of = ["theta1", "thta2"]'), "'thta2' .did you mean 'theta2'"),
    (('of = ["theta1", "theta2"]', ""), "maps.end.of = .. must list different components"),
    (("[maps.end]", "rtol = true\n[maps.end]"), "no key 'rtol'|rtol"),
    (("[axes]", "method = 5\n[axes]"), "method = 5 must be a text in quotes"),
    (("[axes]", 'method = "rk4"\n[axes]'), "does not estimate its error: use one of bs32"),
    (("[axes]", "max_steps = 0\n[axes]"), "max_steps = 0 must be a whole number from 1"),
    (('kind = "final"', 'kind = ["final"]'), "kind = .'final'. must be one of"),
    (('kind = "final"', ""), "maps.end.kind is missing"),
    (('kind = "final"\nof = ["theta1", "theta2"]', 'kind = "first"\nof = {}'), "`of` is empty"),
    (('of = ["theta1", "theta2"]', 'of = ["theta1", "theta1"]'), "must list different components"),
    (('"final"\nof = ["theta1", "theta2"]', '"extremes"\nof = ["theta1_dot"]'),
     "theta1_dot is not a coordinate: extremes are those of theta1, theta2"),
    (("[maps.end]", '[maps.x]\nkind = "section"\ncount = 1\nwhere = "theta1"\n'
      'direction = ["up"]\n[maps.end]'), "direction = .'up'. must be one of up"),
    (("[maps.end]", f'[maps.{"x" * 60}]\nkind = "lyapunov"\n[maps.end]'), "up to 50 letters"),
    (("[maps.end]", '[maps.theta2]\nkind = "lyapunov"\n[maps.end]'), "cannot be a map's name"),
    (("count = 120", "count = 1000000000000"), "must be a whole number from 1 to 10000000"),
    (('kind = "final"', 'kind = "samples"\ncount = 1000000000'), "from 1 to 1000000"),
    (("[axes]", 'method = "rk44"\n[axes]'), "no method is called 'rk44'"),
    (('kind = "final"\nof = ["theta1", "theta2"]', 'kind = "first"\nof = { theta3 = 1 }'),
     "maps.end.of has no key 'theta3'"),
    (('kind = "final"', 'kind = "stroboscopic"\ncount = 1\nevery = [1]'),
     "every: .1. is no number"),
    (("[axes]", "random = { count = 5 }\n[axes]"), "axes.theta1 has no key 'count'"),
    (("[axes]", "[initial]\ntheta1 = 1\n[axes]"), "theta1 varies and has the value 1"),
    (("[axes]", "[parameters]\nl9 = 1\n[axes]"), "no key 'l9'; known are m1"),
    (("system", "system = [[["), "is not valid TOML"),
])  # fmt: skip
def test_a_mistake_in_a_sweep_file_is_reported(
    change: tuple[str, str], words: str, tmp_path: Path
) -> None:
    text = FILE.replace(*change, 1)
    assert text != FILE
    path = write_sweep(tmp_path, text)
    with pytest.raises(InputError, match=words) as refusal:
        find(str(path), load_module)
    assert str(path) in str(refusal.value)


@pytest.mark.parametrize(("table", "words"), [
    ("", "must have names in its first line"),
    ("theta1,theta2\n", "must have names in its first line"),
    ("theta1,theta2\n1,2\n1\n", "as many numbers"),
    ("theta1,theta2\n1,two\n", "theta2: unit 'two' is not known"),
    ("theta1,tehta2\n1,2\n", "'tehta2' .did you mean 'theta2'"),
    ("theta1,theta1\n1,2\n", "has a duplicate name"),
    ('theta1,theta2\n1,"' + "2" * 200_000, "is no table in UTF-8"),
])  # fmt: skip
def test_a_mistake_in_a_table_of_axes_is_reported(table: str, words: str, tmp_path: Path) -> None:
    (tmp_path / "starts.csv").write_text(table)
    begin, end = FILE.index("[axes]"), FILE.index("[maps")
    path = write_sweep(tmp_path, FILE[:begin] + 'axes = "starts.csv"\n' + FILE[end:])
    with pytest.raises(InputError, match=words):
        find(str(path), load_module)


def test_the_command_reports_unknown_sweeps_and_options(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sweep", "filps"]) == 2
    assert "did you mean 'flips'" in capsys.readouterr().err
    assert main(["sweep", "none.toml"]) == 2
    assert "none.toml: there is no such file" in capsys.readouterr().err
    assert main(["sweep", "flips", "--workers", "0"]) == 2
    assert "workers = 0 must be from 1" in capsys.readouterr().err


@pytest.mark.parametrize(("steps", "code"), [(1, 3), (100_000, 0)])
def test_the_command_ends_with_a_code_where_no_motion_succeeds(
    steps: int,
    code: int,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr(figures, "save", lambda *_: None)
    text = FILE.replace("count = 120", "count = 2").replace("duration = 30", "duration = 1")
    path = write_sweep(tmp_path, f"max_steps = {steps}\n{text}")
    assert main(["sweep", str(path), "--json", "--output", str(tmp_path / "out")]) == code
    ends = json.loads(capsys.readouterr().out)["status"]
    assert ends == {"finished" if code == 0 else "step limit": 4}


def test_random_axes_have_the_count_and_the_seed_of_the_file(tmp_path: Path) -> None:
    text = FILE.replace(", count = 120", "")
    for count, seed, line in ((5, 0, ""), (5, 7, "seed = 7"), (1, 0, "")):
        random = f"[random]\ncount = {count}\n{line}\n[axes]"
        axes = find(str(write_sweep(tmp_path, text.replace("[axes]", random))), load_module).axes
        assert axes == Random({"theta1": (-3, 3), "theta2": (-3, 3)}, count, seed)


def test_keys_that_may_be_omitted_have_the_defaults_of_python() -> None:
    omitted = {}
    for name in map_kinds.names():
        kind = map_kinds.load(name)
        given = tomllib.loads(f"example = {{ {kind.example} }}")["example"]
        module = load_module("duffing" if "every" in kind.example else "double_pendulum")
        for field in fields(kind):
            if field.name in given and field.default is not MISSING:
                table = {key: value for key, value in given.items() if key != field.name}
                with suppress(InputError):  # a key that a file must have
                    read = kind.read(MapTable("maps.a", module, table))
                    omitted[name, field.name] = getattr(read, field.name) == field.default
    assert len(omitted) >= 9
    assert all(omitted.values())
