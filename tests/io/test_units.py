"""Quantities that the package prints can be given back to it, in every unit."""

import re
from importlib import import_module
from pathlib import Path
from types import ModuleType

import pytest
import sympy as sp
from sympy.physics import units as si

import generated
import generated.free_body as free_body
from derive import load
from derive.codegen.module_summary import units
from solvers import consistent_start, integrate, run_scene
from solvers import load as load_module
from solvers.app.cli import main
from solvers.equations.module import has_constraints, inputs
from solvers.io.figure_names import axis_label
from solvers.io.quantity import (
    MAX_LENGTH,
    UNITS,
    QuantityError,
    dimension,
    formula,
    quantity,
    with_unit,
)
from solvers.scenes.scene_output import summary
from solvers.sweeps.definition import map_kinds

NUMBERS = (100, 0.1, -1.5e-05, 2e20)


def printed_units() -> set[str]:
    modules = (import_module(f"generated.{name}") for name in generated.__all__)
    return {unit for module in modules for unit in module.UNITS.values()}


@pytest.mark.parametrize("unit", sorted(printed_units()))
def test_every_unit_of_a_system_that_ships_is_read(unit: str) -> None:
    for number in NUMBERS:
        assert quantity(f"{number} {unit}", unit) == number


SURFACE = """
coordinates = { A = { unit = "m^2" }, s = { unit = "1" }, v = { unit = "m s" } }
parameters = { c = { value = 1, unit = "W s/m^(1/2)" }, m = { value = 1, unit = "kg" } }
masses = [{ mass = "m", position = ["A + c*s", "v", "s"] }]
potential = 0
"""


def test_every_unit_of_a_system_file_is_read(tmp_path: Path) -> None:
    path = tmp_path / "surface.toml"
    path.write_text(SURFACE)
    for unit in units(load(path)).values():
        for number in NUMBERS:
            assert quantity(f"{number} {unit}", unit) == number


@pytest.mark.parametrize("units", ["m cm mm km", "kg g", "s ms us min", "rad deg turn"])
def test_units_of_a_quantity_have_its_dimension(units: str) -> None:
    first, *others = units.split()
    assert {dimension(unit)[1] for unit in others} == {dimension(first)[1]}


BASE, RADIAN = [si.meter, si.kilogram, si.second], sp.Symbol("rad")
DEFINITIONS = {
    "1": sp.S.One, "m": si.meter, "cm": si.centimeter, "mm": si.millimeter, "km": si.kilometer,
    "kg": si.kilogram, "g": si.gram, "s": si.second, "ms": si.millisecond, "us": si.microsecond,
    "μs": si.microsecond, "min": si.minute, "h": si.hour, "rad": RADIAN,
    "deg": RADIAN * sp.pi / 180, "turn": 2 * sp.pi * RADIAN, "rpm": 2 * sp.pi * RADIAN / si.minute,
    "N": si.newton, "kN": si.kilo * si.newton, "J": si.joule, "kJ": si.kilo * si.joule,
    "W": si.watt, "kW": si.kilo * si.watt,
}  # fmt: skip


@pytest.mark.parametrize("name", UNITS)
def test_units_have_the_sizes_and_dimensions_of_another_program(name: str) -> None:
    """Against `sympy.physics.units`."""
    in_base = sp.sympify(si.convert_to(DEFINITIONS[name], BASE)).as_powers_dict()
    size, powers = dimension(name)
    assert powers == tuple(in_base.pop(unit, 0) for unit in (*BASE, RADIAN))
    assert size == pytest.approx(float(sp.Mul(*(x**n for x, n in in_base.items()))), rel=1e-15)


@pytest.mark.parametrize(("text", "unit", "value"), [
    ("100 N s/m", "N s/m", 100),
    ("100 N*s/m", "N s/m", 100),
    ("0.1 N s/mm", "N s/m", 100),
    ("2 kg m^2/s", "J s", 2),
    ("3 N m s", "J s", 3),
    ("1/2 J s/(m^2)", "kg/s", 0.5),
    ("4 N/(m s)", "N*s^-1/m", 4),
    ("250 us", "ms", 0.25),
    ("250 µs", "s", 250e-6),
    ("7 W", "kg m^2 s^-3", 7),
    ("5 1/s", "1/s", 5),
    ("2*pi rad", "turn", 1),
    ("pi", "rad", 3.141592653589793),
    ("1/2 furlong", "furlong", 0.5),
])  # fmt: skip
def test_units_are_products_and_quotients(text: str, unit: str, value: float) -> None:
    assert quantity(text, unit) == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize(("text", "words"), [
    ("5 N/m s", r"'N/m s' is ambiguous: .* brackets, as in N/\(m s\)"),
    ("5 kg m/s", "has another unit: give N s/m"),
    ("5 N furlong/m", "unit 'N furlong/m' is not known: use m, cm"),
    ("5 N s/(m", "has another unit"),
    ("5 N s m)", "is no number"),
    ("N s/m", "is no number"),
    ("5 N s/m 3", "is no number"),
])  # fmt: skip
def test_other_units_are_refused(text: str, words: str) -> None:
    with pytest.raises(QuantityError, match=words):
        quantity(text, "N s/m")


def test_a_formula_has_a_largest_length() -> None:
    longest = "1".rjust(MAX_LENGTH)
    assert formula(longest, {}) == 1
    with pytest.raises(QuantityError, match=f"longer than a formula: {MAX_LENGTH + 1} characters"):
        formula(f" {longest}", {})


def read_back(listed: str, module: ModuleType) -> dict[str, float]:
    """States such as ``theta = 0.1 rad, theta_dot = 2 rad/s``."""
    pairs = re.findall(r"(\w+) = ([^,]+)", listed)
    return {name: quantity(text, module.UNITS[name]) for name, text in pairs}


@pytest.mark.parametrize("system", generated.__all__)
def test_the_printed_parameters_of_a_system_are_read(
    system: str, capsys: pytest.CaptureFixture[str]
) -> None:
    module = load_module(system)
    assert main(["systems", system]) == 0
    listed = " ".join(capsys.readouterr().out.partition("parameters: ")[2].split())
    listed = listed.partition(" inputs: ")[0]
    constants = dict(zip(module.PARAMETERS, module.DEFAULTS, strict=True))
    expected = {name: x for name, x in constants.items() if name not in inputs(module)}
    assert read_back(listed, module) == expected


@pytest.mark.long("more cases of the same kind", keep=8)
@pytest.mark.parametrize("system", generated.__all__)
def test_the_printed_state_of_a_solution_is_read(system: str) -> None:
    module = load_module(system)
    y0 = [0.1 * k for k, _ in enumerate(module.STATE, 4)]
    if has_constraints(module):
        y0 = consistent_start(module, {}, {}, guess=y0).y.tolist()
    solution = integrate(module, (0, 0.01), y0, {}, backend="python")
    listed = repr(solution).rpartition("s: ")[2]
    expected = dict(zip(module.STATE, solution.y[:, -1], strict=True))
    assert read_back(listed, module) == pytest.approx(expected, rel=1e-5)


@pytest.mark.parametrize("scene", ["rest", "small", "single", "spring"])
def test_the_printed_state_and_times_of_a_scene_are_read(scene: str) -> None:
    result = run_scene(scene)
    text = "\n".join(summary(result))
    listed = re.findall(r"final state: (.*)", text)[0]
    error = max(10 * result.selection.model.error_estimate, 1e-14)
    assert read_back(listed, result.scene.module) == pytest.approx(result.final_state, abs=error)
    seconds = re.findall(r"[\d.e-]+ [muµ]?s\b", text)
    assert len(seconds) >= 3
    assert all(quantity(each, "s") > 0 for each in seconds)


def test_the_unit_1_is_not_printed() -> None:
    assert with_unit(-0.25, "1") == "-0.25"
    assert with_unit(1 / 3, "kg m", 3) == "0.333 kg m"
    assert axis_label("w", "1") == "w"
    state = (1.0, 0.0, 0.0, 0.0, *[0.0] * 4)
    motion = integrate(free_body, (0, 1), state, free_body.DEFAULTS)
    for text in (repr(motion), repr(consistent_start(free_body, state, {}))):
        assert "w = 1" in text
        assert not re.search(r"= \S+ 1(,|$)", text)


def test_units_of_maps_are_read() -> None:
    kinds = map(map_kinds.load, map_kinds.names())
    own = {kind.own_unit for kind in kinds} - {""}
    assert own == {"s", "1/s", "J"}
    for unit in own:
        assert quantity(f"5 {unit}", unit) == 5
