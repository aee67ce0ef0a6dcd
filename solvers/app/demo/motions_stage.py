"""The motion of a scene beside Euler's method, and a map of many motions."""

import time
from functools import partial
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

from solvers.app.demo.stage import ReportedNumber, Stage, png_image
from solvers.equations.energy import energy_error, energy_unit
from solvers.integration.checks.predictability import ignore_predictability
from solvers.integration.integrate import integrate
from solvers.integration.results.solution import Solution
from solvers.player.player_page import player
from solvers.player.track import Track
from solvers.scenes.scene import Scene
from solvers.sweeps.definition.sweep import Sweep
from solvers.sweeps.execution.sweep_run import convergence, sweep, tighter_rtol
from solvers.sweeps.plots.figure import figure

#: Relative and absolute tolerance of both programs, and the step size of Euler's method in s.
TOLERANCE, STEP = 1e-12, 0.01
#: The two rods.
RODS = (("rod", (-1, 0)), ("rod", (0, 1)))


def motion(scene: Scene) -> Stage:
    """Integrate a scene of the double pendulum, compare the end with SciPy's, and play it."""
    module, span = scene.module, (0.0, scene.duration)
    run = partial(integrate, module, span, scene.y0, scene.params, t_eval=scene.times, energy=True)
    accurate = run(method="verner98", rtol=TOLERANCE, atol=TOLERANCE)
    independent = partial(solve_ivp, module.rhs, span, scene.y0, args=(scene.params,))
    scipy = independent(method="DOP853", rtol=TOLERANCE, atol=TOLERANCE)
    with ignore_predictability():  # its errors are what is shown
        euler = run(method="rk1", h=STEP)
    tracks = [
        _track(scene, f"Verner 9(8), tolerance {TOLERANCE:g}", accurate),
        _track(scene, f"Euler, h = {STEP:g} s", euler),
    ]
    difference = float(np.abs(accurate.y[:, -1] - scipy.y[:, -1]).max())
    assert tracks[0].energy_error is not None
    change = float(np.abs(tracks[0].energy_error).max())
    angles = zip(module.COORDINATES, accurate.y[:, -1], strict=False)
    end = ", ".join(f"{name} = {value:.9f}" for name, value in angles)
    after, command = f"after {scene.duration:g} s", "holonomic demo"
    apart = f"largest difference between the states of two programs {after}"
    programs = f"Verner 9(8) and SciPy's DOP853, both with tolerances of {TOLERANCE:g}"
    energy = f"computed along the motion, relative to the {tracks[0].energy_unit}"
    return Stage(
        (
            f"{after}: {end} rad",
            accurate.run,
            f"difference from SciPy's DOP853 {difference:.1g}, energy error {change:.1g}",
        ),
        player(tracks),
        (
            ReportedNumber(apart, f"{difference:.1e} rad or rad/s", programs, command),
            ReportedNumber("largest relative energy error", f"{change:.1e}", energy, command),
        ),
    )


def _track(scene: Scene, label: str, run: Solution) -> Track:
    positions = np.asarray(scene.module.positions_many(0.0, run.y, scene.params))
    assert run.energy is not None
    error = energy_error(scene.module, scene.params, run.energy)
    unit = energy_unit(scene.module, scene.params, float(run.energy[0])).name
    return Track(label, run.t, positions, RODS, error, unit)


def flips(definition: Sweep, folder: Path) -> Stage:
    """Run or resume a sweep and plot its map: the time until a double pendulum first flips."""
    start = time.perf_counter()
    results = sweep(definition, folder)
    seconds = time.perf_counter() - start
    change = convergence(definition)["flip"]
    motions, duration = f"{definition.motions:,}", f"{definition.duration:g} s"
    flipped = f"{results.count.get('event', 0):,}"
    method = (
        f"{change.motions} of them repeated with rtol = {tighter_rtol(definition):.0e}: "
        f"half of the times change by less than {change.median:.0e} s"
    )
    quantity = f"motions of {motions} that flip within {duration}"
    return Stage(
        (f"{motions} motions of {duration}: {flipped} flip ({seconds:.1f} s this time)",),
        png_image(figure(results), "Map of the time until one of the rods flips"),
        (ReportedNumber(quantity, flipped, method, f"holonomic sweep {definition.name}"),),
    )
