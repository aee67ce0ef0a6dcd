"""Systems defined incorrectly in Python: the message names the part, the rule and the remedy."""

from pathlib import Path

import pytest
import sympy as sp
from sympy.physics.mechanics import dynamicsymbols

import generated.double_pendulum as dp
from derive import (
    TIME,
    Coordinate,
    Derivation,
    Parameter,
    PointMass,
    System,
    load,
    velocity,
    write,
)
from derive.system.files.system_file import read_system
from derive.system.parts import SystemDefinitionError
from solvers import build

x, y, g, F = sp.symbols("x y g F", real=True)
m = sp.Symbol("m", positive=True)
moving = dynamicsymbols("x")


def system(**changes: object) -> System:
    parts = {
        "name": "bead",
        "title": "Bead",
        "coordinates": [Coordinate(x, "m", "")],
        "parameters": [Parameter(m, "kg", 1.0, ""), Parameter(g, "m/s^2", 9.8, "")],
        "masses": [PointMass(m, (x, x**2))],
    }
    return System(**(parts | changes))  # type: ignore[arg-type]


@pytest.mark.parametrize(("masses", "message"), [
    ([(m, (x, velocity(x)))],
     "position of mass m depends on x_dot: it must be a function of coordinates.* velocities"),
    ([(m, (x, sp.Symbol("p_x")))], "position of mass m depends on p_x: it must"),
    ([(m * x, (x, 0))], r"mass m\*x depends on x: it must be a function of parameters;.*pos"),
    ([(m * TIME, (x, 0))], r"mass m\*t depends on t: it must be a function of parameters"),
    ([(m, (x, sp.Symbol("x") ** 2))], "contains x as a symbol with other assumptions"),
    ([(m, (x, sp.cos(sp.Symbol("t"))))], r"contains t as a symbol .* time is derive\.TIME"),
])  # fmt: skip
def test_an_expression_depends_only_on_its_own_variables(
    masses: list[tuple[sp.Expr, tuple[sp.Expr, ...]]], message: str
) -> None:
    with pytest.raises(SystemDefinitionError, match=message):
        system(masses=[PointMass(*mass) for mass in masses])


@pytest.mark.parametrize("value", [
    1 + sp.I, sp.I * m, 2j, 1 + 2j, sp.oo, -sp.oo, sp.nan, sp.zoo * m, float("inf"), "m", True,
    sp.ImmutableMatrix([m, m]), sp.ImmutableMatrix([[m]]),
])  # fmt: skip
def test_values_are_finite_and_real(value: object) -> None:
    for mass, position in ((value, (x, 0)), (m, (x, value))):
        with pytest.raises(SystemDefinitionError, match="use finite real numbers and SymPy"):
            PointMass(mass, position)  # type: ignore[arg-type]
    with pytest.raises(SystemDefinitionError, match="use finite real numbers and SymPy"):
        system(potential=value, gravity=(0, -g))


@pytest.mark.parametrize(
    "value", [1 + 1j, "1", True, None, float("nan"), float("inf"), 10**400, -1, 0]
)
def test_the_default_of_a_mass_is_a_positive_number(value: object) -> None:
    with pytest.raises(SystemDefinitionError, match=r"the default of m is .*: give a positive"):
        Parameter(m, "kg", value, "")  # type: ignore[arg-type]
    if value in (-1, 0):
        assert Parameter(g, "m/s^2", value, "").default == value  # type: ignore[arg-type]


@pytest.mark.parametrize("symbol", ["x", moving, 1, sp.Symbol("z", imaginary=True), x + y])
def test_coordinates_and_parameters_are_real_symbols(symbol: object) -> None:
    with pytest.raises(SystemDefinitionError, match=r"is not a real symbol: declare Symbol\("):
        Coordinate(symbol, "m", "")  # type: ignore[arg-type]
    with pytest.raises(SystemDefinitionError, match="is not a real symbol"):
        Parameter(symbol, "m", 1.0, "")  # type: ignore[arg-type]


@pytest.mark.parametrize("value", [moving, moving.diff(sp.Symbol("t"))])
def test_functions_of_time_are_refused_with_the_symbols_to_use(value: sp.Expr) -> None:
    with pytest.raises(SystemDefinitionError, match=r"function of time: .*derive\.velocity\(x\)"):
        PointMass(m, (x, value))


@pytest.mark.parametrize(("changes", "message"), [
    ({"coordinates": [x]}, "coordinates contains x: give a list of Coordinate objects"),
    ({"parameters": {m: 1}}, "parameters contains m: give a list of Parameter objects"),
    ({"masses": [(m, (x, x))]}, r"masses contains \(m, .*: give a list of PointMass objects"),
    ({"masses": PointMass(m, (x, x))}, "masses = PointMass.* is not a sequence: give a list of"),
    ({"reactions": ["l"]}, "reactions contains 'l': give a list of Symbol objects"),
    ({"forces": F}, "forces = F is not a sequence: give one formula for each component"),
    ({"equilibrium": 0}, "equilibrium = 0 is not a sequence"),
    ({"gravity": -g}, "gravity = -g is not a sequence"),
])  # fmt: skip
def test_parts_of_a_system_are_lists_of_their_types(
    changes: dict[str, object], message: str
) -> None:
    with pytest.raises(SystemDefinitionError, match=message):
        system(**changes)


def test_a_mass_that_is_not_real_at_any_state_is_refused() -> None:
    cut = system(masses=[PointMass(m, (x + (x - 1000) ** sp.Rational(3, 2), 0))])
    with pytest.raises(SystemDefinitionError, match=r"'x' .* no inertia that is a positive"):
        Derivation(cut)


@pytest.mark.parametrize("force", [F, F * x, -F * velocity(x), F * sp.cos(TIME)])
def test_small_motions_with_an_applied_force_need_no_equilibrium(force: sp.Expr) -> None:
    parameters = [*system().parameters, Parameter(F, "N", 1.0, "")]
    pushed = Derivation(system(parameters=parameters, forces=[force]))
    for equilibrium in (None, (1,)):
        with pytest.raises(SystemDefinitionError, match=r"have applied forces: .*state_space"):
            pushed.linearisation(equilibrium)


def test_a_force_without_an_equilibrium_is_reported_as_such() -> None:
    ramp = Derivation(system(masses=[PointMass(m, (x, -x))]))
    with pytest.raises(SystemDefinitionError) as refusal:
        ramp.linearisation()
    assert str(refusal.value) == (
        "'bead' has no equilibrium: the force along x is g*m for all coordinates"
    )


def test_a_name_or_module_is_no_system(tmp_path: Path) -> None:
    for value in ("double_pendulum", tmp_path / "bead.toml", dp, None):
        with pytest.raises(SystemDefinitionError, match=r"is not a System: derive\.load returns"):
            Derivation(value)  # type: ignore[arg-type]
        with pytest.raises(SystemDefinitionError, match="is not a System"):
            build(value)  # type: ignore[arg-type]
        with pytest.raises(SystemDefinitionError, match="is not a System"):
            write(value, tmp_path)  # type: ignore[arg-type]


def test_a_system_file_is_given_by_text_or_path(tmp_path: Path) -> None:
    path = tmp_path / "bead.toml"
    path.write_text(
        'coordinates = { x = { unit = "m" } }\nparameters = { m = { value = 1, unit = "kg" } }\n'
        'masses = [{ mass = "m", position = ["x", "x**2"] }]\npotential = 0\n'
    )
    assert read_system(str(path)) == read_system(path) == load(str(path)) == load(path)
