"""Stroboscopic sections and transients agree with closed forms and with SciPy."""

from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.integrate import solve_ivp

import generated.double_pendulum as dp
import generated.driven_pendulum as driven
import generated.duffing as duffing
import generated.henon_heiles as hh
import generated.single_pendulum as sp
from solvers import Extremes, Final, Grid, Lyapunov, Samples, Section, Sweep, sweep
from solvers.app.modules import load as load_module
from solvers.io.quantity import QuantityError, formula
from solvers.sweeps import sweep_figure
from solvers.sweeps.definition.sampling import Sampling
from solvers.sweeps.definition.sweep_reading import find
from solvers.sweeps.execution import worker
from solvers.sweeps.maps.stroboscopic import Stroboscopic
from solvers.sweeps.results import Results
from solvers.sweeps.sweep_figure import figure

PERIOD = "2*pi/Omega"
LINEAR = {"k": 2.0, "beta": 0.0, "c": 0.5, "F": 0.7, "m": 1.3}


def steady(omega: np.ndarray, phase: float) -> np.ndarray:
    """Displacement and velocity of the driven linear oscillator, long after its start."""
    m, k, c, force = (LINEAR[name] for name in ("m", "k", "c", "F"))
    x = force / (k - m * omega**2 + 1j * c * omega) * np.exp(1j * phase)
    return np.array([x.real, (1j * omega * x).real])


@pytest.mark.parametrize("phase", [0.0, 1.0, 4.5])
def test_the_section_of_a_linear_oscillator_is_one_point_for_each_frequency(
    phase: float, tmp_path: Path
) -> None:
    omega = np.linspace(0.5, 3.0, 21)
    one = Stroboscopic(("x", "x_dot"), 5, PERIOD, phase, skip=45)
    definition = Sweep(duffing, Grid({"Omega": omega}), {"s": one}, values=LINEAR | {"x": 1.0})
    points = sweep(definition, tmp_path).maps["s"]
    # the start decays by exp(-c t/(2 m)) in 45 periods of at least 2.1 s
    assert_allclose(points, np.tile(steady(omega, phase).T[..., np.newaxis], 5), atol=1e-7)


def test_the_first_number_of_a_section_is_the_start(tmp_path: Path) -> None:
    axes = Grid({"x": [0.1, 0.2], "Omega": [1.0, 2.0, 3.0]})
    both = [
        sweep(Sweep(duffing, axes, {"s": Stroboscopic(("x",), *numbers)}), tmp_path / str(k))
        for k, numbers in enumerate([(7, PERIOD), (5, PERIOD, 0.0, 2)])
    ]
    every, later = (one.maps["s"] for one in both)
    assert every[:, :, 0, 0].tolist() == [[0.1] * 3, [0.2] * 3]
    assert_allclose(later, every[..., 2:], rtol=0, atol=1e-12)
    assert later.shape == (2, 3, 1, 5)


def period(points: np.ndarray) -> int:
    """The period of points on a circle of angles and a line; 0 if they have none up to 8."""
    for n in range(1, 9):
        if np.abs(points[:, n:] - points[:, :-n]).max() < 1e-4:
            return n
    return 0


@pytest.mark.long("other tests reach its code")
def test_periods_of_the_driven_pendulum_are_those_that_scipy_gives(tmp_path: Path) -> None:
    # the cascade of period doublings of the rotating pendulum, chaos, and a window of it
    amplitudes = np.array([0.12, 0.3, 0.55, 0.612, 0.72, 0.95])
    values = {"Omega": 2.0, "c": 0.3, "g": 1.0, "theta": 0.5}
    one = Stroboscopic(("theta_dot",), 16, PERIOD, skip=100)
    definition = Sweep(driven, Grid({"a": amplitudes}), {"s": one}, values=values)
    found = [period(points) for points in sweep(definition, tmp_path).maps["s"]]
    times = np.pi * np.arange(100, 116)
    expected = []
    for a in amplitudes:
        params = (1.0, 1.0, a, 2.0, 0.3, 1.0)
        solution = solve_ivp(driven.rhs, (0, times[-1]), (0.5, 0.0), "DOP853", times,
                             rtol=1e-10, atol=1e-10, args=(params,))  # fmt: skip
        expected.append(period(solution.y[1:]))
    assert found == expected
    assert {0, 1, 2, 4} <= {*found}


def test_a_skipped_crossing_is_not_stored(tmp_path: Path) -> None:
    axes, values = Grid({"y": [0.1, 0.2]}), {"x": 0.0, "x_dot": "energy", "energy": 0.1}
    maps = {
        "all": Section(("y", "y_dot"), 9, "x", direction=1),
        "late": Section(("y", "y_dot"), 6, "x", direction=1, skip=3),
        "few": Section(("y", "y_dot"), 2, "x", direction=-1, skip=1),
    }
    results = sweep(Sweep(hh, axes, maps, 60.0, values), tmp_path)
    assert results.maps["late"].tolist() == results.maps["all"][..., 3:].tolist()
    assert np.isfinite(results.maps["few"]).all()


def test_a_transient_is_part_of_no_map(tmp_path: Path) -> None:
    # a decaying motion is smaller after 20 s
    values = {"k": 1.0, "beta": 0.3, "F": 0.0, "c": 0.1}
    maps = {"reach": Extremes(("x",)), "path": Samples(("x", "x_dot"), 5), "end": Final(("x",))}
    definition = Sweep(duffing, Grid({"x": [0.5, 1.0, 2.0]}), maps, 50.0, values, skip=20.0)
    results = sweep(definition, tmp_path)
    for k, x in enumerate((0.5, 1.0, 2.0)):
        params = (1.0, 1.0, 0.3, 0.1, 0.0, 1.0)
        solution = solve_ivp(duffing.rhs, (0, 50), (x, 0.0), "DOP853", np.linspace(20, 50, 30001),
                             rtol=1e-12, atol=1e-12, args=(params,))  # fmt: skip
        ends = [solution.y[0].min(), solution.y[0].max()]
        assert_allclose(results.maps["reach"][k, 0], ends, atol=1e-6)
        assert_allclose(results.maps["path"][k], solution.y[:, ::7500], atol=1e-7)
        assert_allclose(results.maps["end"][k], solution.y[0, -1], atol=1e-7)


def test_an_exponent_after_a_transient_is_that_of_the_attractor(tmp_path: Path) -> None:
    # of a damped linear oscillator: -c/(2 m), up to the rotation of the perturbation
    values = LINEAR | {"Omega": 1.0}
    definition = Sweep(duffing, Grid({"x": [0.5, 1.0]}), {"l": Lyapunov()}, 330.0, values, skip=30)
    assert_allclose(sweep(definition, tmp_path).maps["l"], -0.5 / 2.6, atol=3e-3)


def test_a_motion_that_fails_in_its_transient_has_a_status(tmp_path: Path) -> None:
    axes = Grid({"theta": [0.01, 3.1]})
    definition = Sweep(sp, axes, {"end": Final(("theta",))}, 31.0, skip=30.0, max_steps=40)
    results = sweep(definition, tmp_path)
    assert results.count == {"step limit": 2}
    assert np.isnan(results.maps["end"]).all()


@pytest.fixture(scope="module")
def diagram(tmp_path_factory: pytest.TempPathFactory) -> Results:
    folder = tmp_path_factory.mktemp("diagram")
    path = folder / "bifurcations.toml"
    path.write_text(
        'system = "driven_pendulum"\nparameters = { Omega = "2 rad/s", c = 0.3, g = 1 }\n'
        "initial = { theta = 0.5 }\naxes.a = { from = 0.1, to = 1, count = 40 }\n"
        '[maps.section]\nkind = "stroboscopic"\nof = ["theta_dot", "theta"]\n'
        'every = "2*pi/Omega"\nskip = 20\ncount = 10\n'
    )
    return sweep(find(str(path), load_module), folder / "out")


@pytest.mark.long("other tests reach its code")
def test_a_section_over_many_values_of_a_parameter_is_drawn_as_a_diagram(diagram: Results) -> None:
    first, second = figure(diagram).axes
    assert [first.get_xlabel(), first.get_ylabel()] == ["$a$ / m", r"$\dot{\theta}$ / (rad/s)"]
    assert second.get_ylabel() == r"$\theta$ / rad"
    (points,) = first.get_lines()
    x, y = np.asarray(points.get_data())
    assert sorted(zip(x, y, strict=True)) == sorted(
        (a, v) for a, values in zip(diagram.axes["a"], diagram.maps["section"], strict=True)
        for v in values[0]
    )  # fmt: skip


def test_of_too_many_points_a_diagram_shows_every_kth(
    diagram: Results, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sweep_figure, "POINTS", 150)
    (points,) = figure(diagram).axes[0].get_lines()
    shown = points.get_ydata()
    assert_array_equal(shown, np.ravel(diagram.maps["section"][:, 0, ::3]))  # of 40 times 10


def test_a_sweep_of_periods_resumes_to_the_same_bits(
    diagram: Results, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(worker, "COST", 1e-7)
    definition = diagram.definition
    first = sweep(definition, tmp_path)
    chunks = sorted((tmp_path / "chunks").glob("*.npy"))
    assert len(chunks) > 3
    for chunk in chunks[1::2]:
        chunk.unlink()
    again = sweep(definition, tmp_path)
    for results in (first, again):
        assert results.maps["section"].tobytes() == diagram.maps["section"].tobytes()


@pytest.mark.parametrize(("changes", "words"), [
    ({"duration": 5.0}, "`every`, `skip` and `count` of map s determine it: leave it out"),
    ({"skip": 5.0}, "give `skip` of map s, in periods, instead"),
    ({"axes": Grid({"Omega": [1.0, -1.0]})}, "every = '2.pi/Omega' is -6.28319 s, at Omega = -1"),
    ({"axes": Grid({"Omega": [0.0, 1.0]})}, "every = '2.pi/Omega' is inf s, at Omega = 0"),
    ({"maps": {"s": Stroboscopic(("x",), 5, "2*pi*Omega")}}, "is not a time in s; parameters are"),
    ({"maps": {"s": Stroboscopic(("x",), 5, "2*pi/Omga")}}, "'Omga' .did you mean 'Omega'"),
    ({"maps": {"s": Stroboscopic(("x",), 5, "m + ")}}, "'m . ' is no formula"),
    ({"maps": {"s": Stroboscopic(("x",), 5, -1.0)}}, "every = -1.0 must be a positive period"),
    ({"maps": {"s": Stroboscopic(("x",), 5, 1.0, 7.0)}}, "phase = 7 must be from 0 to 2π"),
    ({"maps": {"s": Stroboscopic(("x",), 5, 1.0), "t": Stroboscopic(("x",), 5, 2.0)}},
     "maps s and t have other times"),
    ({"maps": {"s": Stroboscopic(("x",), 5, 1.0), "t": Samples(("x",), 5)}}, "have other times"),
    ({"maps": {"e": Final(("x",))}}, "duration is missing"),
    ({"maps": {"e": Final(("x",))}, "duration": 5.0, "skip": 5.0}, "must be less than duration"),
    ({"maps": {"e": Final(("x",))}, "duration": 5.0, "skip": -1.0}, "skip = -1 must not be"),
])  # fmt: skip
def test_an_invalid_period_or_transient_is_refused(changes: dict[str, Any], words: str) -> None:
    valid = {"axes": Grid({"Omega": [1.0]}), "maps": {"s": Stroboscopic(("x",), 5, PERIOD)}}
    with pytest.raises(ValueError, match=words):
        Sweep(duffing, values={"x": 1.0}, **(valid | changes))


def test_formulas_are_values_of_names_and_nothing_is_executed() -> None:
    names = {"a": 2.0, "b": np.array([1.0, 4.0])}
    assert formula("2*a + b**0.5 - (-1)", names).tolist() == [6.0, 7.0]
    for text in ("__import__('os')", "a.real", "c", "a if b else a", "(" * 90, "9" * 200):
        with pytest.raises(QuantityError):
            formula(text, names)


def test_a_period_is_the_one_product_of_powers_that_is_a_time() -> None:
    """Against exponents: kg^i m^j (m/s^2)^k is s for i = 0, j = 1/2 and k = -1/2 alone."""

    def is_time(i: int, j: int, k: int) -> bool:
        sampling = Sampling(f"m1**{i}*l1**{j / 2}*g**{k / 2}", 1)
        try:
            sampling.check(dp)
        except ValueError:
            return False
        return True

    powers = product(range(-2, 3), range(-5, 6), range(-2, 3))
    assert [one for one in powers if is_time(*one)] == [(0, 1, -1)]


def test_a_system_without_parameters_has_one_period() -> None:
    assert Sampling(2.5, 3).periods(hh, ()).tolist() == [2.5]
    assert Sampling(2.5, 3).periods(sp, [*np.ones((3, 2))]).tolist() == [2.5, 2.5]
