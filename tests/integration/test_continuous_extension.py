"""Continuous extensions of steps: their weights, their order, and events that they find."""

from pathlib import Path
from types import ModuleType

import mpmath
import numpy as np
import pytest
from handwritten import handwritten

import generated.double_pendulum as dp
from solvers.integration.checks.predictability import ignore_predictability
from solvers.integration.ensemble import ensemble
from solvers.integration.integrate import integrate
from solvers.integration.problem.events import Event
from solvers.runge_kutta.continuous_extension import ContinuousExtension, bernstein_values
from solvers.runge_kutta.method_catalogue import load, names
from solvers.runge_kutta.order_conditions import Tree, density, trees
from solvers.runge_kutta.stepper import Stepper

SEQUENTIAL = [m for m in names() if not load(m).is_parallel and not load(m).is_splitting]
EXPLICIT = [name for name in names() if load(name).is_explicit]
ORDERS = {"rk4": 3, "dp54": 4, "tsit54": 4, "dop853": 5, "verner853": 5, "verner98": 6, "radau7": 7}

HEADER = """
static inline void rotation_rhs(
    HOLONOMIC_REAL t, const HOLONOMIC_REAL *state, const HOLONOMIC_REAL *params,
    HOLONOMIC_REAL *result)
{
    result[0] = 1.0 - params[0]*state[1];
    result[1] = -state[2];
    result[2] = state[1];
    (void)t;
}
"""


@pytest.fixture(scope="module")
def rotation(tmp_path_factory: pytest.TempPathFactory) -> ModuleType:
    """(u, v) = r (cos s, sin s) and w = s - p r sin s, where s is the time from a middle."""
    folder: Path = tmp_path_factory.mktemp("rotation")
    (folder / "rotation.h").write_text(HEADER)
    return handwritten(
        "rotation",
        ("w", "u", "v"),
        rhs=lambda t, y, params: (1.0 - params[0] * y[1], -y[2], y[1]),
        __file__=str(folder / "rotation.py"),
    )


def weight(A: np.ndarray, tree: Tree) -> np.ndarray:
    branches = [A @ weight(A, branch) for branch in tree]
    return np.asarray(np.prod([np.ones(len(A)), *branches], axis=0))


@pytest.mark.parametrize("method", SEQUENTIAL)
def test_natural_weights_fulfil_the_order_conditions_within_a_step(method: str) -> None:
    tableau = load(method)
    extension, A = ContinuousExtension.of(tableau), np.array(tableau.A, float)
    assert extension.natural_order == ORDERS.get(method, extension.natural_order)
    assert extension.natural_order >= (tableau.order + 1) // 2
    parts = np.array([0.0, 0.21, 0.5, 0.83, 1.0])
    b = bernstein_values(len(extension.natural) - 1, parts) @ extension.natural
    assert b[-1] == pytest.approx(np.array(tableau.b, float), abs=1e-11)
    for n in range(1, extension.natural_order + 1):
        for tree in trees(n):
            assert b @ weight(A, tree) == pytest.approx(parts**n / density(tree), abs=1e-10)


@pytest.mark.parametrize("method", ["gauss1", "gauss2", "radau3"])
def test_polynomials_of_implicit_methods_have_the_slopes_at_both_ends(method: str) -> None:
    extension, random = ContinuousExtension.of(load(method)), np.random.default_rng(4)
    slopes = random.normal(size=extension.natural.shape[1] + 2)  # at the ends, then at the stages
    c = extension.with_ends @ slopes
    degree = len(c) - 1
    assert degree * np.array([c[1] - c[0], c[-1] - c[-2]]) == pytest.approx(slopes[:2], abs=1e-13)
    assert (c[0], c[-1]) == pytest.approx((0, extension.natural[-1] @ slopes[2:]), abs=1e-13)


@pytest.mark.parametrize("method", EXPLICIT)
def test_extensions_have_the_order_of_the_method(method: str) -> None:
    def rhs(t: float, y: np.ndarray) -> np.ndarray:
        return np.array([y[1], -np.sin(y[0]) + 0.1 * np.sin(t)])

    tableau, start = load(method), np.array([2.0, 0.5])
    extension, stepper = ContinuousExtension.of(tableau), Stepper(load("verner98"), rhs)
    own = Stepper(tableau, rhs)
    parts, errors = np.array([0.13, 0.37, 0.72, 0.91]), []
    for h in np.array([1.0, 0.5]) * (0.8 if tableau.order > 5 else 0.2):
        k = own.step(0.0, start, h, rhs(0.0, start)).k
        assert k is not None
        change = bernstein_values(len(extension.nodes), parts) @ extension.extend(
            rhs, 0.0, start, h, k
        )
        errors.append(0.0)
        for part, end in zip(parts, start + h * change, strict=True):
            t, y = 0.0, start
            for _ in range(16):
                y = stepper.step(t, y, part * h / 16, rhs(t, y)).y
                t += part * h / 16
            errors[-1] = max(errors[-1], float(np.abs(end - y).max()))
    assert np.log2(errors[0] / errors[1]) > tableau.order + 0.5


def crossings(p: float, r: float, s: float, h: float) -> tuple[list[float], list[float]]:
    """Times at which w and u - 1 vanish, with 50 digits."""
    with mpmath.workdps(50):
        gap = mpmath.findroot(lambda x: x - p * r * mpmath.sin(x), mpmath.sqrt(6 * (p * r - 1)))
        w = [s - float(gap), s, s + float(gap)]
        u = [s - float(mpmath.acos(1 / r)), s + float(mpmath.acos(1 / r))] if r > 1 else []
    return [t for t in w if 0 < t < h], [t for t in u if 0 < t < h]


@pytest.mark.long("more cases of the same kind")
@pytest.mark.parametrize("backend", ["python", "compiled", "lanes"])
@pytest.mark.parametrize(
    ("method", "h", "shallowest", "error"),
    # the shallowest dip is below the error of the polynomials, and above that of the step
    [("verner853", 1.0, 1e-7, 1e-8), ("verner98", 1.0, 1e-7, 3e-8), ("dop853", 1.0, 1e-6, 1e-7),
     ("gauss8", 2.0, 1e-11, 1e-11)],
)  # fmt: skip
@pytest.mark.parametrize("motions", [24, pytest.param(3000, marks=pytest.mark.campaign)])
@ignore_predictability()
def test_double_and_triple_crossings_in_one_step_are_found(
    rotation: ModuleType,
    method: str,
    h: float,
    shallowest: float,
    error: float,
    backend: str,
    motions: int,
) -> None:
    random = np.random.default_rng(5)
    events = [Event(rotation, "w", 0.0), Event(rotation, "u", 1.0)]
    middle = h * random.uniform(0.3, 0.7, motions)
    # (s - p r sin s) has three zeros, u = r cos s - 1 two or none
    excess = 10 ** random.uniform(-3.5, -2, motions)
    depth = random.choice([-1, 1], motions) * shallowest * 10 ** random.uniform(0, 4, motions)
    r = 1 + depth
    p = (1 + excess) / r
    starts = np.array([
        -middle + p * r * np.sin(middle), r * np.cos(middle), -r * np.sin(middle)
    ])  # fmt: skip
    found = []
    if backend == "lanes":
        run = ensemble(
            rotation, (0, h), starts, p[np.newaxis], method=method, h=h, events=events,
            occurrences=5,
        )  # fmt: skip
        found = [[row[np.isfinite(row)] for row in rows] for rows in run.t_events]
    else:
        for start, p_k in zip(starts.T, p, strict=True):
            one = integrate(
                rotation, (0, h), start, [p_k], method=method, h=h, events=events, backend=backend
            )
            found.append(one.t_events)
    for k in range(motions):
        expected = crossings(p[k], r[k], middle[k], h)
        assert len(found[k][0]) == len(expected[0])
        assert len(found[k][1]) == len(expected[1]), depth[k]
        # an error of the state shifts crossings by that over the derivative
        assert found[k][0] == pytest.approx(expected[0], abs=error / excess[k])
        assert found[k][1] == pytest.approx(expected[1], abs=error / abs(depth[k]) ** 0.5)


def height(t: float, y: np.ndarray) -> float:
    """Height of the second mass of the double pendulum."""
    return float(-np.cos(y[0]) - np.cos(y[1]))


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize("motions", [3, pytest.param(300, marks=pytest.mark.campaign)])
@pytest.mark.parametrize(
    ("method", "backend"),
    [("dp54", "compiled"), ("dp54", "lanes"), ("verner98", "lanes"), ("verner853", "compiled"),
     ("verner853", "python"), ("radau5", "compiled"), ("DOP853", None)],
)  # fmt: skip
@ignore_predictability()
def test_no_crossing_near_an_extremum_is_missed(
    method: str, backend: str | None, motions: int
) -> None:
    random, end = np.random.default_rng(11), 2.0
    grid = np.linspace(0, end, 8001)
    for k in range(motions * 4):
        start = np.concatenate([random.uniform(-2, 2, 2), random.normal(0, 2, 2)])
        dense = integrate(dp, (0, end), start, {}, method="gauss8", rtol=1e-12, t_eval=grid)
        is_height = k % 5 == 4 and backend in ("python", None)
        values = -np.cos(dense.y[0]) - np.cos(dense.y[1]) if is_height else dense.y[k % 4]
        slopes = np.diff(values)
        extrema = np.flatnonzero(slopes[1:] * slopes[:-1] < 0) + 1
        if not len(extrema):
            continue
        place = random.choice(extrema)
        depth = np.sign(values[place - 1] - values[place]) * 10 ** random.uniform(-5, -1)
        level = values[place] + depth
        event = Event(dp, dp.STATE[k % 4], level)
        function = (lambda t, y, level=level: height(t, y) - level) if is_height else event
        options = {"method": method, "rtol": 1e-9, "atol": 1e-9}
        if backend == "lanes":
            run = ensemble(
                dp, (0, end), np.stack([start, start], axis=1), {}, events=[event],
                occurrences=50, **options,
            )  # fmt: skip
            found = run.t_events[0, 0, : run.occurred[0, 0]]
        else:
            found = integrate(
                dp, (0, end), start, {}, events=function, backend=backend, **options
            ).t_events[0]
        difference = values - level
        crossed = np.flatnonzero(np.sign(difference[1:]) != np.sign(difference[:-1]))
        fractions = difference[crossed] / (difference[crossed] - difference[crossed + 1])
        assert found == pytest.approx(grid[crossed] + fractions * grid[1], abs=1e-4)


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize("backend", ["python", "compiled"])
@ignore_predictability()
def test_shallow_dips_are_found_where_polynomials_are_less_accurate(backend: str) -> None:
    random, end = np.random.default_rng(1), 1.5
    grid, options = np.linspace(0, end, 6001), {"method": "gauss2", "h": 0.05}
    pairs = 0
    for k in range(8):
        start = np.concatenate([random.uniform(-2, 2, 2), random.normal(0, 2, 2)])
        run = integrate(dp, (0, end), start, {}, t_eval=grid, form="lagrangian", **options)
        values = run.y[2 + k % 2]
        slopes = np.diff(values)
        extrema = np.flatnonzero(slopes[1:] * slopes[:-1] < 0) + 1
        for place in extrema[:3]:
            level = values[place] + np.sign(values[place - 1] - values[place]) * 1e-5
            found = integrate(
                dp, (0, end), start, {}, events=Event(dp, dp.STATE[2 + k % 2], level),
                form="lagrangian", backend=backend, **options,
            ).t_events[0]  # fmt: skip
            crossed = np.sign(values[1:] - level) != np.sign(values[:-1] - level)
            # the whole run has as many, which are those of shorter steps
            assert len(found) == crossed.sum()
            pairs += 1
    assert pairs > 6
