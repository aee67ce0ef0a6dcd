"""Chains and rings: operations grow with the number of bars, however their angles are measured."""

from functools import cache

import pytest
import trees
from sympy import Abs, Symbol, cos, sin, symbols

from derive import TIME, Coordinate, Derivation, Parameter, PointMass, System, load
from derive.codegen.module_functions import contents
from derive.mechanics.energies.kinematic_tree import _sums

m, l, g = symbols("m l g", positive=True)  # noqa: E741


def chain(n: int, *, relative: bool, pivot: object = 0) -> System:
    """A chain of pendulums; relative angles are measured from the rod before."""
    theta = symbols(f"theta1:{n + 1}", real=True)
    x, y, masses = pivot, 0, []
    for k in range(n):
        direction = sum(theta[: k + 1]) if relative else theta[k]
        x, y = x + l * sin(direction), y - l * cos(direction)
        masses.append(PointMass(m, (x, y)))
    values = [Parameter(s, "1", 1.0, "") for s in (m, l, g)]
    coordinates = [Coordinate(angle, "rad", "") for angle in theta]
    return System("chain", "chain", coordinates, values, masses)


@cache
def derived(n: int, *, relative: bool) -> Derivation:
    return Derivation(chain(n, relative=relative))


def operations(derivation: Derivation, name: str) -> int:
    (function,) = contents(derivation, [name]).functions
    return function.lowering.cost[0]


@pytest.mark.long("more cases of the same kind", keep=3)
@pytest.mark.parametrize("relative", [False, True])
@pytest.mark.parametrize("name", ["rhs", "rhs_rational", "energy", "inverse_dynamics"])
def test_operations_grow_linearly(name: str, *, relative: bool) -> None:
    # relative angles: 1,718 operations of the right-hand side at n = 7 by the dense mass matrix
    six, eight, ten = (operations(derived(n, relative=relative), name) for n in (6, 8, 10))
    assert ten - eight == eight - six
    assert ten < 750


@pytest.mark.parametrize(("system", "last", "updates"), [
    (trees.branching, "a1 + a2 + a3 + a4", 7 * 2**2),
    (trees.closed, "a1 + a2 + a3 + a4", 3 * 2**2),
    (trees.sliding, "s4", 4 * 3**2 + 3 * 2**2),
])  # fmt: skip
def test_branching_and_closed_chains_have_trees(system: System, last: str, updates: int) -> None:
    """Their values are compared with d'Alembert's principle in test_catalogue.

    Each elimination but that of the root changes the inertia along two directions, and the row of
    a length that changes.
    """
    tree = Derivation(system).tree
    assert tree is not None
    assert last in [variable.name for variable in tree.variables]
    assert tree.updates == updates


@pytest.mark.parametrize("relative", [False, True])
def test_the_mass_matrix_is_that_of_the_coordinates(*, relative: bool) -> None:
    # the oracle is the kinetic energy of the velocities
    derivation = Derivation(chain(6, relative=relative))
    values = {s: 0.3 + 0.1 * k for k, s in enumerate(derivation.system.q)}
    values |= {s: 0.7 - 0.2 * k for k, s in enumerate(derivation.system.qdot)}
    values |= {m: 1.3, l: 0.8, g: 9.8}
    squares = sum(m * velocity.dot(velocity) / 2 for velocity in derivation.velocities)
    assert derivation.tree is not None
    assert abs((derivation.kinetic_energy - squares).subs(values)) < 1e-13 * squares.subs(values)


@pytest.mark.parametrize(
    "system",
    [
        load("double_pendulum"),
        chain(6, relative=True, pivot=sin(TIME)),
        chain(6, relative=True, pivot=Abs(Symbol("theta1", real=True))),
    ],
)
def test_short_and_driven_chains_have_none(system: System) -> None:
    assert Derivation(system).tree is None


def test_coordinates_that_move_no_mass_are_named() -> None:
    angle = Symbol("beta", real=True)
    whole = chain(6, relative=True)
    coordinates = [*whole.coordinates, Coordinate(angle, "rad", "")]
    system = System("idle", "idle", coordinates, whole.parameters, whole.masses)
    with pytest.raises(ValueError, match=r"coordinate 'beta' .* moves no mass"):
        Derivation(system)


def test_of_equally_frequent_sums_one_is_chosen_in_every_process() -> None:
    x, y = symbols("x y", real=True)
    waves = [sin(x + y), sin(2 * x + y), sin(y), sin(y - x), sin(3 * x + y)]
    orders = (waves, waves[::-1], waves[2:] + waves[:2])
    chosen = [_sums((x, y), [(m, (wave, sin(x))) for wave in order]) for order in orders]
    assert chosen[0] == chosen[1] == chosen[2]
