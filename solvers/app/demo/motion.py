"""The motion of a scene, integrated by two programs, and played beside Euler's method."""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp

from solvers.app.demo.station import Number, Station
from solvers.equations.energy import energy_error
from solvers.integration.integrate import integrate
from solvers.integration.solution import Solution
from solvers.player.page import player
from solvers.player.track import Track
from solvers.scenes.scene import Scene

#: Relative and absolute tolerance of both programs, and Euler's step in s.
TOLERANCE, STEP = 1e-12, 0.01


def motion(scene: Scene) -> Station:
    """Integrate a scene of the double pendulum, compare the end with SciPy's, and play it."""
    module, span = scene.module, (0.0, scene.duration)
    ours = integrate(module, span, scene.y0, scene.params, method="verner98", rtol=TOLERANCE,
                     atol=TOLERANCE, t_eval=scene.times, energy=True)  # fmt: skip
    euler = integrate(module, span, scene.y0, scene.params, method="rk1", h=STEP,
                      t_eval=scene.times, energy=True)  # fmt: skip
    other = solve_ivp(module.rhs, span, scene.y0, method="DOP853", rtol=TOLERANCE, atol=TOLERANCE,
                      args=(scene.params,))  # fmt: skip
    tracks = [
        _track(scene, f"Verner 9(8), tolerance {TOLERANCE:g}", ours),
        _track(scene, f"Euler, h = {STEP:g} s", euler),
    ]
    apart = float(np.abs(ours.y[:, -1] - other.y[:, -1]).max())
    change = float(np.abs(tracks[0].energy_error).max())
    names = zip(module.COORDINATES, ours.y[:, -1], strict=False)
    return Station(
        (
            f"after {scene.duration:g} s: "
            + ", ".join(f"{name} = {value:.9f}" for name, value in names) + " rad",
            ours.run,
            f"SciPy's DOP853 ends {apart:.1g} apart; energy is kept to {change:.1g}",
        ),
        player(tracks),
        (
            Number(
                f"largest difference of two programs' states after {scene.duration:g} s",
                f"{apart:.1e} rad or rad/s",
                f"Verner 9(8) beside SciPy's DOP853, both with tolerances of {TOLERANCE:g}",
                "holonomic demo",
            ),
            Number(
                "largest relative energy error", f"{change:.1e}",
                "computed along the motion, in parts of the energy above rest",
                "holonomic demo",
            ),
        ),
    )  # fmt: skip


def _track(scene: Scene, label: str, run: Solution) -> Track:
    places = np.asarray(scene.module.positions_many(0.0, run.y, scene.params))
    assert run.energy is not None
    error = energy_error(scene.module, scene.params, run.energy)
    return Track(label, run.t, places, ((-1, 0), (0, 1)), (), error)
