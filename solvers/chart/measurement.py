"""Curves of every combination of method, form and backend on a scene."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from types import ModuleType

import numpy as np

from solvers.catalogue import load, names
from solvers.chart.curve import Curve, Point
from solvers.chart.reference import Reference
from solvers.compiler import NoCompilerError
from solvers.forms import Form
from solvers.measured import Measured, measured
from solvers.request import SCIPY
from solvers.scenes import Scene

#: The rules that the report calls RK1 to RK4.
REPORT = {"RK1": "rk1", "RK2": "midpoint", "RK3": "rk3", "RK4": "rk4"}
FORMS = ("lagrangian", "hamiltonian", "rational")
#: The longest run of each backend, in s; and of the report's rules, to where rounding turns them.
LONGEST, LONGEST_RULE = {"compiled": 0.02, "python": 0.1, "scipy": 0.1}, 0.5
#: Tolerances, and numbers of fixed steps, from cheap to dear.
TOLERANCES, STEPS = 10.0 ** -np.arange(1, 15), 10 * 2 ** np.arange(24)
#: Errors above this are no result.
MEANINGLESS = 10.0

Combination = tuple[str, str, str]  # method, form, backend


def combinations(module: ModuleType) -> Iterator[Combination]:
    """All that a module's forms allow."""
    forms = [form for form in FORMS if hasattr(module, f"rhs_{form}") or form == "lagrangian"]
    solvable = [f for f in forms if Form(module, f, module.DEFAULTS).has_jacobian]
    for method in names():
        for form in forms if load(method).is_explicit else solvable:
            yield method, form, "compiled"
            yield method, form, "python"
    for method in SCIPY:
        for form in forms:
            yield method, form, "scipy"


def curves(
    scene: Scene, module: ModuleType, truth: Reference,
    wanted: Sequence[Combination] | None = None, longest: dict[str, float] = LONGEST,
) -> list[Curve]:  # fmt: skip
    """A curve for each combination; those that no compiler builds are left out."""
    found = []
    for method, form, backend in wanted or combinations(module):
        try:
            is_rule = method in REPORT.values() and (form, backend) == ("lagrangian", "compiled")
            limit = LONGEST_RULE if is_rule and longest is LONGEST else longest[backend]
            points = list(_points(scene, module, truth, (method, form, backend), limit))
        except NoCompilerError:
            continue
        if points:
            found.append(Curve(scene.name, method, form, backend, points))
    return found


def settings(method: str) -> list[dict[str, float]]:
    """From cheap to dear: tolerances for methods that control their steps, else steps a run."""
    if method in SCIPY or load(method).b_hat:
        return [{"rtol": float(tol)} for tol in TOLERANCES]
    return [{"steps": int(n)} for n in STEPS]


def _points(
    scene: Scene, module: ModuleType, truth: Reference, combination: Combination, longest: float
) -> Iterator[Point]:  # fmt: skip
    method, form, backend = combination
    judge = judged(scene, module, truth)
    for setting in settings(method):
        if setting.get("rtol", 1.0) < 3e-14 and backend == "scipy":
            return  # SciPy accepts no less
        if "steps" in setting:
            setting = {"h": scene.duration / setting["steps"]}
        run = measured(
            module, scene.params(module), scene.y0, scene.duration,
            method=method, form=form, backend=backend, **setting,
        )  # fmt: skip
        if run and (point := judge(run, setting)):
            yield point
        if run and run.work_seconds > longest / 2:
            return


def judged(
    scene: Scene, module: ModuleType, truth: Reference
) -> Callable[[Measured, dict[str, float]], Point | None]:  # fmt: skip
    """A function that makes a point of a run; None if its result means nothing."""
    params = scene.params(module)
    start = module.energy(scene.y0, params)
    place = module.equilibrium(params)
    lively = start - module.energy((*place, *[0.0] * len(place)), params)

    def point(run: Measured, setting: dict[str, float]) -> Point | None:
        error = float(np.abs(run.end - truth.end).max())
        if not error < MEANINGLESS:
            return None
        energy = abs(module.energy(run.end.tolist(), params) - start) / lively
        # what no run can resolve is no error of its method
        return Point(setting, run.work_seconds, run.work_rhs,
                     max(error, truth.global_error), energy)  # fmt: skip

    return point
