"""Scenes as exported simulations, with tolerances that keep the requested accuracy."""

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from solvers.app.modules import load, specialiser, system_of
from solvers.io.quantity import quantity
from solvers.runge_kutta import method_catalogue
from solvers.scenes.scene import Scene
from solvers.scenes.scene_reading import find
from solvers.scenes.scene_run import run_scene

if TYPE_CHECKING:
    from derive.codegen.export.exported_system import Simulation
    from derive.system.system import System

#: Methods of controlled and of fixed steps, where a scene names none.
CONTROLLED, FIXED = "verner853", "rk4"
#: Parts of the accuracy that are tried as tolerances.
SHARES = (1e-1, 1e-2, 1e-3, 1e-4)
#: Numbers of equal steps between two rows of output that are tried.
STEPS = tuple(2**k for k in range(11))


def of_scene(
    name: str, event: str = "", *, single: bool = False, fixed: bool = False
) -> "tuple[System, Simulation]":
    """The system and the simulation of a scene.

    Tolerances or step sizes are the largest that were tried whose motion, computed by the exported
    program itself, differs from that of the scene by less than the accuracy.

    Parameters
    ----------
    name : str
        Name or path of a scene.
    event : str, optional
        Such as ``theta2 = pi``.
    single, fixed : bool, optional
        Whether numbers are of single precision, and whether steps are equal.

    Returns
    -------
    System, Simulation

    Raises
    ------
    ValueError
        If there is no such scene, its method is not explicit, or the event is not valid.
    ArithmeticError
        If the motion of the scene, or of the exported program, is not finite.
    """
    from derive.codegen.export.exported_system import Simulation

    scene = find(name, load)
    rows = len(scene.times) - 1
    scene = replace(scene, samples=rows + 1, beside=())
    system = system_of(scene.module)
    is_fixed = fixed or scene.step is not None
    method = method_catalogue.load(scene.method or (FIXED if is_fixed else CONTROLLED))
    simulation = Simulation(
        method, scene.params, scene.y0, scene.duration, rows, event=_crossing(scene, event),
        name=scene.name,
    )  # fmt: skip
    motion = run_scene(scene, specialiser).y
    best, least = simulation, np.inf
    for tried in _variants(simulation, scene, is_fixed=is_fixed):
        error = float(abs(_motion(system, tried, single=single) - motion).max())
        if error < least:
            best, least = tried, error
        if error <= scene.accuracy or error > 2 * least:  # rounding errors grow
            break
    if not np.isfinite(least):
        raise ArithmeticError(
            f"the full equations of the scene {scene.name!r} have no finite motion by explicit "
            "steps, so that no simulation can be exported"
        )
    precision = " in single precision" if single else ""
    relation = "less than" if least <= scene.accuracy else "more than"
    note = (
        f"The rows{precision} differ from the motion of the scene by at most {least:.1e} in rad, "
        f"m, rad/s, m/s,\n{relation} the requested accuracy {scene.accuracy:g}."
    )
    return system, replace(best, note=note)


def _variants(simulation: "Simulation", scene: Scene, *, is_fixed: bool) -> "Iterator[Simulation]":
    """Simulations with decreasing step sizes or tolerances."""
    if scene.step is not None:
        interval = scene.duration / simulation.samples
        yield replace(simulation, steps=max(1, round(interval / scene.step)))
    elif is_fixed:
        yield from (replace(simulation, steps=steps) for steps in STEPS)
    else:
        tolerances = (scene.accuracy * share for share in SHARES)
        yield from (replace(simulation, rtol=x, atol=x) for x in tolerances if x >= 1e-15)


def _crossing(scene: Scene, event: str) -> tuple[str, float] | None:
    """The component of the state and the value of an event."""
    if not event:
        return None
    name, sign, value = (part.strip() for part in event.partition("="))
    units = scene.module.UNITS
    if not sign or name not in scene.module.STATE:
        known = ", ".join(scene.module.STATE)
        raise ValueError(f"the event {event!r} is not NAME = VALUE with a name of {known}")
    return name, quantity(value, units[name])


def _motion(system: "System", simulation: "Simulation", *, single: bool) -> NDArray[np.float64]:
    """The coordinates and velocities of the rows of an exported program, which runs in Python."""
    from derive.codegen.export.language_export import exported_text

    _, text = exported_text(system, "python", replace(simulation, event=None))
    space: dict[str, Any] = {"__name__": "exported"}
    exec(compile(text, "exported", "exec"), space)
    rows: list[list[float]] = []
    space["print_row"] = lambda t, values: rows.append([*map(float, values)])
    if single:  # an operation of a number of Python and one of single precision is of the latter
        for name in ("START_STATE", "DEFAULTS"):
            space[name] = [*map(np.float32, space[name])]
    with np.errstate(all="ignore"):
        try:
            is_complete = space["simulate"]()
        except ArithmeticError:
            is_complete = False
    if not is_complete:
        return np.array(np.nan)
    return np.array(rows)[:, : 2 * len(system.q)].T
