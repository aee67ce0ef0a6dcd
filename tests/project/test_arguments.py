"""Arguments that are not real numbers are refused by name, in every function that takes numbers."""

from collections.abc import Callable
from decimal import Decimal
from fractions import Fraction
from math import inf, nan
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from handwritten import handwritten
from scipy.integrate import solve_ivp

import generated.double_pendulum as dp
from solvers.integration.ensemble import ensemble
from solvers.integration.integrate import integrate
from solvers.integration.ode_solver import ode_solver
from solvers.integration.prepare import prepare
from solvers.integration.problem.events import Event
from solvers.scenes.scene import Scene
from solvers.sweeps.definition.axes import Grid, Random
from solvers.sweeps.definition.sweep import Sweep
from solvers.sweeps.maps.final import Final

START, PARAMS = (0.1, 0.2, 0.0, 0.0), dp.DEFAULTS
BY_NAME = {"theta1": [0.1, 0.2], "theta2": 0.1}
MAPS = {"end": Final(("theta1",))}
INVALID = [True, np.True_, "20", b"2", 1j, np.complex128(2), {}, object()]
INVALID += [nan, Decimal("1.5"), Fraction(1, 2), 10**400, np.datetime64(3, "s"), np.ma.masked]


def fed(values: tuple[float, ...], value: object) -> tuple[Any, ...]:
    """The values, of which the second is another."""
    return (values[0], value, *values[2:])


def method(**options: Any) -> None:
    solve_ivp(lambda t, y: -y, (0, 1), [1.0], method=ode_solver("verner853"), **options)


def swept(**options: Any) -> Sweep:
    axes = Grid({"theta1": [0.1], "theta2": [0.1]} | options.pop("axes", {}))
    return Sweep(dp, axes, MAPS, **({"duration": 1.0} | options))


RUN = prepare(dp, PARAMS)
CALLS: dict[str, tuple[str, Callable[[Any], object]]] = {
    "y0": ("theta2", lambda v: integrate(dp, (0, 1), fed(START, v), PARAMS)),
    "y0, by name": ("theta1", lambda v: integrate(dp, (0, 1), {"theta1": v, "theta2": 1}, PARAMS)),
    "params": ("m2", lambda v: integrate(dp, (0, 1), START, fed(PARAMS, v))),
    "params, by name": ("m2", lambda v: integrate(dp, (0, 1), START, {"m2": v})),
    "t_span": ("t_span", lambda v: integrate(dp, (0, v), START, PARAMS)),
    "h": ("h", lambda v: integrate(dp, (0, 1), START, PARAMS, method="rk4", h=v)),
    "rtol": ("rtol", lambda v: integrate(dp, (0, 1), START, PARAMS, rtol=v)),
    "atol": ("atol", lambda v: integrate(dp, (0, 1), START, PARAMS, atol=v)),
    "atol, list": ("atol", lambda v: integrate(dp, (0, 1), START, PARAMS, atol=fed((1,) * 4, v))),
    "t_eval": ("t_eval", lambda v: integrate(dp, (0, 1), START, PARAMS, t_eval=[0.1, v, 0.5])),
    "max_steps": ("max_steps", lambda v: integrate(dp, (0, 1), START, PARAMS, max_steps=v)),
    "ensemble": ("theta1", lambda v: ensemble(dp, (0, 1), BY_NAME | {"theta1": [0.1, v]}, PARAMS)),
    "ensemble, y0": ("theta2", lambda v: ensemble(dp, (0, 1), fed(([1.0],) * 4, [v]), PARAMS)),
    "ensemble, params": ("m2", lambda v: ensemble(dp, (0, 1), BY_NAME, {"m2": [1.0, v]})),
    "occurrences": ("occurrences", lambda v: ensemble(dp, (0, 1), BY_NAME, {}, occurrences=v)),
    "prepare": ("m2", lambda v: prepare(dp, fed(PARAMS, v))),
    "prepare, h": ("h", lambda v: prepare(dp, PARAMS, method="rk4", h=v)),
    "prepared": ("theta2", lambda v: RUN((0, 1), fed(START, v))),
    "prepared, end": ("t_span", lambda v: RUN((0, v), START)),
    "prepared, params": ("m2", lambda v: RUN((0, 1), START, fed(PARAMS, v))),
    "prepared, by name": ("m2", lambda v: RUN((0, 1), START, {"m2": v})),
    "solve_ivp, rtol": ("rtol", lambda v: method(rtol=v)),
    "solve_ivp, max_step": ("max_step", lambda v: method(max_step=v)),
    "ode_solver, end": ("t_span", lambda v: ode_solver("dp54")(lambda t, y: y, 0, [1.0], v)),
    "ode_solver, y0": ("y0", lambda v: ode_solver("dp54")(lambda t, y: y, 0, [v], 1.0)),
    "Scene": ("m2", lambda v: Scene(dp, fed(PARAMS, v), START, 1.0)),
    "Scene, y0": ("theta1", lambda v: Scene(dp, PARAMS, {"theta1": v, "theta2": 0.0}, 1.0)),
    "duration": ("duration", lambda v: Scene(dp, PARAMS, START, v)),
    "accuracy": ("accuracy", lambda v: Scene(dp, PARAMS, START, 1.0, accuracy=v)),
    "Sweep": ("m2", lambda v: swept(values={"m2": v})),
    "Sweep, duration": ("duration", lambda v: swept(duration=v)),
    "Sweep, axis": ("m2", lambda v: swept(axes={"m2": [1.0, v]})),
    "Random": ("theta1", lambda v: Random({"theta1": (0.1, v)}, 3, 1)),
    "Event": ("value of theta1", lambda v: Event(dp, "theta1", v)),
}


@pytest.mark.parametrize("call", CALLS)
def test_what_is_no_real_number_is_refused_by_name_and_value(call: str) -> None:
    name, function = CALLS[call]
    for value in INVALID:
        with pytest.raises(ValueError, match=rf"^{name}(\[[01]\])* = .* must be ") as refused:
            function(value)
        assert repr(value)[:20] in str(refused.value)


@pytest.mark.parametrize("value", [1.5, np.float64(1.5), np.float32(1.5), np.array(1.5)])
def test_every_real_number_is_accepted(value: Any) -> None:
    for empty in (None, [], [[]]):
        for name in ("y0", "params", "prepared", "ensemble, params", "t_span", "atol, list"):
            with pytest.raises(ValueError, match=r"must be|lengths|shape"):
                CALLS[name][1](empty)
    for name in ("y0", "y0, by name", "params", "params, by name", "prepared", "Scene", "Event"):
        CALLS[name][1](value)
    whole = [CALLS[name][1](one) for name in ("prepared", "prepared, params") for one in (2, 2.0)]
    assert whole[0] == whole[1] == CALLS["prepared"][1](np.int64(2))
    assert whole[2] == whole[3] == CALLS["prepared, params"][1](np.array(2))


def test_infinity_is_refused_before_the_right_hand_side_is_evaluated() -> None:
    calls = []
    watched = SimpleNamespace(**{name: getattr(dp, name) for name in dir(dp)})
    watched.rhs = lambda *arguments: calls.append(arguments)
    for start, params in ((fed(START, inf), PARAMS), (START, fed(PARAMS, -inf))):
        with pytest.raises(ValueError, match=r"inf must be a finite real number in (rad|kg), such"):
            integrate(watched, (0, 1), start, params, backend="python")
    assert not calls


def test_starts_of_different_lengths_are_refused() -> None:
    ragged = r"the values of y0 differ in shape: theta1: \(2,\), theta2: \(1,\)"
    with pytest.raises(ValueError, match=ragged):
        ensemble(dp, (0, 1), [[0.1, 0.2], [0.3], [0, 0], [0, 0]], PARAMS)
    with pytest.raises(ValueError, match="differ in shape"):
        ensemble(dp, (0, 1), {"theta1": [0.1, 0.2], "theta2": [0.1, 0.2, 0.3]}, PARAMS)
    with pytest.raises(
        ValueError, match=r"m2 = .* has parts of different lengths: make them equal"
    ):
        ensemble(dp, (0, 1), BY_NAME, {"m2": [1.0, [1.0, 2.0]]})


def test_events_that_are_no_functions_are_refused_with_the_remedy() -> None:
    for function in (integrate, ensemble):
        start: Any = START if function is integrate else BY_NAME
        for events in (None, 3, "theta1", [None]):
            with pytest.raises(ValueError, match=r"events = .* must be .*: leave it out for none"):
                function(dp, (0, 1), start, PARAMS, events=events)
    with pytest.raises(ValueError, match=r"compensated = 1\.5 must be True or False"):
        integrate(dp, (0, 1), START, PARAMS, compensated=1.5)  # type: ignore[arg-type]
    for module in (None, 3.0, dp.rhs):
        with pytest.raises(ValueError, match=r"module = .* must be a generated module, such as"):
            integrate(module, (0, 1), START, PARAMS)  # type: ignore[arg-type]


WRONG = [(0.5,), (0.5, 0.5, 0.5), (1j, 0.0), np.array([1j, 0]), ("1", "2"), (None, 0.0), 0.5, None]


@pytest.mark.parametrize("value", WRONG)
def test_a_right_hand_side_without_real_numbers_for_the_state_is_refused(value: object) -> None:
    edited = handwritten("hand", ("x", "v"), COORDINATES=("x",), rhs=lambda t, y, params: value)
    message = r"the right-hand side at t = 0\.0, y = \[1\. 2\.\] is .*: it must return real numbers"
    for options in ({}, {"method": "RK45"}, {"method": "rk4", "h": 0.1}):
        with pytest.raises(ValueError, match=message):
            integrate(edited, (0, 1), (1.0, 2.0), (1.0,), **options)  # type: ignore[arg-type]
    for vectorized in (False, True):
        with pytest.raises(
            ValueError, match=r"(?s)the right-hand side at t = 0\.0, y = .* must return"
        ):
            solve_ivp(
                lambda t, y: value,
                (0, 1),
                [1.0, 2.0],
                method=ode_solver("verner853"),
                vectorized=vectorized,
            )


def test_a_jacobian_of_another_shape_is_refused() -> None:
    edited = handwritten(
        "hand",
        ("x", "v"),
        COORDINATES=("x",),
        OPERATIONS={"rhs": (0, 0), "jacobian": (0, 0)},
        rhs=lambda t, y, params: (0.0, 0.0),
        jacobian=lambda t, y, params: (0.0,),
    )
    for options in ({"method": "gauss2", "h": 0.1}, {"method": "Radau"}):
        with pytest.raises(ValueError, match=r"the Jacobian at t = 0\.0, y = .* of shape \(2, 2\)"):
            integrate(edited, (0, 1), (1.0, 2.0), (1.0,), **options)  # type: ignore[arg-type]


def test_an_ensemble_warns_where_an_event_keeps_it_from_being_compiled() -> None:
    with pytest.warns(UserWarning, match=r"one motion after another in Python: an event is .* use"):
        motions = ensemble(dp, (0, 1), BY_NAME, PARAMS, events=lambda t, y: y[0])
    quiet = ensemble(dp, (0, 1), BY_NAME, PARAMS, events=lambda t, y: y[0], backend="python")
    compiled = ensemble(dp, (0, 1), BY_NAME, PARAMS, events=Event(dp, "theta1", 0.0))
    assert ensemble(dp, (0, 1), BY_NAME, PARAMS, method="RK45").success.all()  # as requested
    assert np.array_equal(motions.t_events, quiet.t_events)
    assert motions.t_events == pytest.approx(compiled.t_events, abs=1e-8)
