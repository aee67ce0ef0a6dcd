"""Linkages move on their own branch through configurations with dependent constraints."""

import warnings
from dataclasses import replace
from functools import cache
from typing import Any

import linkages
import numpy as np
import pytest
import sympy as sp
from scipy.integrate import solve_ivp

import generated.four_bar as four_bar
from derive import Coordinate, Input, Parameter, PointMass, System
from holonomic import Event, Held, build, consistent_start, ensemble, integrate, prepare
from solvers import Status
from solvers.equations.module import GeneratedModule
from solvers.integration.checks.predictability import UnfinishedWarning
from solvers.integration.compiled.extended import ExtendedError, integrate_extended
from solvers.integration.loops import singular_passage

#: Bars stand upright; their tips move by 1 m/s.
UPRIGHT = np.array([*[np.pi / 2] * 3, 0, 0, *[-1.0] * 3, 0, 0])
TOLERANCES = {"rtol": 1e-10, "atol": 1e-10}
#: Lengths of parallelograms and antiparallelograms.
EQUAL = {"a": 0.3, "b": 0.8, "c": 0.3, "d": 0.8}


@pytest.fixture(scope="module")
def squares() -> GeneratedModule:
    """Two square loops side by side, of uniform bars (IFToMM's benchmark N-four-bar, N = 2)."""
    m, g = sp.symbols("m g", positive=True)
    upright, couplers = sp.symbols("a0:3", real=True), sp.symbols("b1:3", real=True)

    def along(angle: sp.Symbol) -> sp.Matrix:
        return sp.Matrix([sp.cos(angle), sp.sin(angle)])

    def bar(start: sp.Matrix, angle: sp.Symbol) -> list[PointMass]:
        parts = ((m / 6, 0), (2 * m / 3, sp.Rational(1, 2)), (m / 6, 1))
        return [PointMass(mass, tuple(start + part * along(angle))) for mass, part in parts]

    bases = [sp.Matrix([k, 0]) for k in range(3)]
    tips = [base + along(angle) for base, angle in zip(bases, upright, strict=True)]
    ends = [tip + along(angle) for tip, angle in zip(tips, couplers, strict=False)]
    return build(System(
        "squares", "Two square loops",
        [Coordinate(q, "rad", "direction of a bar") for q in (*upright, *couplers)],
        [Parameter(m, "kg", 1, "mass"), Parameter(g, "m/s^2", 9.81, "gravity")],
        [one for start, q in zip(bases + tips[:2], upright + couplers, strict=True)
         for one in bar(start, q)],
        constraints=[x for end, tip in zip(ends, tips[1:], strict=True) for x in end - tip],
    ))  # fmt: skip


def pendulum(end: float, rate: float = -1.0, **options: Any) -> Any:
    """The motion of a bar by SciPy: the couplers do not turn, so that one angle moves all."""

    def rhs(_t: float, y: np.ndarray) -> list[float]:
        return [y[1], -9.81 * np.cos(y[0]) * (3 / 2 + 2) / (3 / 3 + 2)]

    tight = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-13}
    return solve_ivp(rhs, (0, end), [np.pi / 2, rate], **tight, **options)


@pytest.mark.long("more cases of the same kind")
@pytest.mark.parametrize(("method", "backend"), [
    *((method, None) for method in ("verner853", "verner98", "gauss8", "radau3")),
    *((method, "python") for method in ("dop853", "gauss4", "DOP853")),
])  # fmt: skip
def test_square_loops_fold_and_open_as_a_pendulum(
    method: str, backend: str | None, squares: GeneratedModule
) -> None:
    times = np.linspace(0, 3, 61)
    run = integrate(
        squares, (0, 3), UPRIGHT, {}, method=method, backend=backend, t_eval=times, **TOLERANCES
    )
    assert run.status is Status.FINISHED
    expected = pendulum(3, t_eval=times).y
    assert np.abs(run.y[:3] - expected[0]).max() < 1e-7
    assert np.abs(run.y[3:5]).max() < 1e-7
    assert np.abs(run.y[5:8] - expected[1]).max() < 1e-6


def test_a_single_constraint_without_gradient_is_passed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Crank and rod of equal lengths turn together about a slider at rest, uniformly.

    So the errors of the polynomials that continue the motion are known, which are estimated.
    """
    landed, errors, arguments = singular_passage._landed, [], []

    def recorded(problem: Any, end: float, y: np.ndarray, error: np.ndarray) -> Any:
        exact = np.array([0.3 + 4 * end, 0.3 - np.pi + 4 * end, 4.0, 4.0])
        errors.append((error.max(), np.abs(y - exact).max()))
        arguments.append((problem, end, y, error))
        return landed(problem, end, y, error)

    monkeypatch.setattr(singular_passage, "_landed", recorded)
    crank = build(replace(linkages.slider_crank(), name="folded", keep_coordinates=False))
    start = {"phi": 0.3, "psi": 0.3 - np.pi, "phi_dot": 4.0, "psi_dot": 4.0}
    params = {"b": 0.25, "g": 0.0}
    run = integrate(crank, (0, 1), start, params, method="radau5", backend="python")
    assert run.status is Status.FINISHED
    assert len(crank.MULTIPLIERS) == 2  # of which one eliminates the slider
    assert len(errors) > 3
    assert all(exact / 20 < estimated < 1e-8 for estimated, exact in errors)
    assert np.abs(run.y[0] - 0.3 - 4 * run.t).max() < 1e-7
    assert np.abs(run.y[1] - 0.3 + np.pi - 4 * run.t).max() < 1e-7
    # a state away from the constraints by more than the error is on another branch
    problem, end, y, error = arguments[-1]
    assert landed(problem, end, y, error) is not None
    assert landed(problem, end, y + np.array([5e-6, 0, 0, 0]), error) is None


@pytest.fixture(scope="module")
def driven_bars() -> GeneratedModule:
    """A four-bar linkage with a torque on its crank."""
    torque = sp.Symbol("torque", real=True)
    inputs = [Input(torque, "N m", "on the crank")]
    bars = linkages.four_bar()
    return build(replace(bars, name="driven_bars", forces=(torque, 0, 0), inputs=inputs))


@pytest.mark.parametrize("inputs", [
    Held([0.0, 0.2, 0.4], [[0.5, 0.4, 0.5]]), Held(0.1, lambda _t, y: (0.5 - 0.1 * y[3],)),
])  # fmt: skip
def test_a_parallelogram_with_held_inputs_remains_one(
    inputs: Held, driven_bars: GeneratedModule
) -> None:
    """Bars of equal lengths in pairs: the rod keeps its direction."""
    start = {"phi": 1.0, "theta": 0.0, "psi": 1.0, "phi_dot": 9.0, "theta_dot": 0, "psi_dot": 9.0}
    options: dict[str, Any] = {"inputs": inputs, "method": "gauss8", "backend": "python"}
    times = np.linspace(0, 0.6, 11)
    run = integrate(driven_bars, (0, 0.6), start, {"c": 0.25}, t_eval=times, **options)
    assert run.status is Status.FINISHED
    assert run.t.tolist() == times.tolist()
    assert abs(run.y[0, -1] - run.y[0, 0]) > np.pi
    assert np.abs(run.y[1]).max() < 1e-6
    assert run.inputs.shape == (1, 11)


@pytest.mark.long("other tests reach its code")
def test_motions_with_a_table_of_inputs_are_passed_together_and_one_by_one(
    driven_bars: GeneratedModule,
) -> None:
    """The rod of a parallelogram keeps its direction, with 30 jumps of the torque."""
    samples = np.linspace(0, 3, 31)
    torques = 0.5 * np.cos(3 * samples[:-1])
    start = np.array([1.0, 0.0, 1.0, 9.0, 0.0, 9.0])
    held = Held(samples[:-1], [torques])
    options: dict[str, Any] = {"inputs": held, "method": "verner98", **TOLERANCES}
    run = integrate(driven_bars, (0, 3), start, {"c": 0.25}, t_eval=samples, energy=True, **options)
    assert run.status is Status.FINISHED
    assert run.t.tolist() == samples.tolist()
    assert run.y[0, -1] > 4 * np.pi
    assert np.abs(run.y[1]).max() < 1e-9
    assert run.energy is not None  # the torques' work
    assert np.abs(np.diff(run.energy) - torques * np.diff(run.y[0])).max() < 1e-8
    motions = ensemble(driven_bars, (0, 3), np.transpose([start, start]), {"c": 0.25}, **options)
    assert {*motions.status} == {Status.FINISHED}
    assert np.abs(motions.y - run.y[:, -1:]).max() < 1e-7


def test_ten_seconds_keep_energy_and_constraints(squares: GeneratedModule) -> None:
    run = integrate(squares, (0, 10), UPRIGHT, {}, energy=True, **TOLERANCES)
    assert run.status is Status.FINISHED
    assert (np.diff(run.t) > 0).all()
    assert run.energy is not None
    assert np.abs(run.energy - run.energy[0]).max() < 1e-8
    assert np.abs(squares.constraints_many(run.t, run.y, squares.DEFAULTS)).max() < 1e-10
    assert run.y[0, -1] == pytest.approx(pendulum(10).y[0, -1], abs=1e-7)


def test_events_within_a_passage_are_located(squares: GeneratedModule) -> None:
    events = [Event(squares, "a0", 0.0), Event(squares, "a0", -np.pi / 2)]
    run = integrate(squares, (0, 1.2), UPRIGHT, {}, events=events, **TOLERANCES)
    crossings = [lambda _t, y: y[0], lambda _t, y: y[0] + np.pi / 2]
    for (found,), (expected,) in zip(
        run.t_events, pendulum(1.2, events=crossings).t_events, strict=True
    ):
        assert found == pytest.approx(expected, abs=1e-9)


def test_a_motion_can_end_within_a_passage(squares: GeneratedModule) -> None:
    aligned = pendulum(1.2, events=[lambda _t, y: y[0]]).t_events[0][0]
    for end in (aligned - 1e-6, aligned, aligned + 1e-6):
        run = integrate(squares, (0, end), UPRIGHT, {}, **TOLERANCES)
        assert run.status is Status.FINISHED
        assert run.t[-1] == end
        assert np.abs(run.y[:3, -1] - pendulum(end).y[0, -1]).max() < 1e-8


def test_ensembles_and_prepared_runs_agree_with_one_motion(squares: GeneratedModule) -> None:
    starts = np.stack([UPRIGHT, UPRIGHT, UPRIGHT], axis=1)
    starts[5:8] *= [1.0, -0.8, 0.5]
    runs = ensemble(squares, (0, 2), starts, {}, t_eval=[1.0, 2.0], **TOLERANCES)
    prepared = prepare(squares, {}, **TOLERANCES)
    for k in range(3):
        expected = pendulum(2, starts[5, k], t_eval=[1.0, 2.0]).y[0]
        assert runs.status[k] is Status.FINISHED
        assert np.abs(runs.samples[:3, k] - expected).max() < 1e-7
        assert prepared((0, 2), starts[:, k])[0] == pytest.approx(expected[-1], abs=1e-7)


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize("method", ["verner98", "gauss8", "radau5"])
def test_a_parallelogram_remains_one(method: str) -> None:
    start = consistent_start(four_bar, {"phi": 1.0, "phi_dot": 8.0}, EQUAL,
        guess={"psi": 0.0, "chi": 1.0})  # fmt: skip
    run = integrate(four_bar, (0, 3), start.y, EQUAL, method=method, energy=True, **TOLERANCES)
    assert run.status is Status.FINISHED
    assert run.y[0, -1] > 6 * np.pi
    assert np.abs(run.y[1]).max() < 1e-9
    assert np.abs(run.y[2] - run.y[0]).max() < 1e-9
    assert run.energy is not None
    assert np.abs(run.energy - run.energy[0]).max() < 1e-8


def test_a_parallelogram_remains_one_by_a_method_of_scipy() -> None:
    start = consistent_start(four_bar, {"phi": 1.0, "phi_dot": -8.0}, EQUAL,
        guess={"psi": 0.0, "chi": 1.0})  # fmt: skip
    run = integrate(four_bar, (0, 0.5), start.y, EQUAL, method="DOP853", rtol=1e-8, atol=1e-8)
    assert run.status is Status.FINISHED
    assert run.y[0, -1] < -np.pi
    assert np.abs(run.y[1]).max() < 1e-9
    assert np.abs(run.y[2] - run.y[0]).max() < 1e-9


@pytest.mark.long("compiles three loops", keep=1)
@pytest.mark.parametrize("precision", ["double-double", "long double", "quadruple"])
def test_longer_numbers_end_before_a_singular_configuration(precision: str) -> None:
    """All bars lie on one line when the crank has turned to π."""
    start = consistent_start(four_bar, {"phi": 1.0, "phi_dot": 8.0}, EQUAL,
        guess={"psi": 0.0, "chi": 1.0}).y  # fmt: skip
    params = four_bar.params(**EQUAL)
    at_line = Event(four_bar, "phi", np.pi, terminal=True)
    line = integrate(four_bar, (0, 1), start, EQUAL, events=at_line, **TOLERANCES).t[-1]
    states = integrate_extended(four_bar, params, start, [0, 0.9 * line], precision, 1e-16)
    assert np.abs(states[:, 1]).max() < 1e-15
    for tolerance in (1e-14, 1e-16, 1e-19):
        with pytest.raises(ExtendedError, match="constraints nearly depend on each other"):
            integrate_extended(four_bar, params, start, [0, 2], precision, tolerance)


def test_an_antiparallelogram_remains_one() -> None:
    start = consistent_start(four_bar, {"phi": 1.0, "phi_dot": 8.0}, EQUAL,
        guess={"psi": -0.5, "chi": -2.0})  # fmt: skip
    run = integrate(four_bar, (0, 3), start.y, EQUAL, **TOLERANCES)
    assert run.status is Status.FINISHED
    # half angles of an antiparallelogram have tangents of a constant ratio
    ratio = (EQUAL["d"] + EQUAL["a"]) / (EQUAL["d"] - EQUAL["a"])
    phi, _, chi = run.y[:3] / 2
    defect = np.sin(phi) * np.cos(chi) * (1 / ratio) + np.cos(phi) * np.sin(chi)
    other = np.sin(phi) * np.cos(chi) * ratio + np.cos(phi) * np.sin(chi)
    assert min(np.abs(defect).max(), np.abs(other).max()) < 1e-8
    assert np.abs(np.diff(run.y[0])).sum() > 6 * np.pi


def test_without_a_certain_continuation_no_sample_lies_beyond(
    squares: GeneratedModule, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(singular_passage, "LARGEST", 0.0)
    with pytest.warns(UnfinishedWarning, match="depend on each other"):
        run = integrate(squares, (0, 3), UPRIGHT, {}, energy=True, **TOLERANCES)
    assert run.status is Status.SINGULAR
    assert "depend on each other" in run.message
    assert run.t[-1] < pendulum(1.2, events=[lambda _t, y: y[0]]).t_events[0][0]
    assert run.energy is not None
    assert np.abs(run.energy - run.energy[0]).max() < 1e-9


@pytest.mark.campaign
@pytest.mark.parametrize("seed", range(300))
def test_linkages_with_aligned_bars_keep_energy_and_constraints(seed: int) -> None:
    """Parallelograms, kites, other linkages that fold, and those that nearly do."""
    rng = np.random.default_rng(seed)
    a, b, c = rng.uniform(0.2, 1, 3)
    shortest, middle, longest = sorted((a, b, c))
    lengths = [
        (a, b, a, b), (a, a, b, b), (a, b, b, a), (a, b, a * (1 + 10 ** rng.uniform(-14, -2)), b),
        tuple(rng.permutation([shortest, middle, longest, middle + longest - shortest])),
    ][rng.integers(5)]  # fmt: skip
    values = dict(zip("abcd", map(float, lengths), strict=True))
    values |= dict(zip(("m1", "m2", "m3"), rng.uniform(0.1, 2, 3).tolist(), strict=True))
    given = {"phi": rng.uniform(-3, 3), "phi_dot": rng.uniform(-12, 12)}
    guess = dict(zip(("psi", "chi"), rng.uniform(-3, 3, 2), strict=True))
    try:
        start = consistent_start(four_bar, given, values, guess=guess).y
    except ValueError:
        pytest.skip("the bars do not meet at this angle")
    method = str(rng.choice(["verner853", "verner98", "gauss8", "radau5", "dop853", "radau3"]))
    tolerance = 10 ** rng.uniform(-11, -6)
    options = {"method": method, "rtol": tolerance, "atol": tolerance, "energy": True}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # motions of some thousand rad/s are not predictable
        run = integrate(four_bar, (0, 5), start, values, **options)
    params = four_bar.params(**values)
    inertia = np.abs(np.array(four_bar.mass_matrix(0, start.tolist(), params))).max()
    assert run.energy is not None
    size = np.abs(run.energy).max() + inertia * np.abs(start[3:]).max() ** 2
    assert run.status in (Status.FINISHED, Status.SINGULAR)
    assert np.abs(run.energy - run.energy[0]).max() < 3e3 * tolerance * size
    assert np.abs(four_bar.constraints_many(0, run.y, params)).max() < 1e3 * tolerance


@cache
def built_ring(n: int) -> GeneratedModule:
    return build(linkages.ring(n))


@pytest.mark.campaign
@pytest.mark.filterwarnings("ignore::UserWarning")  # near singular starts, and chaotic motions
@pytest.mark.parametrize("seed", range(300))
def test_rings_that_start_nearly_folded_keep_energy_and_constraints(seed: int) -> None:
    """Of 3 to 12 links that can lie on one line, up to small angles at the start."""
    rng, n = np.random.default_rng(seed), 3 + seed % 10
    lengths, signs = rng.uniform(0.3, 1, n), rng.choice([-1, 1], n)
    ground = float((signs * lengths).sum())
    if abs(ground) < 0.05:
        pytest.skip("the last point would be the first one")
    module = built_ring(n)
    params = (*module.DEFAULTS[:2], abs(ground), *lengths.tolist())
    folded = np.where(signs * ground > 0, np.pi, 0.0)
    angles = folded + 10 ** rng.uniform(-3, -0.5) * rng.normal(size=n)
    guess = np.concatenate([angles, rng.uniform(0.3, 3) * rng.normal(size=n)])
    method = ("verner853", "verner98", "gauss8", "radau5", "dop853")[seed // 10 % 5]
    try:
        start = consistent_start(module, {}, params, guess=guess).y
        run = integrate(module, (0, 3), start, params, method=method, energy=True, **TOLERANCES)
    except ValueError as refusal:
        pytest.skip(str(refusal))
    if run.status is Status.FINISHED:
        assert run.energy is not None
        assert np.abs(run.energy - run.energy[0]).max() < 1e-6 * max(1.0, abs(run.energy[0]))
        assert np.abs(module.constraints_many(run.t, run.y, params)).max() < 1e-7
