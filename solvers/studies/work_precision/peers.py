"""Other programs on the same scenes, with the equations that holonomic generates for them.

All get the fastest form, and are compiled before they are timed. heyoka's Taylor series and
diffrax's methods take the right-hand side called with their own numbers; numba compiles it, as
Python, into a loop of RK4 steps; numbalsoda's LSODA and DOP853 take its machine code.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from importlib import import_module
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solvers.equations.forms import Form, fastest_form
from solvers.equations.module import GeneratedModule
from solvers.integration.compiled.compiler import NoCompilerError
from solvers.integration.compiled.native import native_rhs
from solvers.integration.timing import median_seconds
from solvers.scenes.scene import Scene
from solvers.studies.benchmarks.peers import generated, single
from solvers.studies.work_precision.curve import Curve, Point
from solvers.studies.work_precision.measurement import LONGEST, STEPS, TOLERANCES, judged
from solvers.studies.work_precision.reference import Reference

Array = NDArray[np.float64]
#: A run with a tolerance or step: a function that returns the state, and right-hand sides if known.
Run = Callable[[], tuple[Array, int | None]]
Peer = Callable[[Any, Scene], Iterator[tuple[str, str, Callable[[float], Run]]]]

#: Most steps that diffrax may take.
MOST_STEPS = 2**16
#: Below this tolerance LSODA complains on the terminal.
FINEST = 5e-13


def curves(
    scene: Scene, truth: Reference, package: Callable[[str], ModuleType | None]
) -> list[Curve]:  # fmt: skip
    """A curve for each method of the packages that are installed."""
    found = []
    for name, peer in PEERS.items():
        installed = package(name)
        if installed is None:
            continue
        try:
            for method, form, run in peer(installed, scene):
                points = list(_points(scene, truth, form, method, run))
                found.append(Curve(scene.name, method, form, name, points))
        except NoCompilerError:
            continue
    return found


def _points(
    scene: Scene, truth: Reference, form: str, method: str,
    run: Callable[[float], Run],
) -> Iterator[Point]:  # fmt: skip
    judge = judged(scene, truth)
    fixed = method == "rk4"
    tolerances = TOLERANCES[TOLERANCES > FINEST] if method == "lsoda" else TOLERANCES
    for setting in scene.duration / STEPS if fixed else tolerances:
        ready = run(float(setting))
        state, work = ready()
        if not np.isfinite(state).all():
            continue
        seconds = median_seconds(ready)
        end = _ordinary(scene.module, form, state, truth)
        point = judge({"h" if fixed else "rtol": float(setting)}, seconds, work, end)
        if point:
            yield point
        if seconds > LONGEST["compiled"] / 2:
            return


def _ordinary(module: GeneratedModule, form: str, state: Array, truth: Reference) -> Array:
    """Coordinates and velocities; angles that are known up to whole turns are next to the truth."""
    return Form(module, form, module.DEFAULTS).to_ordinary(0.0, state, truth.end, 0.0)


def _heyoka(hy: Any, scene: Scene) -> Iterator[tuple[str, str, Any]]:
    form, start = _fastest(scene)
    equations = generated(hy, scene.module)

    def run(tolerance: float) -> Run:
        motion = single(hy, equations, start.tolist(), scene.params, scene.duration, tolerance)
        return lambda: (np.array(motion()), None)

    yield "taylor", form.name, run


def _diffrax(diffrax: Any, scene: Scene) -> Iterator[tuple[str, str, Any]]:
    jax: Any = import_module("jax")
    jax.config.update("jax_enable_x64", True)
    form, start = _fastest(scene)

    def field(t: Any, y: Any, args: Any) -> Any:
        rates = form.function(t, tuple(y), form.params)
        return jax.numpy.stack([jax.numpy.asarray(rate) for rate in rates])

    for method in ("Tsit5", "Dopri8"):
        solver = getattr(diffrax, method)()

        @jax.jit  # type: ignore[untyped-decorator]
        def solve(y0: Any, tolerance: Any, solver: Any = solver) -> Any:
            return diffrax.diffeqsolve(
                diffrax.ODETerm(field), solver, 0.0, scene.duration, None, y0,
                stepsize_controller=diffrax.PIDController(rtol=tolerance, atol=tolerance),
                max_steps=MOST_STEPS, throw=False,
            ).ys[-1]  # fmt: skip

        def run(tolerance: float, solve: Any = solve) -> Run:
            return lambda: (np.asarray(solve(start, tolerance).block_until_ready()), None)

        yield method, form.name, run


def _numba(numba: Any, scene: Scene) -> Iterator[tuple[str, str, Any]]:
    to_fixed_tuple: Any = import_module("numba.np.unsafe.ndarray").to_fixed_tuple
    form, start = _fastest(scene)
    rhs, size, params = numba.njit(form.function), len(start), form.params

    @numba.njit  # type: ignore[untyped-decorator]
    def steps(y0: Any, h: float, count: int) -> Any:
        y, place, k = y0.copy(), np.empty(size), np.empty((4, size))
        for _ in range(count):
            for i, part in enumerate((0.0, 0.5, 0.5, 1.0)):
                for n in range(size):
                    place[n] = y[n] + part * h * k[i - 1, n] if i else y[n]
                rates = rhs(0.0, to_fixed_tuple(place, size), params)
                for n in range(size):
                    k[i, n] = rates[n]
            for n in range(size):
                y[n] += h / 6 * (k[0, n] + 2 * k[1, n] + 2 * k[2, n] + k[3, n])
        return y

    def run(h: float) -> Run:
        count = round(scene.duration / h)
        return lambda: (steps(start, h, count), 4 * count)

    yield "rk4", form.name, run


def _numbalsoda(package: Any, scene: Scene) -> Iterator[tuple[str, str, Any]]:
    form, start = _fastest(scene)
    rhs, params = native_rhs(scene.module, form.name), np.array(form.params)
    times = np.array([0.0, scene.duration])
    for method in ("lsoda", "dop853"):
        solver = getattr(package, method)

        def run(tolerance: float, solver: Any = solver) -> Run:
            def state() -> tuple[Array, None]:
                found, succeeded = solver(
                    rhs.address, start, times, params, rtol=tolerance, atol=tolerance
                )
                return (found[-1] if succeeded else np.full(len(start), np.nan)), None

            return state

        yield method, form.name, run


def _fastest(scene: Scene) -> tuple[Form, Array]:
    form = Form(scene.module, fastest_form(scene.module), scene.params)
    return form, form.from_ordinary(0.0, np.array(scene.y0))


#: Packages by name, and what of theirs is run.
PEERS: dict[str, Peer] = {
    "heyoka": _heyoka,
    "diffrax": _diffrax,
    "numba": _numba,
    "numbalsoda": _numbalsoda,
}
