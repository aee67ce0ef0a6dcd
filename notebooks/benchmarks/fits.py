"""Fits by several programs, from the same guesses to the same minimum.

One is of a double pendulum, the other of a robot's arm with measured torques. Other programs use
single shooting with `scipy.optimize.least_squares`: SciPy with finite differences, by its own
integration and by our compiled loop, and diffrax with derivatives by JAX. The motions are such that
single shooting converges.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import least_squares

from benchmarks.median_times import median_times
from solvers.equations.module import GeneratedModule, with_functions
from solvers.integration.integrate import integrate
from solvers.integration.problem.inputs import Held
from solvers.io.terminal import text_table
from solvers.scenes.fitting.fitted_model import fitted
from solvers.scenes.fitting.measurement import Measurement, Outputs

Array = NDArray[np.float64]
#: Residuals of the unknowns, and their Jacobian or the name of a difference formula.
Residuals = tuple[Callable[[Array], Array], Any]

#: Duration in s, samples per second, noise in rad and start of the measured motion.
END, RATE, NOISE, START = 10.0, 100, 0.01, (1.0, -0.5, 0.0, 0.0)
UNKNOWN = ("m2", "l1", "l2")
TRUTH, GUESS = {"m2": 0.7, "l1": 1.3, "l2": 0.9}, {"m2": 0.72, "l1": 1.32, "l2": 0.92}
#: Tolerance of all integrations: with it minima agree to a hundredth of the standard errors.
TOLERANCE = 1e-8
#: Samples of the arm's run over the same duration, noise in rad, and its parameters.
SAMPLES, ARM_NOISE, ARM_START = 5000, 0.002, (-1.5, 0.1, 0.0, 0.0)
ARM = {"m1": 2.2, "m2": 1.2, "I1": 0.05, "I2": 0.02, "b1": 0.35, "b2": 0.08}
ARM_GUESS = {name: 1.03 * value for name, value in ARM.items()}


def figures(module: GeneratedModule, peer: Callable[[str], Any]) -> dict[str, Any]:
    """Seconds of each program, and the largest difference from our values in standard errors."""
    t, data = measurement(module)
    outputs = Outputs(module.COORDINATES, ("rad", "rad"), module)
    run, params = Measurement(t, data), dict(zip(module.PARAMETERS, module.DEFAULTS, strict=True))
    ours = partial(fitted, outputs, [run], UNKNOWN, params | GUESS, np.array(START), {})
    measured = np.array([*data.values()])
    peers: dict[str, Residuals] = {
        "SciPy": (partial(_scipy, module, t, measured), "2-point"),
        "SciPy, compiled loop": (partial(_compiled, module, t, measured), "2-point"),
        "diffrax": _diffrax(module, t, measured, peer("diffrax"), peer("jax")),
    }
    first = np.array([*GUESS.values(), *START])
    programs: dict[str, Callable[[], Any]] = {"holonomic": ours}
    programs |= {name: partial(_fit, *parts, first) for name, parts in peers.items()}
    result = ours()
    best = [result.params[name] for name in UNKNOWN]
    differences = {"holonomic": 0.0}
    for name in peers:
        values = programs[name]().x[: len(UNKNOWN)]
        differences[name] = float(np.max(np.abs(values - best) / result.errors))
    return {
        "values": run.count,
        "unknown": len(UNKNOWN),
        "differences": differences,
        "seconds": median_times(programs, 20.0),
    }


def measurement(module: GeneratedModule) -> tuple[Array, dict[str, Array]]:
    """Times, and angles with noise."""
    t = np.arange(0, END, 1 / RATE)
    params = dict(zip(module.PARAMETERS, module.DEFAULTS, strict=True)) | TRUTH
    motion = integrate(module, (0, END), START, params, t_eval=t, rtol=1e-11, atol=1e-11)
    noise = NOISE * np.random.default_rng(0).normal(size=(2, len(t)))
    return t, dict(zip(module.COORDINATES, motion.y[:2] + noise, strict=True))


def arm_with_friction() -> GeneratedModule:
    """The two-link arm with viscous friction in its joints."""
    from sympy import symbols

    from derive import Parameter, load, velocity
    from solvers.app.modules import build

    system, joints = load("two_link_arm"), symbols("b1 b2", positive=True)
    friction = [Parameter(b, "N m s", 0.1, "friction of a joint") for b in joints]
    terms = [b * velocity(q) ** 2 / 2 for b, q in zip(joints, system.q, strict=True)]
    parameters = [*system.parameters, *friction]
    changes = {"parameters": parameters, "dissipation": terms[0] + terms[1]}
    return build(replace(system, name="arm_with_friction", **changes))


def run_with_torques(module: GeneratedModule) -> Measurement:
    """Angles and torques of a run of the arm, whose motors swing it about its lowest position."""

    def torques(t: float, y: Array) -> tuple[float, float]:
        first = -np.pi / 2 + 0.8 * np.sin(1.3 * t) + 0.3 * np.sin(3.1 * t)
        second = 0.9 * np.sin(1.7 * t) - 0.4 * np.sin(2.3 * t)
        return 60 * (first - y[0]) - 6 * y[2], 15 * (second - y[1]) - 1.5 * y[3]

    t = np.linspace(0, END, SAMPLES)
    held = Held(END / (SAMPLES - 1), torques)
    motion = integrate(module, (0, END), ARM_START, ARM, inputs=held, t_eval=t, rtol=1e-11)
    noise = ARM_NOISE * np.random.default_rng(0).normal(size=(2, SAMPLES))
    values = dict(zip(module.COORDINATES, motion.y[:2] + noise, strict=True))
    table = np.asarray(motion.inputs)
    return Measurement(t, values, inputs=dict(zip(module.INPUTS, table, strict=True)))


def torque_figures(module: GeneratedModule) -> dict[str, Any]:
    """The same of the arm, beside SciPy over our compiled loop."""
    run = run_with_torques(module)
    outputs = Outputs(module.COORDINATES, ("rad", "rad"), module)
    params = dict(zip(module.PARAMETERS, module.DEFAULTS, strict=True)) | ARM_GUESS
    ours = partial(fitted, outputs, [run], tuple(ARM), params, np.array(ARM_START), {})
    held = Held(run.t, np.array([*run.inputs.values()]))
    measured = np.array([*run.values.values()])

    def residuals(unknown: Array) -> Array:
        values = dict(zip(ARM, unknown.tolist(), strict=False))
        start = unknown[len(ARM) :].tolist()
        tol = TOLERANCE
        motion = integrate(
            module, (0, END), start, values, inputs=held, t_eval=run.t, rtol=tol, atol=tol
        )
        return np.asarray((motion.y[:2] - measured).ravel() / ARM_NOISE)

    first, result = np.array([*ARM_GUESS.values(), *ARM_START]), ours()
    scipy = partial(_fit, residuals, "2-point", first)
    best = np.array([result.params[name] for name in ARM])
    difference = float(np.max(np.abs(scipy().x[: len(ARM)] - best) / result.errors))
    return {
        "values": run.count,
        "unknown": len(ARM),
        "differences": {"holonomic": 0.0, "SciPy, compiled loop": difference},
        "seconds": median_times({"holonomic": ours, "SciPy, compiled loop": scipy}, 20.0),
    }


def _fit(residuals: Callable[[Array], Array], jacobian: Any, first: Array) -> Any:
    return least_squares(residuals, first, jac=jacobian, x_scale="jac", method="lm", xtol=1e-8)


def _params(module: GeneratedModule, unknown: Iterable[Any]) -> tuple[Any, ...]:
    values = dict(zip(UNKNOWN, unknown, strict=False))
    pairs = zip(module.PARAMETERS, module.DEFAULTS, strict=True)
    return tuple(values.get(name, default) for name, default in pairs)


def _scipy(module: GeneratedModule, t: Array, data: Array, unknown: Array) -> Array:
    count, tolerances = len(UNKNOWN), {"rtol": TOLERANCE, "atol": TOLERANCE}
    params, span = _params(module, unknown), (0, t[-1])
    rhs = partial(_rhs, module, params)
    motion = solve_ivp(rhs, span, unknown[count:], "DOP853", t, **tolerances)
    return np.asarray((motion.y[:2] - data).ravel() / NOISE)


def _rhs(module: GeneratedModule, params: Sequence[float], t: float, y: Array) -> Any:
    return module.rhs(t, y, params)


def _compiled(module: GeneratedModule, t: Array, data: Array, unknown: Array) -> Array:
    params, start = _params(module, unknown.tolist()), unknown[len(UNKNOWN) :].tolist()
    span, tol = (0, END), TOLERANCE
    motion = integrate(module, span, start, params, t_eval=t, rtol=tol, atol=tol)
    return np.asarray((motion.y[:2] - data).ravel() / NOISE)


def _diffrax(module: GeneratedModule, t: Array, data: Array, diffrax: Any, jax: Any) -> Residuals:
    jax.config.update("jax_enable_x64", True)
    numpy = jax.numpy
    rhs = with_functions(module.rhs, {"sin": numpy.sin, "cos": numpy.cos})
    count = len(UNKNOWN)

    def residuals(unknown: Any) -> Any:
        params = [unknown[k] for k in range(count)]
        values = _params(module, params)
        term = diffrax.ODETerm(
            lambda time, y, _: numpy.stack(rhs(time, [y[k] for k in range(4)], values))
        )
        controller = diffrax.PIDController(rtol=TOLERANCE, atol=TOLERANCE)
        motion = diffrax.diffeqsolve(
            term,
            diffrax.Dopri8(),
            0.0,
            float(t[-1]),
            None,
            unknown[count:],
            saveat=diffrax.SaveAt(ts=numpy.asarray(t)),
            stepsize_controller=controller,
            adjoint=diffrax.ForwardMode(),
            max_steps=100_000,
        )
        return ((motion.ys[:, :2].T - data) / NOISE).ravel()

    values, jacobian = jax.jit(residuals), jax.jit(jax.jacfwd(residuals))
    return lambda unknown: np.array(values(unknown)), lambda unknown: np.array(jacobian(unknown))


def summary(results: Mapping[str, Any]) -> Iterator[str]:
    """Lines of the times, and how much longer other programs take."""
    seconds = results["seconds"]
    yield f"fit of {results['unknown']} parameters and a start to {results['values']} values"
    rows = [
        (name, time * 1e3, time / seconds["holonomic"], results["differences"][name])
        for name, time in seconds.items()
    ]
    heads = {"program": "", "ms": ".1f", "ratio": ".1f", "difference / error": ".1e"}
    yield from text_table(heads, rows)
