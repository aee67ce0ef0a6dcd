"""Over random scenes of every system that ships errors stay below their estimates.

The ordinary tests run a sample; `make campaign` runs hundreds of scenes.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import generated
import generated.chain_3 as chain
import generated.double_pendulum as dp
from solvers.app.modules import load as load_module
from solvers.equations.module import GeneratedModule, function, has_constraints, has_function
from solvers.equations.starts.consistent_start import consistent_start
from solvers.integration.checks.predictability import ignore_predictability
from solvers.integration.integrate import integrate
from solvers.references.taylor import taylor
from solvers.scenes.models.integration_run import EndsEarlyError, NotAccurateError, TooLongError
from solvers.scenes.models.light_masses import PendulumAndLightMasses
from solvers.scenes.models.motion import Motion
from solvers.scenes.scene import Scene
from solvers.scenes.selection import motion_of, select_model

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


def check_scene(seed: int) -> None:
    scene = random_scene(seed)
    try:
        model = select_model(scene, lambda motion, _: motion, lambda _: None).model
    except (EndsEarlyError, NotAccurateError, TooLongError):
        return
    if model.run and model.run.method_choice.is_series:
        return  # its estimate compares numbers of digits
    motion = motion_of(scene)
    times = motion.sample_times
    error = error_of(motion, model.states(times), times, model.error_estimate)
    assert error <= model.error_estimate <= scene.accuracy, (seed, model.name, scene)


def light_masses(seed: int) -> tuple[Motion, PendulumAndLightMasses]:
    """A motion of a pendulum with light masses, of which the first angle is requested."""
    random = np.random.default_rng([21, seed])
    mass, lengths = 10 ** random.uniform(-10, -4), np.exp(random.uniform(-0.7, 0.7, 3))
    module: GeneratedModule = chain if seed % 3 == 0 else dp
    n = len(module.COORDINATES)
    masses = (1.0, mass, mass * random.uniform(0.3, 1.5))[:n]
    y0 = [*random.uniform(-3.1, 3.1, n), *3 * random.normal(size=n) * random.integers(0, 2)]
    params = (*masses, *lengths[:n].tolist(), 9.81)
    duration = 10 ** random.uniform(0, 1.3)
    motion = Motion(module, params, tuple(map(float, y0)), duration, (0, n))
    return motion, PendulumAndLightMasses.of(motion)


def check_light_masses(seed: int) -> float:
    """Estimate over error, which is at least 1."""
    motion, model = light_masses(seed)
    times, estimate = motion.sample_times, model.error_estimate
    error = error_of(motion, model.states(times), times, estimate / TIGHTER)
    assert error <= estimate, seed
    return estimate / error


# in scene 113 dop853's error is 200 tolerances, and happened to equal that of the checked run;
# scene 16, of the same system as 62, needs series of so many digits that they take minutes
@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize("seed", [*({*range(len(SYSTEMS)), 62, 113} - {16})])
def test_errors_stay_below_their_estimates(seed: int) -> None:
    check_scene(seed)


def test_the_estimate_with_light_masses_is_a_bound_and_a_close_one() -> None:
    ratios = [check_light_masses(seed) for seed in range(8)]
    assert np.median(ratios) < 300
    assert max(ratios) < 1e4


def test_the_estimate_with_light_masses_grows_with_them() -> None:
    motion, light = light_masses(1)
    heavier = replace(motion, params=(1.0, 1e3 * motion.params[1], *motion.params[2:]))
    assert PendulumAndLightMasses.of(heavier).error_estimate > 100 * light.error_estimate


@pytest.mark.campaign
@pytest.mark.parametrize("seed", range(len(SYSTEMS), 500))
def test_errors_of_hundreds_of_scenes_stay_below_their_estimates(seed: int) -> None:
    check_scene(seed)


@pytest.mark.campaign
@pytest.mark.parametrize("seed", range(8, 300))
def test_estimates_with_light_masses_are_bounds(seed: int) -> None:
    assert check_light_masses(seed) < 1e5
