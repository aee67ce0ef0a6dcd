"""Springs near rest: energies and forces keep their relative accuracy at any amplitude."""

import random
from collections.abc import Iterator, Sequence
from types import ModuleType

import numpy as np
import pytest
import sympy as sp
from mpmath import mpf, workdps

from derive import Coordinate, Derivation, Parameter, PointMass, System, load, names
from derive.mechanics.specialisation import specialised
from solvers.app.modules import build
from solvers.app.modules import load as load_module
from solvers.equations.forms import Form

EPS = float(np.finfo(float).eps)
AMPLITUDES = (1e-3, 1e-5, 1e-7, 1e-9, 1e-10)

#: Roundings of sines, squares and quotients, in units of ε; a cancelled difference has thousands.
FEW = 20

#: Systems of springs and weights; the force of duffing's spring is a polynomial.
SPRINGS = [
    n for n in names() if n != "duffing" and any(p.unit == "N/m" for p in load(n).parameters)
]


def assert_exact(results: Sequence[float], exact: Sequence[mpf]) -> None:
    for result, value in zip(results, exact, strict=True):
        assert abs(result - value) <= FEW * EPS * abs(value)


def states(rest: Sequence[float], amplitude: float) -> Iterator[tuple[float, ...]]:
    generator = random.Random(3)
    for _ in range(10):
        # of alternating sign, so that displacements do not cancel
        changes = [(-1) ** k * amplitude * generator.uniform(0.5, 1) for k in range(2 * len(rest))]
        yield tuple(q + c for q, c in zip((*rest, *[0.0] * len(rest)), changes, strict=True))


def check(
    module: ModuleType,
    system: System,
    params: Sequence[float],
    rest: Sequence[float],
    amplitude: float,
) -> None:
    """Compare with 50 digits of the system's own potential and of its accelerations."""
    derivation = Derivation(system)
    symbols, n = [*system.q, *system.qdot, *system.params], len(system.q)
    formulas = [derivation.kinetic_energy + system.potential_energy]
    formulas += [-system.potential_energy.diff(q) for q in system.q]
    exact = sp.lambdify(symbols, formulas, "mpmath", cse=True)
    accelerations = sp.lambdify(symbols, list(derivation.accelerations), "mpmath", cse=True)
    for y in states(rest, amplitude):
        still = (*y[:n], *[0.0] * n)
        with workdps(50):
            energy = exact(*map(mpf, [*y, *params]))[0]
            forces = exact(*map(mpf, [*still, *params]))[1:]
            rates = accelerations(*map(mpf, [*still, *params]))
        canonical = module.hamiltonian_state(0.0, y, params)
        assert_exact([module.energy(0.0, y, params)], [energy])
        assert_exact([module.energy_hamiltonian(0.0, canonical, params)], [energy])
        assert_exact(module.rhs_hamiltonian(0.0, still, params)[n:], forces)
        assert_exact(module.rhs(0.0, still, params)[n:], rates)
        if "rational" in module.FORMS:
            form = Form(module, "rational", params)
            assert_exact(form.rhs(0.0, form.from_ordinary(0.0, np.array(still)))[-n:], rates)


@pytest.mark.long("more cases of the same kind", keep=8)
@pytest.mark.parametrize("amplitude", AMPLITUDES)
@pytest.mark.parametrize("k", [1.0, 1e8])
@pytest.mark.parametrize("name", SPRINGS)
def test_springs_of_systems_that_ship_are_right_near_rest(
    name: str, k: float, amplitude: float
) -> None:
    module = load_module(name)
    # without weight, whose energy is much larger than that of the motion
    params = module.params(k=k, g=0.0)
    check(module, load(name), params, module.equilibrium(params), amplitude)


def test_the_systems_with_springs_are_found() -> None:
    assert SPRINGS == ["coupled_pendulums", "elastic_pendulum"]


@pytest.mark.parametrize("amplitude", AMPLITUDES)
def test_pendulums_with_weight_and_a_spring_are_right_near_rest(amplitude: float) -> None:
    module, system = load_module("coupled_pendulums"), load("coupled_pendulums")
    rates = sp.lambdify(
        [*system.q, *system.qdot, *system.params],
        list(Derivation(system).accelerations),
        "mpmath",
        cse=True,
    )
    for y in states((0.0, 0.0), amplitude):
        with workdps(50):
            exact = rates(*map(mpf, [*y, *module.DEFAULTS]))
        assert_exact(module.rhs(0.0, y, module.DEFAULTS)[2:], exact)


x, y = sp.symbols("x y", real=True)
d, length = sp.symbols("d length", positive=True)


@pytest.mark.long("more cases of the same kind", keep=7)
@pytest.mark.parametrize("spring", [
    sp.sqrt((d + x) ** 2 + y**2) - d,
    d - sp.sqrt((y - d) ** 2 + x**2),
    3 * sp.sqrt(d**2 + x**2 + y**2) - 3 * d,
    sp.sqrt((2 * d + x) ** 2 + y**2) - 2 * d,
    sp.sqrt((d + x) ** 2 + y**2) - length,  # parameters that happen to be equal
    sp.sqrt((1 + x) ** 2 + y**2) - 1,
    y - x,
    (x - y) * (x + y),
])  # fmt: skip
@pytest.mark.parametrize("amplitude", AMPLITUDES)
def test_springs_of_one_s_own_are_right_near_rest(spring: sp.Expr, amplitude: float) -> None:
    own = System(
        name="own",
        title="",
        coordinates=[Coordinate(x, "m", ""), Coordinate(y, "m", "")],
        parameters=[Parameter(s, "m", 1.5, "") for s in (d, length)],
        masses=[PointMass(1, (x, y))],
        potential=spring**2 / 2,
    )
    module = build(own)
    check(module, own, module.DEFAULTS, (0.0, 0.0), amplitude)
    fixed = specialised(own, {"d": 1.5, "length": 1.5})
    check(build(fixed), fixed, (), (0.0, 0.0), amplitude)
