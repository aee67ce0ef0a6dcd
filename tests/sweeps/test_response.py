"""Frequency responses agree with closed forms, harmonic balance and SciPy."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve

import generated.duffing as duffing
from solvers import Extremes, Grid, Pool, Random, Response, Results, Sweep, partial_results, sweep
from solvers.sweeps.execution import worker
from solvers.sweeps.sweep_figure import figure
from solvers.sweeps.sweep_summary import summary

PERIOD = "2*pi/Omega"
ONE = Response(("x",), "Omega", PERIOD, 50)
M, K, C, BETA, F = 1.0, 1.0, 0.15, 1.0, 0.3
VALUES = {"c": C, "F": F, "x": 0.0}
OMEGA = np.linspace(0.9, 1.9, 41)
#: Harmonics of the balance, and times of a period.
HARMONICS, TIMES = 15, 4096


@pytest.fixture(scope="module")
def bent(tmp_path_factory: pytest.TempPathFactory) -> Results:
    """Duffing's oscillator over a range with both jumps."""
    definition = Sweep(duffing, Grid({"Omega": OMEGA}), {"r": ONE}, values=VALUES, name="bent")
    return sweep(definition, tmp_path_factory.mktemp("bent"))


def test_the_amplitude_of_a_linear_oscillator_is_its_closed_form(tmp_path: Path) -> None:
    omega = np.linspace(2.5, 0.4, 12)  # downwards on the axis, too
    values = {"m": 1.3, "k": 2.0, "beta": 0.0, "c": 0.6, "F": 0.7, "x": 1.0}
    definition = Sweep(duffing, Grid({"Omega": omega}), {"r": ONE}, values=values, rtol=1e-12)
    amplitudes = sweep(definition, tmp_path).maps["r"]
    expected = 0.7 / np.abs(2.0 - 1.3 * omega**2 + 0.6j * omega)
    assert_allclose(amplitudes[:, 0], np.stack([expected, expected], 1), atol=1e-8)


def balance(coefficients: np.ndarray, omega: float, count: int = 64) -> np.ndarray:
    """Residual of the equation of motion of a Fourier series, as coefficients of its harmonics."""
    spectrum = np.zeros(count // 2 + 1, complex)
    spectrum[: HARMONICS + 1] = coefficients[0::2] + 1j * coefficients[1::2]
    rates = 1j * omega * np.arange(len(spectrum))
    x = np.fft.irfft(spectrum, count) * count
    forces = K * spectrum + C * rates * spectrum + M * rates**2 * spectrum
    forces += BETA * np.fft.rfft(x**3) / count
    forces[1] -= F / 2
    kept = forces[: HARMONICS + 1]
    residual = np.stack([kept.real, kept.imag], 1).ravel()
    residual[1] = coefficients[1]  # the mean is real
    return residual


def balanced(omegas: np.ndarray) -> np.ndarray:
    """Amplitudes by harmonic balance, each from the solution before; NaN beyond the fold."""
    amplitudes, guess = [], np.zeros(2 * HARMONICS + 2)
    for omega in omegas:
        solution, _, status, _ = fsolve(balance, guess, (omega,), full_output=True, xtol=1e-13)
        spectrum = np.zeros(TIMES // 2 + 1, complex)
        spectrum[: HARMONICS + 1] = solution[0::2] + 1j * solution[1::2]
        x = np.fft.irfft(spectrum, TIMES) * TIMES
        amplitudes.append(np.ptp(x) / 2)
        if status != 1 or (len(amplitudes) > 1 and abs(np.diff(amplitudes)[-1]) > 0.2):
            amplitudes[-1] = np.nan
            break
        guess = solution
    return np.array(amplitudes + [np.nan] * (len(omegas) - len(amplitudes)))


@pytest.mark.long("other tests reach its code")
def test_both_branches_and_their_jumps_are_those_of_harmonic_balance(bent: Results) -> None:
    up, down = bent.maps["r"][:, 0].T
    for found, expected in ((up, balanced(OMEGA)), (down[::-1], balanced(OMEGA[::-1]))):
        on_branch = np.isfinite(expected)
        assert 10 < on_branch.sum() < len(OMEGA) - 5
        assert_allclose(found[on_branch], expected[on_branch], atol=2e-5)
        jump = int(np.argmax(np.abs(np.diff(found)))) + 1
        assert abs(jump - on_branch.sum()) <= 1
    assert OMEGA[np.argmax(np.abs(np.diff(up)))] > OMEGA[np.argmax(np.abs(np.diff(down)))] + 0.2


def test_each_motion_starts_with_the_end_of_its_neighbour_as_in_scipy(tmp_path: Path) -> None:
    # too few periods to settle, so that every amplitude depends on all motions before
    chosen, skip, count = np.linspace(1.0, 1.5, 5), 3, 2
    one = Response(("x",), "Omega", PERIOD, skip, count)
    axes = Grid({"Omega": chosen[::-1]})  # upwards are larger values, whatever their order
    numbers = sweep(Sweep(duffing, axes, {"r": one}, values=VALUES), tmp_path).maps["r"][::-1, 0]
    for direction, order in enumerate([np.arange(5), np.arange(5)[::-1]]):
        state = np.array([0.0, 0.0])
        for k in order:
            period, params = 2 * np.pi / chosen[k], (M, K, BETA, C, F, chosen[k])
            times = period * (skip + np.linspace(0, count, 20001))
            motion = solve_ivp(duffing.rhs, (0, times[-1]), state, "DOP853", times,
                               args=(params,), rtol=1e-10, atol=1e-12)  # fmt: skip
            state = motion.y[:, -1]
            assert numbers[k, direction] == pytest.approx(np.ptp(motion.y[0]) / 2, abs=1e-6)


def test_the_amplitude_about_a_shifted_equilibrium_is_half_the_range(tmp_path: Path) -> None:
    values = {"k": -1.0, "beta": 1.0, "F": 0.01, "c": 0.3, "x": 1.0}  # about x = 1
    results = sweep(
        Sweep(duffing, Grid({"Omega": [0.5, 1.0]}), {"r": ONE}, values=values), tmp_path
    )
    linear = 0.01 / np.abs(2.0 - np.array([0.5, 1.0]) ** 2 + 0.3j * np.array([0.5, 1.0]))
    assert_allclose(results.maps["r"][:, 0], np.stack([linear, linear], 1), rtol=0.01)


def test_responses_resume_to_the_same_bits_for_any_number_of_workers(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    axes = Grid({"F": np.linspace(0.1, 0.4, 5), "Omega": np.linspace(1.0, 1.6, 7)})
    definition = Sweep(duffing, axes, {"r": Response(("x",), "Omega", PERIOD, 8)},
                       values={"x": 0.0})  # fmt: skip
    whole = sweep(definition, tmp_path / "whole", pool=Pool(workers=1)).maps["r"].tobytes()
    monkeypatch.setattr(worker, "COST", 1e-12)
    parts = sweep(definition, tmp_path / "parts", pool=Pool(workers=2))
    chunks = sorted((tmp_path / "parts" / "chunks").glob("*.npy"))
    assert len(chunks) == 5  # whole branches
    assert parts.maps["r"].tobytes() == whole
    for chunk in chunks[::2]:
        chunk.unlink()
    partial = partial_results(definition, tmp_path / "parts")
    assert partial.count == {"not done yet": 21, "finished": 14}
    assert sweep(definition, tmp_path / "parts").maps["r"].tobytes() == whole


def test_a_branch_does_not_depend_on_others(bent: Results, tmp_path: Path) -> None:
    axes = Grid({"F": [0.1, F], "Omega": OMEGA[:6]})
    both = Sweep(duffing, axes, {"r": ONE}, values={"c": C, "x": 0.0})
    numbers = sweep(both, tmp_path).maps["r"]
    assert numbers[1, :, 0, 0].tobytes() == bent.maps["r"][:6, 0, 0].tobytes()


def test_a_branch_that_fails_has_a_status_from_there_on(tmp_path: Path) -> None:
    # periods at the lowest frequency have too many steps, which is the last one downwards
    axes = Grid({"Omega": [0.2, 1.0, 1.5]})
    results = sweep(Sweep(duffing, axes, {"r": ONE}, values=VALUES, max_steps=2800), tmp_path)
    known = np.isfinite(results.maps["r"][:, 0])
    assert known.T.tolist() == [[False, False, False], [False, True, True]]
    assert results.count == {"step limit": 3}


def test_both_directions_are_distinguished_in_the_figure(bent: Results) -> None:
    (panel,) = figure(bent).axes
    assert [text.get_text() for text in panel.get_legend().get_texts()] == ["up", "down"]
    lines = panel.get_lines()
    assert len({line.get_linestyle() for line in lines}) == 2
    assert panel.get_ylabel() == "amplitude of $x$ / m"
    for line, numbers in zip(lines, bent.maps["r"][:, 0].T, strict=True):
        assert np.asarray(line.get_ydata()).tolist() == numbers.tolist()
    assert "51 periods of 2*pi/Omega" in [*summary(bent, None, {})][1]


@pytest.mark.parametrize(("changes", "words"), [
    ({"axes": Grid({"Omega": [1.0], "F": [1.0]})}, "last axis of a grid, whose axes are Omega, F"),
    ({"axes": Grid({"F": [1.0]})}, "along = 'Omega' must be a parameter and the last axis"),
    ({"axes": Random({"Omega": (1, 2)}, 5, 0)}, "last axis of a grid"),
    ({"maps": {"r": ONE, "e": Extremes(("x",))}}, "map r follows motions .* be the only map"),
    ({"maps": {"r": Response(("x_dot",), "Omega", PERIOD, 5)}}, "x_dot is not a coordinate"),
    ({"duration": 5.0}, "leave it out"),
])  # fmt: skip
def test_an_invalid_response_is_refused(changes: dict[str, Any], words: str) -> None:
    valid = {"axes": Grid({"Omega": [1.0]}), "maps": {"r": ONE}}
    with pytest.raises(ValueError, match=words):
        Sweep(duffing, values={"x": 0.0}, **(valid | changes))
