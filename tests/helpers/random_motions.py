"""Random motions of every system that ships, and their errors by an independent reference."""

from pathlib import Path

import numpy as np

import generated
from solvers.app.modules import load as load_module
from solvers.equations.consistent_start import consistent_start
from solvers.equations.module import function, has_constraints, has_function
from solvers.integration.accuracy.checked_motion import Motion
from solvers.integration.checks.predictability import ignore_predictability
from solvers.integration.integrate import integrate
from solvers.references.taylor import taylor
from solvers.scenes.scene import Scene

Array = np.ndarray

SYSTEMS = sorted(path.stem for path in Path(generated.__path__[0]).glob("[a-z]*.h"))
#: Steps of the reference in s, its share of an estimate, and digits where that is not reached.
STEPS, TIGHTER, DIGITS = (2e-3, 1e-3, 5e-4, 2.5e-4), 100, 34


def random_scene(seed: int) -> Scene:
    """A random scene of the system of this number: small or large, hanging or upright."""
    random, module = np.random.default_rng([18, seed]), load_module(SYSTEMS[seed % len(SYSTEMS)])
    n, defaults = len(module.COORDINATES), np.array(module.DEFAULTS)
    params = defaults * np.exp(random.uniform(-0.7, 0.7, len(defaults)))
    size, duration = 10 ** random.uniform(-5, 0.3), 10 ** random.uniform(0, 1.3)
    q = np.zeros(n)
    if has_function(module, "equilibrium"):
        q = np.array(function(module, "equilibrium")(params))
    if module.SYSTEM == "swinging_atwood":
        q, duration = np.array([1.5, 0.0]), 2.0  # later it may collide with the pulley
    is_angle = np.array([module.UNITS[name] == "rad" for name in module.COORDINATES])
    reach = np.where(is_angle, 1.5, 0.3 * np.maximum(np.abs(q), 0.5))
    q = q + np.pi * is_angle * random.integers(0, 2, n) * (random.random() < 0.2)
    q = q + size * reach * random.uniform(-1, 1, n)
    velocities = size * reach * random.normal(size=n) * random.integers(0, 2)
    if module.SYSTEM == "henon_heiles":  # bound motions
        q, velocities = q * 0.5, velocities * 0.3
    accuracy, y0 = 10 ** random.uniform(-12.5, -3), (*q, *velocities)
    if has_constraints(module):
        try:
            y0 = tuple(consistent_start(module, {}, params, guess=y0).y.tolist())
        except ValueError:  # bars of these lengths cannot be joined: others of the same system
            return random_scene(seed + 100 * len(SYSTEMS))
    return Scene(module, tuple(params), y0, duration, accuracy=accuracy)


def collocated(motion: Motion, times: Array, h: float) -> Array:
    """States by an implicit method with fixed steps."""
    arguments = (motion.module, (0, motion.duration), motion.y0, motion.params)
    options = {"method": "gauss3", "form": "lagrangian", "h": h, "compensated": True}
    with ignore_predictability():
        return integrate(*arguments, t_eval=times, max_steps=10**6, **options).y.T


def error_of(motion: Motion, states: Array, times: Array, estimate: float) -> float:
    """The largest error of states, by a reference whose error is a share of the estimate."""
    columns = list(motion.requested)
    coarse = None
    for h in STEPS:
        fine = collocated(motion, times, h)
        if fine.shape != states.shape:
            break
        if coarse is not None and np.abs(fine - coarse)[:, columns].max() < estimate / TIGHTER:
            return float(np.abs(states - fine)[:, columns].max())
        coarse = fine
    exact = taylor(motion.module, motion.params, motion.y0, times, DIGITS)
    return float(np.abs(states - exact)[:, columns].max())
