"""Every system of the catalogue, at generic states, against mechanics without Lagrange.

The oracle is d'Alembert's principle: along a path q(t) with the accelerations of the generated
module, Σ m r̈·∂r/∂q + ∂V/∂q is the applied force and the reactions of constraints, with every
derivative taken numerically of positions and constraints, in 50 digits.
"""

import inspect
import re
from collections.abc import Callable, Iterator
from functools import cache, partial
from importlib.util import module_from_spec, spec_from_file_location
from itertools import combinations, pairwise
from operator import mul
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
import strange
import sympy as sp
import trees
from mpmath import diff, fdot, mpf, workdps
from numpy.testing import assert_allclose
from scipy.optimize import minimize

import generated
from derive import TIME, PointMass, RigidBody, System, load, names, reduced, systems, write
from derive.system.files.shipped import large_names
from derive.system.files.system_catalogue import description, drawing
from solvers.app.cli import main
from solvers.app.modules import load as load_module
from solvers.equations.consistent_start import consistent_start
from solvers.equations.forms import Form
from solvers.equations.module import has_constraints

SYSTEMS = Path(systems.__path__[0])
#: Lines of a system's definition, and of one with many bodies.
LINES, LINES_OF_LARGE = 25, 60
#: Systems that are not in the catalogue.
OTHERS = {one.name: one for one in (strange.system, trees.branching, trees.closed, trees.sliding)}
Case = tuple[float, list[float], list[float]]


@pytest.fixture(params=[*names(), *large_names(), *OTHERS])
def name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture(scope="module")
def other_module(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], ModuleType]:
    """Modules of systems that are not in the catalogue."""

    @cache
    def written(name: str) -> ModuleType:
        path = write(OTHERS[name], tmp_path_factory.mktemp(name))
        spec = spec_from_file_location(f"made.{name}", path)
        assert spec is not None
        assert spec.loader is not None
        module = module_from_spec(spec)
        spec.loader.exec_module(module)
        return module

    return written


@pytest.fixture
def module(
    name: str,
    other_module: Callable[[str], ModuleType],
    large_module: Callable[[str], ModuleType],
) -> ModuleType:
    if name in large_names():
        return large_module(name)
    return other_module(name) if name in OTHERS else load_module(name)


@pytest.fixture
def system(name: str) -> System:
    return OTHERS.get(name) or load(name)


@cache
def cases(module: ModuleType) -> list[Case]:
    """Times, states and parameters at which nothing vanishes and every root is real.

    The states satisfy constraints. Of systems with constraints the parameters are near the
    defaults, with which the systems can be assembled.
    """
    system = OTHERS.get(module.SYSTEM) or load(module.SYSTEM)
    positive = {s.name for s in system.q if s.is_positive}
    random = np.random.default_rng(7)
    results: list[Case] = []
    while len(results) < 6:
        y = random.uniform(0.2, 0.9, len(module.STATE)) * random.choice([-1, 1], len(module.STATE))
        params = random.uniform(1.5, 2.5, len(module.PARAMETERS))
        for k, name in enumerate(module.COORDINATES):
            if name in positive:
                y[k] = abs(y[k]) + 0.5
        t = float(random.uniform(0.1, 2))
        if system.all_conditions:
            params = np.array(module.DEFAULTS) * random.uniform(0.9, 1.1, len(params))
        if has_constraints(module):
            try:
                y = consistent_start(module, {}, params, t, guess=y).y
            except ValueError:  # Newton's steps from this guess do not converge
                continue
        results.append((t, y.tolist(), params.tolist()))
    return results


def with_eliminated(
    system: System, module: ModuleType, t: float, y: list[float], params: list[float]
) -> tuple[list[float], list[float]]:
    """State and rates of all coordinates, also of those that the module is without."""
    rates = module.rhs(t, y, params)
    if tuple(map(str, system.q)) == module.COORDINATES:
        return y, rates
    states = dict(zip(module.STATE, zip(y, rates, strict=True), strict=True))
    changes = turned(module, "outputs", t, y, np.array(rates), params)
    outputs = zip(module.outputs(t, y, params), changes, strict=True)
    states |= dict(zip(module.OUTPUTS, outputs, strict=True))
    pairs = [states[str(s)] for s in (*system.q, *system.qdot)]
    return [value for value, _ in pairs], [rate for _, rate in pairs]


def quaternions(system: System) -> list[tuple[sp.Symbol, ...]]:
    """Unit quaternions among the coordinates."""
    return [parts for mass in system.masses if (parts := getattr(mass, "quaternion", ()))]


def points(mass: PointMass) -> Iterator[tuple[sp.Expr, tuple[sp.Expr, ...]]]:
    """Inertia and place of the mass, and of points on the axes that rotate as a body in space."""
    yield from mass.motions
    if isinstance(mass, RigidBody) and mass.turns:
        pairs, matrix = mass.tensor.trace() / 2 * sp.eye(3) - mass.tensor, mass.orientation.matrix
        for k in range(3):
            yield 2 * pairs[k, k] - sum(pairs.row(k)), tuple(matrix[:, k])
        for j, k in combinations(range(3), 2):  # 2 a b = (a + b)² - a² - b²
            yield pairs[j, k], tuple(matrix[:, j] + matrix[:, k])


class Alembert:
    """Forces that a given motion of a system requires, from its positions alone."""

    def __init__(self, system: System) -> None:
        self.constant = list(system.reactions)
        self.moving = (*system.q, *self.constant)
        free = [s for s in system.params if s not in self.constant]
        symbols = (TIME, *self.moving, *free)
        compiled = partial(sp.lambdify, modules="mpmath", cse=True)
        self.terms = [
            (compiled(free, inertia), compiled(symbols, r))
            for mass in system.masses
            for inertia, place in points(mass)
            for r in place
        ]
        self.potential = compiled(symbols, system.potential_energy)
        # friction takes power: its force is against Rayleigh's function
        applied = [
            (system.forces[k] if system.forces else 0) - system.dissipation.diff(rate)
            for k, rate in enumerate(system.qdot)
        ]
        self.applied = compiled((TIME, *system.q, *system.qdot, *system.params), applied)
        self.system = system
        self.free = free
        moving = (TIME, *system.q, *system.qdot, *system.params)
        self.conditions = [compiled(moving, one.formula) for one in system.conditions]
        self.is_velocity = [
            bool(one.formula.free_symbols & {*system.qdot}) for one in system.conditions
        ]

    def directions(self, t: mpf, q: list[mpf], v: list[mpf], values: dict) -> list[list[mpf]]:
        """∂φ/∂q of constraints of coordinates, ∂ψ/∂q̇ of constraints of velocities."""

        def along(condition: Callable[..., mpf], k: int) -> mpf:
            def shifted(s: mpf) -> mpf:
                state = [*q, *v]
                state[k] += s
                return condition(t, *state, *values.values())

            return diff(shifted, 0)

        pairs = zip(self.conditions, self.is_velocity, strict=True)
        return [[along(one, k + len(q) * moving) for k in range(len(q))] for one, moving in pairs]

    def changes(self, t: mpf, q: list[mpf], v: list[mpf], a: list[mpf], values: dict) -> list[mpf]:
        """φ̈ of constraints of coordinates and ψ̇ of constraints of velocities."""

        def path(s: mpf) -> list[mpf]:
            moved = [x + y * s + z * s**2 / 2 for x, y, z in zip(q, v, a, strict=True)]
            return [t + s, *moved, *(y + z * s for y, z in zip(v, a, strict=True))]

        pairs = zip(self.conditions, self.is_velocity, strict=True)
        return [
            diff(lambda s, one=one: one(*path(s), *values.values()), 0, 1 if moving else 2)
            for one, moving in pairs
        ]

    def forces(self, t: mpf, q: list[mpf], v: list[mpf], a: list[mpf], values: dict) -> list[mpf]:
        """Σ m r̈·∂r/∂q + ∂V/∂q along every coordinate, then along every length that is constant."""
        there = [*q, *(values[s] for s in self.constant)]
        free = [values[s] for s in self.free]

        def path(s: mpf) -> list[mpf]:
            moved = [x + y * s + z * s**2 / 2 for x, y, z in zip(q, v, a, strict=True)]
            return [t + s, *moved, *there[len(q) :], *free]

        def along(function: Callable[..., mpf], k: int) -> mpf:
            def shifted(s: mpf) -> mpf:
                place = [*there]
                place[k] += s
                return function(t, *place, *free)

            return diff(shifted, 0)

        return [
            along(self.potential, k)
            + fdot(
                (inertia(*free) * diff(lambda s, r=r: r(*path(s)), 0, 2), along(r, k))
                for inertia, r in self.terms
            )
            for k in range(len(there))
        ]


@pytest.mark.long("more cases of the same kind", keep=1, daily=15)
def test_motions_and_reactions_satisfy_d_alembert_s_principle(
    system: System, module: ModuleType
) -> None:
    alembert, n = Alembert(system), len(system.q)
    for t, own, params in cases(module)[:2]:
        y, rates = with_eliminated(system, module, t, own, params)
        with workdps(50):
            values = dict(zip(system.params, map(mpf, params), strict=True))
            q, v, a = ([mpf(x) for x in part] for part in (y[:n], y[n:], rates[n:]))
            needed = alembert.forces(mpf(t), q, v, a, values)
            applied = [*alembert.applied(t, *q, *v, *values.values())]
            if system.conditions:
                reactions = module.multipliers(t, own, params)
                directions = alembert.directions(mpf(t), q, v, values)
                for reaction, direction in zip(reactions, directions, strict=True):
                    applied = [f + reaction * x for f, x in zip(applied, direction, strict=True)]
                changes = alembert.changes(mpf(t), q, v, a, values)
                assert max(map(abs, changes)) < 1e-11 * max(map(abs, rates))
            for parts in quaternions(system):  # along which energies beside the norm 1 differ
                indices = [system.q.index(part) for part in parts]
                excess = fdot((q[k], needed[k] - applied[k]) for k in indices)
                needed = [f - excess * q[k] * (k in indices) for k, f in enumerate(needed)]
            scale = max(1, *(abs(x) for x in (*needed, *rates)))
            for force, given in zip(needed[:n], applied, strict=True):
                assert abs(force - given) < 1e-11 * scale
            if not system.conditions:
                a[0] += mpf("1e-6")
                wrong = zip(alembert.forces(mpf(t), q, v, a, values), needed, strict=True)
                assert max(abs(one - other) for one, other in wrong) > 1e-9
        if system.reactions:
            results = module.reactions(t, own, params)
            for force, reaction in zip(needed[n:], results, strict=True):
                assert abs(force + mpf(reaction)) < 1e-11 * scale


def turned(
    module: ModuleType,
    function: str,
    t: float,
    y: list[float],
    rates: np.ndarray,
    params: list[float],
) -> np.ndarray:
    """The rate of a function of time and state along `rates`, by a complex step."""
    moved = np.array(y) + 1e-30j * np.array(rates)
    results = getattr(module, f"{function}_many")(t + 1e-30j, moved, params)
    return np.asarray(results).imag / 1e-30


@pytest.mark.long("more cases of the same kind", keep=6)
def test_energy_changes_by_the_power_of_forces_and_drives_alone(
    module: ModuleType,
) -> None:
    for t, y, params in cases(module):
        rates = module.rhs(t, y, params)
        change = turned(module, "energy", t, y, rates, params)
        parts = [turned(module, "energy", t, y, e * rates, params) for e in np.eye(len(y))]
        scale = np.abs(parts).max()
        power = module.power(t, y, params) if hasattr(module, "power") else 0.0
        assert abs(change - power) < 1e-12 * scale
        if power:
            assert abs(change) > 1e-6 * scale


@pytest.mark.long("more cases of the same kind", keep=5)
def test_hamilton_s_form_is_the_same_motion(module: ModuleType) -> None:
    if "hamiltonian" not in module.FORMS:
        return  # the system has constraints
    for t, y, params in cases(module):
        z = module.hamiltonian_state(t, y, params)
        rates = turned(module, "hamiltonian_state", t, y, module.rhs(t, y, params), params)
        assert_allclose(module.rhs_hamiltonian(t, z, params), rates, rtol=1e-9, atol=1e-10)
        assert_allclose(module.lagrangian_state(t, z, params), y, rtol=1e-11)
        energies = (
            module.energy(t, y, params),
            module.energy_hamiltonian(t, z, params),
        )
        assert energies[0] == pytest.approx(energies[1], rel=1e-11)


@pytest.mark.long("more cases of the same kind", keep=10)
def test_the_hamiltonian_is_the_maximum_of_p_v_minus_the_lagrangian_over_velocities(
    system: System, module: ModuleType
) -> None:
    # the definition of Legendre's transform, with rates of the positions by the chain rule
    if "hamiltonian" not in module.FORMS:
        return
    system = reduced(system)
    n, symbols = len(system.q), (TIME, *system.q, *system.qdot, *system.params)
    kinetic = sum(
        inertia * (r.diff(TIME) + sum(map(mul, map(r.diff, system.q), system.qdot))) ** 2 / 2
        for mass in system.masses
        for inertia, place in points(mass)
        for r in map(sp.sympify, place)
    )
    lagrangian = sp.lambdify(symbols, kinetic - system.potential_energy, "numpy")

    def negative(v: np.ndarray, t: float, q: np.ndarray, p: np.ndarray, params: Any) -> float:
        return float(lagrangian(t, *q, *v, *params) - p @ v)

    for t, y, params in cases(module)[:3]:
        q, p = np.split(np.array(y), 2)  # any numbers are momenta
        start, options = np.zeros(n), {"gtol": 1e-7}
        found = minimize(negative, start, (t, q, p, params), "BFGS", options=options)
        scale = abs(p @ found.x) + abs(negative(start, t, q, p, params)) + 1e-3
        energy = module.energy_hamiltonian(t, y, params)
        assert -found.fun == pytest.approx(energy, abs=1e-9 * scale)
        velocities = module.lagrangian_state(t, y, params)[n:]
        assert_allclose(found.x, velocities, atol=1e-4 * np.abs(velocities).max())


@pytest.mark.long("more cases of the same kind", keep=18)
@pytest.mark.parametrize("form", ["", "_hamiltonian"])
def test_jacobians_are_derivatives(module: ModuleType, form: str) -> None:
    if form.removeprefix("_") not in ("", *module.FORMS):
        return
    for t, y, params in cases(module):
        z = y if not form else module.hamiltonian_state(t, y, params)
        steps = np.array(z)[:, None] + 1e-30j * np.eye(len(z))
        expected = getattr(module, f"rhs{form}_many")(t, steps, params).imag / 1e-30
        results = getattr(module, f"jacobian{form}")(t, z, params)
        assert_allclose(results, expected, rtol=1e-8, atol=1e-10 * np.abs(expected).max())


@pytest.mark.long("more cases of the same kind", keep=4)
def test_other_forms_are_the_same_motion(module: ModuleType) -> None:
    n = len(module.COORDINATES)
    for t, y, params in cases(module):
        change = np.arange(1.0, 2 * n + 1)
        direction = module.rhs_many(t, np.array(y) + 1e-30j * change, params).imag / 1e-30
        form = Form(module, "variational", params)
        rates = form.rhs(t, form.from_ordinary(t, np.array([*y, *change])))
        assert_allclose(rates[-2 * n :], direction, rtol=1e-8, atol=1e-9)
        if "sensitivity" in module.FORMS:
            changes = np.arange(1.0, len(params) + 1)
            constants = np.array(params) + 1e-30j * changes
            direction = module.rhs_many(t, np.array(y) + 1e-30j * change, constants).imag / 1e-30
            form = Form(module, "sensitivity", (*changes, *params))
            rates = form.rhs(t, form.from_ordinary(t, np.array([*y, *change])))
            assert_allclose(rates[-2 * n :], direction, rtol=1e-8, atol=1e-9)
        if "rational" in module.FORMS:
            rational = Form(module, "rational", params)
            rates = rational.rhs(t, rational.from_ordinary(t, np.array(y)))
            assert_allclose(rates[-n:], module.rhs(t, y, params)[n:], rtol=1e-9, atol=1e-10)


def test_the_equilibrium_is_one_and_its_matrices_describe_small_motions(
    module: ModuleType,
) -> None:
    if not hasattr(module, "equilibrium"):
        assert not hasattr(module, "linear")
        return
    for t, _, params in cases(module):
        place = module.equilibrium(params)
        n = len(place)
        if not np.linalg.det(module.mass_matrix(t, [*place, *[0.0] * n], params)):
            continue  # where no force acts, but the coordinates fail, as on top of a sphere
        still = [*place, *[0.0] * n]
        assert np.abs(module.rhs(t, still, params)).max() < 1e-12
        if hasattr(module, "linear"):
            M, K = np.array(module.linear(params))
            pulled = np.array(module.jacobian(t, still, params))[n:, :n]
            assert_allclose(pulled, -np.linalg.solve(M, K), rtol=1e-10, atol=1e-11)


def test_arrays_give_what_single_states_give(module: ModuleType) -> None:
    for name in [key.removesuffix("_many") for key in vars(module) if key.endswith("_many")]:
        one, many = getattr(module, name), getattr(module, f"{name}_many")
        takes = inspect.signature(one).parameters
        for t, y, params in cases(module)[:2]:
            state = y
            own = params
            kind = name.rpartition("_")[2]
            if name != "hamiltonian_state" and kind in ("rational", "variational", "sensitivity"):
                form = Form(module, "lagrangian", params).in_form(kind)
                state = form.from_ordinary(t, np.resize(y, len(form.ordinary))).tolist()
                own = form.params
            qddot = y[: len(y) // 2]
            given = {"t": t, "y": state, "qddot": qddot, "params": own}
            alone = np.array(one(*(given[key] for key in takes)))
            given = {
                "t": np.full(3, t),
                "y": np.tile(np.array(state)[:, None], 3),
                "qddot": np.tile(np.array(qddot)[:, None], 3),
                "params": np.tile(np.array(own).reshape(-1, 1), 3),
            }
            together = many(*(given[key] for key in takes))
            if "y" not in takes and not params:
                continue  # nothing has more than one value
            assert together.shape == (*alone.shape, 3)
            assert_allclose(together[..., 1], alone, rtol=1e-10, atol=1e-12)


@pytest.mark.parametrize("path", sorted(SYSTEMS.rglob("[a-z]*.py")), ids=lambda path: path.stem)
def test_a_system_is_one_short_file_with_a_drawing_and_its_source(path: Path) -> None:
    definition, _, equations = path.read_text().partition("PUBLISHED = r'''\n")
    is_large = path.stem in large_names()
    assert len(definition.strip().splitlines()) <= (LINES_OF_LARGE if is_large else LINES)
    assert equations.endswith("'''\n")
    text = drawing(path.stem.replace("_n", "_3"))
    assert len(text.splitlines()) >= 5
    assert any(character in text for character in "|/\\")


def test_a_listing_contains_the_names_that_a_user_needs(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["systems", "chain_4", "spherical_pendulum"]) == 0
    shown = capsys.readouterr().out
    assert "theta1, theta2, theta3, theta4, theta1_dot" in shown
    assert "parameters: m = 1 kg, l = 1 m, g = 9.81 m/s^2" in shown
    assert max(map(len, shown.splitlines())) <= 100
    assert main(["systems"]) == 0
    whole = capsys.readouterr().out
    everything = (*names(), *large_names())
    assert all(f"{name}: {load(name).title}" in whole for name in everything)
    assert whole.count("module: derived when it is first used") == len(large_names())


def test_a_large_system_is_not_part_of_the_package(capsys: pytest.CaptureFixture[str]) -> None:
    assert not {*large_names()} & {*generated.__all__, *names()}
    assert main(["derive", "andrews_squeezer"]) == 2
    message = "is not part of the package generated: give a folder for its module, with --output"
    assert message in capsys.readouterr().err


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("chian_4", "did you mean"),
        ("chain_n", "known are"),
        ("chain_1000", "any number up to 100"),
        ("../systems", "no system is called"),
    ],
)
def test_an_unknown_system_is_refused(
    name: str, words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["systems", name]) == 2
    assert words in capsys.readouterr().err


@pytest.mark.parametrize("name", [*names(), *large_names()])
def test_rows_of_descriptions_are_full(name: str) -> None:
    rows = description(name).rpartition("\n\n")[2].splitlines()
    assert max(map(len, rows)) <= 98
    for row, after in pairwise(rows):
        if after.startswith("      "):  # it continues the row, whose width its first word exceeds
            assert len(row) + 1 + len(re.split(r"(?<=-)|\s", after.strip())[0]) > 98
