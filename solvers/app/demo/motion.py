"""The motion of a scene, integrated by two programs, and played beside Euler's method."""

from __future__ import annotations

from functools import partial

import numpy as np
from scipy.integrate import solve_ivp

from solvers.app.demo.stage import Number, Stage
from solvers.equations.energy import energy_error
from solvers.integration.integrate import integrate
from solvers.integration.solution import Solution
from solvers.player.page import player
from solvers.player.track import Track
from solvers.scenes.scene import Scene

#: Relative and absolute tolerance of both programs, and the step size of Euler's method in s.
TOLERANCE, STEP = 1e-12, 0.01


def motion(scene: Scene) -> Stage:
    """Integrate a scene of the double pendulum, compare the end with SciPy's, and play it."""
    module, span = scene.module, (0.0, scene.duration)
    run = partial(integrate, module, span, scene.y0, scene.params, t_eval=scene.times, energy=True)
    accurate = run(method="verner98", rtol=TOLERANCE, atol=TOLERANCE)
    euler = run(method="rk1", h=STEP)
    independent = partial(solve_ivp, module.rhs, span, scene.y0, args=(scene.params,))
    scipy = independent(method="DOP853", rtol=TOLERANCE, atol=TOLERANCE)
    tracks = [
        _track(scene, f"Verner 9(8), tolerance {TOLERANCE:g}", accurate),
        _track(scene, f"Euler, h = {STEP:g} s", euler),
    ]
    difference = float(np.abs(accurate.y[:, -1] - scipy.y[:, -1]).max())
    change = float(np.abs(tracks[0].energy_error).max())
    angles = zip(module.COORDINATES, accurate.y[:, -1], strict=False)
    end = ", ".join(f"{name} = {value:.9f}" for name, value in angles)
    return Stage(
        (
            f"after {scene.duration:g} s: {end} rad",
            accurate.run,
            f"difference from SciPy's DOP853 {difference:.1g}, energy error {change:.1g}",
        ),
        player(tracks),
        (
            Number(
                f"largest difference between the states of two programs after {scene.duration:g} s",
                f"{difference:.1e} rad or rad/s",
                f"Verner 9(8) and SciPy's DOP853, both with tolerances of {TOLERANCE:g}",
                "holonomic demo",
            ),
            Number(
                "largest relative energy error",
                f"{change:.1e}",
                "computed along the motion, relative to the energy above rest",
                "holonomic demo",
            ),
        ),
    )


def _track(scene: Scene, label: str, run: Solution) -> Track:
    positions = np.asarray(scene.module.positions_many(0.0, run.y, scene.params))
    assert run.energy is not None
    error = energy_error(scene.module, scene.params, run.energy)
    return Track(label, run.t, positions, ((-1, 0), (0, 1)), (), error)
