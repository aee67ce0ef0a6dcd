"""Events in long steps: several crossings of one event, tangents, events at the start."""

import shutil
import subprocess
from collections.abc import Callable, Sequence
from math import comb, fsum
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from benchmarks.events import CROSSINGS
from benchmarks.motions import END, START
from cheap_compiler import CHECKS
from handwritten import handwritten
from scipy.special import ellipk, ellipkinc
from sympy import Poly, Rational, Symbol

import generated.double_pendulum as dp
import generated.single_pendulum as sp
from solvers.integration.checks.predictability import ignore_predictability
from solvers.integration.compiled.memory_layout import SOURCES
from solvers.integration.ensemble import ensemble
from solvers.integration.integrate import integrate
from solvers.integration.problem.events import Event
from solvers.integration.problem.status import Status
from solvers.integration.results.event_location import ROUGH_NODES, may_recur
from solvers.runge_kutta.parallel_stages import bernstein_matrix

#: Degree of the motions y(t) that one step of gauss8 gives exactly.
DEGREE = 8
HEADER = """
static inline void polynomial_rhs(
    HOLONOMIC_REAL t, const HOLONOMIC_REAL *state, const HOLONOMIC_REAL *params,
    HOLONOMIC_REAL *result)
{
    HOLONOMIC_REAL sum = {0};
    for (int k = 8; k > 0; k--) {
        sum = sum*t + (double)k*params[k - 1];
    }
    result[0] = sum;
    (void)state;
}
"""


def slope(t: float, y: np.ndarray, params: np.ndarray) -> list[float]:
    """Derivative of y = y(0) + p1 t + ... + p8 t^8."""
    return [float(np.polyval([k * params[k - 1] for k in range(DEGREE, 0, -1)], t))]


@pytest.fixture(scope="module")
def polynomial(tmp_path_factory: pytest.TempPathFactory) -> ModuleType:
    folder: Path = tmp_path_factory.mktemp("polynomial")
    (folder / "polynomial.h").write_text(HEADER)
    parameters = tuple(f"p{k}" for k in range(1, DEGREE + 1))
    return handwritten(
        "polynomial", ("y",), parameters, rhs=slope, __file__=str(folder / "polynomial.py")
    )


def random_roots(random: np.random.Generator) -> list[complex]:
    """Eight roots: single, double, triple and close ones in (0, 1), others outside, pairs."""
    roots: list[complex] = []
    while len(roots) < DEGREE:
        x = random.uniform(0.1, 0.9)
        gap = 10.0 ** random.uniform(-3, -1)
        inside = [
            [x], [x, x + gap], [x - gap, x, x + gap], [x, x], [x, x, x],
            [complex(x, gap), complex(x, -gap)],
        ]  # fmt: skip
        outside = [[random.choice([-1, 1]) * random.uniform(1.5, 4)]]
        new = (inside if random.random() < 0.4 else outside * 6)[random.integers(6)]
        if len(roots) + len(new) <= DEGREE:
            roots += new
    return roots


def true_crossings(coefficients: np.ndarray) -> tuple[list[float], bool]:
    """Sign changes in (0, 1), exactly, and whether rounding errors of doubles decide some."""
    exact = Poly([Rational(float(a)) for a in coefficients], Symbol("t"))
    with_multiplicity = exact.intervals(eps=Rational(1, 10**18), inf=0, sup=1)
    roots = [float((a + b) / 2) for (a, b), multiplicity in with_multiplicity if multiplicity % 2]
    extrema = np.roots(np.polyder(coefficients))
    near = extrema[(abs(extrema.imag) < 1e-3) & (abs(extrema.real - 0.5) < 0.6)].real
    values = [abs(float(exact.eval(Rational(float(x))))) for x in near]
    return roots, min(values, default=np.inf) < 1e-12 * np.abs(coefficients).max()


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize(
    "motions", [200, pytest.param(10_000, marks=[pytest.mark.campaign, pytest.mark.timeout(1800)])]
)
@ignore_predictability()
def test_no_crossing_of_random_polynomials_is_missed_or_invented(
    polynomial: ModuleType, motions: int
) -> None:
    random = np.random.default_rng(2)
    coefficients = np.array([
        np.real(np.poly(random_roots(random))) * random.choice([-1, 1]) for _ in range(motions)
    ])  # fmt: skip
    starts, params = coefficients[:, -1:].T, coefficients[:, -2::-1].T
    event = Event(polynomial, "y", 0.0)
    found = ensemble(
        polynomial, (0, 1), starts, params, method="gauss8", h=1.0, events=[event], occurrences=8
    )
    assert (found.steps == 1).all()
    several = decided = 0
    for k in range(motions):
        expected, flat = true_crossings(coefficients[k])
        if flat:  # values of doubles near the extremum are rounding errors
            continue
        decided += 1
        several += len(expected) > 1
        assert found.occurred[k, 0] == len(expected), (k, coefficients[k].tolist())
        times = found.t_events[k, 0, : len(expected)]
        slopes = np.abs(np.polyval(np.polyder(coefficients[k]), expected))
        # a value is wrong by some roundings, a root by these over the slope
        allowed = 1e-14 * np.abs(coefficients[k]).max() / slopes + 1e-14
        assert (np.abs(times - expected) < allowed).all()
    assert decided > motions / 3
    assert several > motions / 5


@ignore_predictability()
def test_python_finds_the_same_crossings(polynomial: ModuleType) -> None:
    random = np.random.default_rng(3)
    for _ in range(40):
        coefficients = np.real(np.poly(random_roots(random)))
        expected, flat = true_crossings(coefficients)
        gaps = np.diff([0, *expected, 1])
        if flat or gaps.min() < 1e-4:  # nearer than the interpolation of the event tells
            continue
        found = integrate(
            polynomial, (0, 1), coefficients[-1:], coefficients[-2::-1], method="gauss8", h=1.0,
            events=[Event(polynomial, "y", 0.0)], backend="python",
        )  # fmt: skip
        assert found.t_events[0] == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize("backend", ["python", "compiled"])
@ignore_predictability()
def test_an_event_at_the_start_does_not_hide_the_next_one(
    polynomial: ModuleType, backend: str
) -> None:
    # y = t (t - 0.3) (t - 0.6) starts at 0, which is no crossing
    coefficients = np.zeros(DEGREE)
    coefficients[:3] = 0.18, -0.9, 1.0
    options = {"method": "gauss8", "h": 1.0, "backend": backend}
    for direction, expected in ((0, [0.3, 0.6]), (1, [0.6]), (-1, [0.3])):
        event = Event(polynomial, "y", 0.0, direction=direction)
        found = integrate(polynomial, (0, 1), [0.0], coefficients, events=[event], **options)
        assert found.t_events[0] == pytest.approx(expected, abs=1e-12)
    terminal = Event(polynomial, "y", 0.0, terminal=True)
    found = integrate(polynomial, (0, 1), [0.0], coefficients, events=[terminal], **options)
    assert found.status is Status.EVENT
    assert found.end[0] == pytest.approx(0.3, abs=1e-12)


@pytest.mark.long("more cases of the same kind", keep=8)
@pytest.mark.parametrize("backend", ["python", "compiled", "lanes"])
@pytest.mark.parametrize("method", ["dp54", "verner853", "verner98", "gauss4", "gauss8", "radau3"])
@pytest.mark.parametrize("depth", [1e-2, 1e-7])
@ignore_predictability()
def test_a_pendulum_crosses_an_angle_just_below_its_amplitude_twice(
    method: str, backend: str, depth: float
) -> None:
    options = {"method": method, "rtol": 1e-10, "atol": 1e-10}
    event, span = Event(sp, "theta", 1.5 - depth), (0, 5)
    if backend == "lanes":
        starts = np.array([[1.5, 1.5 - 2 * depth], [0.0, 0.0]])
        motions = ensemble(sp, span, starts, sp.DEFAULTS, events=[event], occurrences=9, **options)
        assert motions.occurred[1, 0] == 0  # the other one stays below
        found = motions.t_events[0, 0, : motions.occurred[0, 0]]
    else:
        options["backend"] = backend
        found = integrate(sp, span, (1.5, 0.0), sp.DEFAULTS, events=[event], **options).t_events[0]
    # from the release at rest a time s passes until the angle; it is the same about every maximum
    _, length, g = sp.DEFAULTS
    k = np.sin(0.75)
    phase = np.arcsin(np.sin((1.5 - depth) / 2) / k)
    s = (ellipk(k**2) - ellipkinc(phase, k**2)) / np.sqrt(g / length)
    period = 4 * ellipk(k**2) / np.sqrt(g / length)
    expected = [s, period - s, period + s, 2 * period - s, 2 * period + s]
    # the time of an angle near its maximum is as uncertain as the angle over its small velocity
    velocity = np.sqrt(2 * depth * g / length * np.sin(1.5))
    assert found == pytest.approx([t for t in expected if t < 5], abs=1e-8 / velocity)


def test_bernstein_coefficients_give_the_integral_of_legendre_polynomials() -> None:
    matrix, x = bernstein_matrix(4), np.linspace(0, 1, 7)
    basis = [[1, 4, 6, 4, 1][k] * x**k * (1 - x) ** (4 - k) for k in range(5)]
    values = np.transpose(basis) @ matrix
    assert values[:, 0] == pytest.approx(x, abs=1e-15)
    assert values[:, 1] == pytest.approx(x**2 - x, abs=1e-15)
    assert values[:, 2] == pytest.approx(2 * x**3 - 3 * x**2 + x, abs=1e-15)


@pytest.mark.parametrize("method", ["gauss4", "gauss8"])
def test_an_event_at_the_start_is_not_counted_and_hides_no_return(method: str) -> None:
    # the motion starts at the event, where rounding errors decide its sign, and may turn back
    rng, returns = np.random.default_rng(1), 0
    for _ in range(150):
        angle, speed = rng.uniform(-3, 3), rng.choice([-1, 1]) * rng.uniform(0.1, 3)
        event = Event(dp, "theta1", float(angle))
        found, exact = (
            integrate(
                dp, (0, 0.2), (angle, 0.3, speed, 0.0), dp.DEFAULTS, method=name, rtol=tol,
                atol=tol, events=event,
            ).t_events[0]
            for name, tol in ((method, 1e-8), ("verner98", 1e-10))
        )  # fmt: skip
        assert found == pytest.approx(exact, abs=1e-7)
        returns += len(exact)
    assert 5 < returns < 100


def test_crossings_of_the_benchmark_are_those_of_another_method() -> None:
    options = {"method": "verner98", "rtol": 1e-14, "atol": 1e-14}
    for (name, value), exact in CROSSINGS.items():
        event = Event(dp, name, value)
        found = integrate(dp, (0, END), START, dp.DEFAULTS, events=event, **options).t_events[0]
        assert found == pytest.approx(exact, abs=1e-12)


@pytest.mark.long("more cases of the same kind", keep=2)
@pytest.mark.parametrize("backend", ["python", "compiled"])
@pytest.mark.parametrize(
    ("method", "most"),  # evaluations by three shorter steps, and at the ends of the bracket
    [("dp54", 3 * 6 + 2), ("verner98", 3 * 16 + 2), ("radau5", 3 * 12 + 2), ("gauss8", 3 * 24 + 2)],
)
def test_two_or_three_shorter_steps_locate_a_crossing(method: str, most: int, backend: str) -> None:
    options = {"method": method, "rtol": 1e-9, "atol": 1e-9, "t_eval": [END], "backend": backend}
    for (name, value), exact in CROSSINGS.items():
        far, near = (
            integrate(dp, (0, END), START, dp.DEFAULTS, events=Event(dp, name, level), **options)
            for level in (1e6, value)
        )
        assert len(near.t_events[0]) == len(exact)
        assert (near.nfev - far.nfev) / len(exact) <= most
        there = near.y_events[0][:, dp.STATE.index(name)]
        assert there == pytest.approx(value, abs=1e-13 * (1 + abs(value)))


def test_evaluations_at_the_ends_of_a_bracket_are_counted() -> None:
    options = {"method": "dp54", "rtol": 1e-9, "atol": 1e-9, "t_eval": [1.0]}
    far, near = (
        integrate(
            *(sp, (0, 1), (1.0, 0.0), sp.DEFAULTS),
            events=Event(sp, "theta", level),
            backend="compiled",
            **options,
        )
        for level in (1e6, 0.3)
    )
    assert len(near.t_events[0]) == 1
    assert near.nfev - far.nfev in (2 * 6 + 2, 3 * 6 + 2)  # by two or three shorter steps


ROOTS = """
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#define EXTENSION_DEGREE 8
#include "roots.h"
int main(void)
{
    int degree;
    while (scanf("%d", &degree) == 1) {
        double coefficients[EXTENSION_DEGREE + 1], roots[MAX_ROOTS];
        for (int k = 0; k <= degree; k++) {
            if (scanf("%la", &coefficients[k]) != 1) {
                return 1;
            }
        }
        const int count = isolate_roots(degree, coefficients, roots);
        for (int k = 0; k < count; k++) {
            printf("%a ", roots[k]);
        }
        printf("\\n");
    }
    return 0;
}
"""


@pytest.fixture(scope="module")
def roots_of(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., list[list[float]]]:
    """Roots in (0, 1) of polynomials with given Bernstein coefficients, by the compiled code."""
    if shutil.which("cc") is None:
        pytest.skip("needs a C compiler")
    folder = tmp_path_factory.mktemp("roots")
    (folder / "roots.c").write_text(ROOTS)
    options = ["-std=gnu11", *CHECKS.split(), f"-I{SOURCES}"]
    subprocess.run(["cc", *options, "roots.c", "-o", "roots", "-lm"], cwd=folder, check=True)

    def found(polynomials: Sequence[Sequence[float]]) -> list[list[float]]:
        lines = (f"{len(one) - 1} {' '.join(float(b).hex() for b in one)}\n" for one in polynomials)
        program, text = folder / "roots", "".join(lines)
        out = subprocess.run([program], input=text, capture_output=True, text=True, check=True)
        return [[float.fromhex(x) for x in line.split()] for line in out.stdout.splitlines()]

    return found


def test_a_double_root_at_the_start_of_a_step_is_found_within_the_stack(
    roots_of: Callable[..., list[list[float]]],
) -> None:
    x = 2.0**-26
    assert roots_of([[x * x, x * x - x, (1 - x) * (1 - x)]]) == [[0.0, 2.0**-24]]


def test_all_roots_of_polynomials_within_a_step_are_found_in_order(
    roots_of: Callable[..., list[list[float]]],
) -> None:
    """Against the roots that products of linear factors are built from."""
    random = np.random.default_rng(8)
    chosen = [
        [0.5],
        [0.25, 0.5, 0.75],
        [0.46875, 0.5],
        [0.1, 0.1001, 0.9],
        [-0.5, 1.5],
        [-1.0, 0.3],
    ]
    chosen += [(random.permutation(60)[: 1 + k % 8] / 40 - 0.24).tolist() for k in range(200)]
    polynomials = []
    for roots in chosen:
        powers, n = np.polynomial.Polynomial.fromroots(roots).coef, len(roots)
        terms = [[comb(k, j) / comb(n, j) * powers[j] for j in range(k + 1)] for k in range(n + 1)]
        polynomials.append([fsum(one) for one in terms])
    for roots, found in zip(chosen, roots_of(polynomials), strict=True):
        assert found == pytest.approx(sorted(x for x in roots if 0 < x < 1), abs=1e-7)


@pytest.mark.parametrize("k", range(len(ROUGH_NODES)))
def test_an_event_that_is_no_number_within_a_step_does_not_recur(k: int) -> None:
    values = np.cos(9.0 * ROUGH_NODES)
    assert may_recur(values)
    values[k] = np.nan
    assert not may_recur(values)
