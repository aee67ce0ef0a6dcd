"""Invalid integrations are refused; failing ones end with a status."""

from math import pi, sqrt
from types import SimpleNamespace

import numpy as np
import pytest
from handwritten import handwritten
from scipy.integrate import solve_ivp

import generated.double_pendulum as dp
import generated.single_pendulum as sp
from solvers.integration.checks.predictability import UnfinishedWarning
from solvers.integration.ensemble import ensemble
from solvers.integration.integrate import integrate
from solvers.integration.ode_solver import ode_solver
from solvers.integration.problem.status import Status
from solvers.runge_kutta.method_catalogue import UnknownMethodError

REPORT = (pi / 2, pi, 0.0, 0.0)
#: The report's scene at 5 s, from an 80-bit Taylor series.
END = (2.2280642400930692, -0.2670447339117043, -1.9694093323354762, -2.9859792219408772)


@pytest.mark.filterwarnings("ignore::solvers.integration.checks.predictability.UnfinishedWarning")
def test_a_step_that_always_fails_ends_with_a_status() -> None:
    hole = handwritten(
        "hand",
        ("x", "x_dot"),
        COORDINATES=("x",),
        rhs=lambda t, y, params: (1.0, np.nan if 0.501 < t < 0.502 else 0.0),
    )
    solution = integrate(hole, (0, 1), (0.0, 0.0), (1.0,), method="rk4", h=1.0, t_eval=[0.5015])
    assert solution.status is Status.NOT_FINITE
    singular = integrate(sp, (0, 4), (pi, 0), (1, 1, 1), method="gauss1", h=2.0)
    assert singular.status in (Status.NO_CONVERGENCE, Status.FINISHED)
    dividing = integrate(sp, (0, 1), (1, 0), (1, 0, 9.81), method="rk4", h=0.1)
    assert dividing.status is Status.NOT_FINITE


def test_no_evaluation_exceeds_those_of_the_last_step() -> None:
    edge = handwritten(
        "hand",
        ("x", "x_dot"),
        COORDINATES=("x",),
        rhs=lambda t, y, params: (sqrt(1 - t) if t < 1 else np.nan, 0.0),
    )
    solution = integrate(edge, (0, 1), (0.0, 0.0), (1.0,), method="midpoint", h=0.1)
    assert solution.status is Status.FINISHED


@pytest.mark.parametrize(
    "options", [{"first_step": np.nan}, {"first_step": -0.1}, {"max_step": -1}, {"rtol": -1}]
)
def test_invalid_options_of_solve_ivp_are_refused(options: dict[str, float]) -> None:
    with pytest.raises(ValueError, match="must"):
        solve_ivp(
            sp.rhs, (0, 1), (1, 0), method=ode_solver("verner853"), args=(sp.DEFAULTS,), **options
        )


def test_arguments_are_not_modified() -> None:
    y0, params, times = np.array(REPORT), np.array(dp.DEFAULTS), np.array([0.0, 1.0])
    solution = integrate(dp, (0, 1), y0, params, t_eval=times)
    solution.y[:] = 0
    assert y0.tolist() == list(REPORT)
    assert params.tolist() == list(dp.DEFAULTS)
    assert times.tolist() == [0.0, 1.0]


def scene(**changes: object) -> dict[str, object]:
    return {"module": dp, "t_span": (0, 1), "y0": REPORT, "params": dp.DEFAULTS} | changes


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"y0": (1, 2, 3)}, r"y0 has shape \(3,\): give 4 numbers, theta1, theta2, theta1_dot"),
        ({"y0": (1, 2, 3, np.nan)}, "theta2_dot = nan must be a finite real number in rad/s"),
        ({"y0": "abcd"}, "y0 = 'abcd' must be a finite real number"),
        ({"y0": (1j, 0, 0, 0)}, "theta1 = 1j must be a finite real number"),
        ({"y0": (1, False, 1, 1)}, "theta2 = False must be a finite real number"),
        ({"params": (1, 1, 2, 2)}, "params has shape .* m1, m2, l1, l2, g"),
        ({"params": (1, 1, 2, 2, np.inf)}, "g = inf must be a finite real number in m/s"),
        ({"t_span": (0, np.inf)}, "t_span"),
        ({"t_span": 1}, "t_span has shape"),
        ({"t_eval": [0.5, 0.2]}, "must be ordered from the start of t_span to its end"),
        ({"t_eval": [0.2, 0.2]}, "must be ordered"),
        ({"t_eval": [0.2, 2.0]}, r"t_eval has 2.0, outside of t_span = \(0.0, 1.0\)"),
        ({"t_eval": [0.2, np.nan]}, r"t_eval\[1\] = nan must be a finite real number in s"),
        ({"rtol": 0, "atol": 0}, "both 0"),
        ({"rtol": -1e-6}, "rtol = -1e-06 must not be negative"),
        ({"rtol": np.nan}, "rtol = nan must be a finite real number"),
        ({"atol": [1e-6, 1e-6]}, "atol must be a number or 4 of them"),
        ({"rtol": 1e-17}, "below the resolution of numbers"),
        ({"h": 0}, "h = 0 must be a positive number"),
        ({"h": -0.1}, "h = -0.1 must be a positive number"),
        ({"h": np.nan}, "h = nan"),
        ({"h": 1e-18}, "below the resolution"),
        ({"h": 1e-15}, "below the resolution"),
        ({"max_steps": -1}, "max_steps = -1 must be from 0"),
        ({"max_steps": 1.5}, "max_steps = 1.5"),
        ({"events": None}, "events = None must be functions"),
        ({"events": [3]}, r"events = \[3\] must be functions"),
        ({"method": "rk4"}, "does not estimate its error: give a fixed step h"),
        ({"method": "gauss2", "form": "rational", "h": 0.1}, "needs a Jacobian"),
        ({"form": "linear"}, "form 'linear': .* has lagrangian, hamiltonian, rational"),
    ],
)
def test_invalid_arguments_are_refused_before_anything_runs(
    changes: dict[str, object], message: str
) -> None:
    calls = []
    watched = SimpleNamespace(**{name: getattr(dp, name) for name in dir(dp)})
    watched.__name__ = "generated.double_pendulum"
    watched.rhs = lambda *arguments: calls.append(arguments) or dp.rhs(*arguments)
    with pytest.raises(ValueError, match=message):
        integrate(**(scene(module=watched) | changes))  # type: ignore[arg-type]
    assert not calls


def test_an_unknown_method_is_refused() -> None:
    with pytest.raises(UnknownMethodError, match="did you mean 'verner"):
        integrate(**scene(method="verner78"))  # type: ignore[arg-type]


@pytest.mark.filterwarnings("ignore::solvers.integration.checks.predictability.UnfinishedWarning")
def test_a_blow_up_ends_with_a_status_and_the_results_so_far() -> None:
    # x' = x² from 1 has x = 1/(1 - t)
    module = handwritten(
        "hand", ("x", "x_dot"), COORDINATES=("x",), rhs=lambda t, y, params: (y[0] ** 2, 0.0)
    )
    solution = integrate(module, (0, 2), (1.0, 0.0), (1.0,), rtol=1e-8)
    assert solution.status in (Status.STEP_TOO_SMALL, Status.NOT_FINITE)
    assert not solution.success
    assert solution.t[-1] == pytest.approx(1.0, abs=1e-6)
    assert np.isfinite(solution.y).all()
    assert "t = " in solution.message


@pytest.mark.parametrize("h", [None, 0.1])
@pytest.mark.filterwarnings("ignore::solvers.integration.checks.predictability.UnfinishedWarning")
def test_a_right_hand_side_that_is_not_finite_ends_the_run(h: float | None) -> None:
    module = handwritten(
        "hand",
        ("x", "x_dot"),
        COORDINATES=("x",),
        rhs=lambda t, y, params: (1.0, np.nan if y[0] > 0.55 else 0.0),
    )
    solution = integrate(module, (0, 1), (0.0, 0.0), (1.0,), h=h)
    assert solution.status in (Status.NOT_FINITE, Status.STEP_TOO_SMALL)
    assert np.isfinite(solution.y).all()
    assert 0.4 < solution.t[-1] < 0.56


def test_exceptions_of_the_right_hand_side_propagate() -> None:
    def failing(t: float, y: object, params: object) -> tuple[float, float]:
        raise RuntimeError("broken model")

    with pytest.raises(RuntimeError, match="broken model"):
        integrate(
            handwritten("hand", ("x", "x_dot"), COORDINATES=("x",), rhs=failing),
            (0, 1),
            (0.0, 0.0),
            (1.0,),
        )


@pytest.mark.filterwarnings("ignore::solvers.integration.checks.predictability.UnfinishedWarning")
def test_the_step_limit_leaves_a_state_to_resume_from() -> None:
    short = integrate(dp, (0, 5), REPORT, dp.DEFAULTS, rtol=1e-11, max_steps=50, t_eval=[5.0])
    assert short.status is Status.STEP_LIMIT
    assert short.steps == 50
    assert short.y.shape == (4, 0)
    t, y = short.end
    rest = integrate(dp, (t, 5), y, dp.DEFAULTS, rtol=1e-11)
    assert np.abs(rest.y[:, -1] - END).max() < 1e-8


@pytest.mark.parametrize("backend", ["compiled", "python"])
def test_motions_that_do_not_reach_their_end_warn_once_with_a_way_out(backend: str) -> None:
    start, options = (1.0, 0.0, 0.0, 0.0), {"max_steps": 3, "backend": backend}
    with pytest.warns(UserWarning, match=r"steps was reached; raise max_steps.*t = ") as caught:
        integrate(dp, (0, 10), start, dp.DEFAULTS, **options)  # type: ignore[arg-type]
    assert [one.category for one in caught] == [UnfinishedWarning]
    assert caught[0].filename == __file__
    many = np.outer(start, [1, 2])
    with pytest.warns(UserWarning, match=r"^2 of 2 motions .* 2: .*raise max_steps") as caught:
        ensemble(dp, (0, 10), many, dp.DEFAULTS, h=0.01, method="rk4", max_steps=3)
    assert [one.category for one in caught] == [UnfinishedWarning]
    assert caught[0].filename == __file__
