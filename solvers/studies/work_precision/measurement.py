"""Curves of every combination of method, form and backend on a scene."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

import numpy as np
from numpy.typing import NDArray

from solvers.equations.energy import energy_error
from solvers.equations.forms import Form
from solvers.equations.module import GeneratedModule
from solvers.integration.compiled.compiler import NoCompilerError
from solvers.integration.timing import timed_run
from solvers.runge_kutta.catalogue import SCIPY, load, names
from solvers.scenes.scene import Scene
from solvers.studies.work_precision.curve import Curve, Point
from solvers.studies.work_precision.reference import Reference

Array = NDArray[np.float64]

#: The rules that the report calls RK1 to RK4.
REPORT = {"RK1": "rk1", "RK2": "midpoint", "RK3": "rk3", "RK4": "rk4"}
FORMS = ("lagrangian", "hamiltonian", "rational")
#: The longest run of each backend, in s; and of the report's rules, to where rounding turns them.
LONGEST, LONGEST_RULE = {"compiled": 0.02, "python": 0.1, "scipy": 0.1}, 0.5
#: Tolerances, and numbers of fixed steps, from cheap to dear.
TOLERANCES, STEPS = 10.0 ** -np.arange(1, 15), 10 * 2 ** np.arange(24)
#: Errors above this are no result.
MEANINGLESS = 10.0

#: The least relative tolerance that SciPy accepts, 100 roundings.
FINEST_OF_SCIPY = 3e-14

Combination = tuple[str, str, str]  # method, form, backend
#: Takes setting, seconds, calls if they are known, and the state at the end.
Judge = Callable[[dict[str, float], float, int | None, Array], Point | None]


def combinations(module: GeneratedModule) -> Iterator[Combination]:
    """All that a module's forms allow."""
    forms = [form for form in FORMS if form in module.FORMS]
    solvable = [f for f in forms if Form(module, f, module.DEFAULTS).has_jacobian]
    for method in names():
        for form in forms if load(method).is_explicit else solvable:
            yield method, form, "compiled"
            yield method, form, "python"
    for method in SCIPY:
        for form in forms:
            yield method, form, "scipy"


def curves(scene: Scene, truth: Reference, wanted: Iterable[Combination]) -> list[Curve]:
    """A curve for each combination; those that no compiler builds are left out.

    Parameters
    ----------
    scene : Scene
        What is run.
    truth : Reference
        Its end, beside which errors are found.
    wanted : iterable of tuple
        Method, form and backend of each, as `combinations` gives them.

    Returns
    -------
    list of Curve
        In the order of `wanted`, without those of which no run means anything.

    Raises
    ------
    ValueError
        When the module has no such form, or the method cannot be run in it.
    solvers.runge_kutta.catalogue.UnknownMethodError
        When no method has this name.
    """
    found = []
    for combination in wanted:
        try:
            points = list(_points(scene, truth, combination))
        except NoCompilerError:
            continue
        if points:
            found.append(Curve(scene.name, *combination, points))
    return found


def _points(
    scene: Scene, truth: Reference, combination: Combination
) -> Iterator[Point]:  # fmt: skip
    method, form, backend = combination
    judge = judged(scene, truth)
    for setting in _settings(method, backend, scene.duration):
        run = timed_run(
            scene.module, scene.params, scene.y0, scene.duration,
            method=method, form=form, backend=backend, **setting,
        )  # fmt: skip
        if run and (point := judge(setting, run.work_seconds, run.work_rhs, run.end)):
            yield point
        if run and run.work_seconds > _longest(combination) / 2:
            return


def _settings(method: str, backend: str, duration: float) -> list[dict[str, float]]:
    """From cheap to dear: tolerances for methods that control their steps, else steps in s."""
    if method in SCIPY or load(method).b_hat:
        finest = FINEST_OF_SCIPY if backend == "scipy" else 0.0
        return [{"rtol": float(tol)} for tol in TOLERANCES if tol >= finest]
    return [{"h": float(duration / n)} for n in STEPS]


def _longest(combination: Combination) -> float:
    method, form, backend = combination
    is_rule = method in REPORT.values() and (form, backend) == ("lagrangian", "compiled")
    return LONGEST_RULE if is_rule else LONGEST[backend]


def judged(scene: Scene, truth: Reference) -> Judge:
    """A function that makes a point of a run; None if its result means nothing."""
    module, params = scene.module, scene.params
    start = module.energy(0.0, scene.y0, params)

    def point(
        setting: dict[str, float], seconds: float, calls: int | None, end: Array
    ) -> Point | None:
        error = float(np.abs(end - truth.end).max())
        if not error < MEANINGLESS:
            return None
        _, energy = energy_error(module, params, [start, module.energy(0.0, end.tolist(), params)])
        # what no run can resolve is no error of its method
        return Point(setting, seconds, calls, max(error, truth.global_error), float(abs(energy)))

    return point
