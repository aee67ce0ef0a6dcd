"""Over random scenes of every system that ships errors stay below their estimates.

The ordinary tests run a sample; `make campaign` runs hundreds of scenes.
"""

from dataclasses import replace

import numpy as np
import pytest
from random_motions import SYSTEMS, TIGHTER, error_of, random_scene

import generated.chain_3 as chain
import generated.double_pendulum as dp
from solvers.equations.module import GeneratedModule
from solvers.integration.accuracy.checked_motion import Motion
from solvers.integration.accuracy.integration_run import (
    EndsEarlyError,
    NotAccurateError,
    TooLongError,
)
from solvers.scenes.models.light_masses import PendulumAndLightMasses
from solvers.scenes.selection import motion_of, select_model

Array = np.ndarray


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
@pytest.mark.long("other tests reach its code", daily=12)
@pytest.mark.parametrize("seed", [*({*range(len(SYSTEMS)), 62, 113} - {16})])
def test_errors_stay_below_their_estimates(seed: int) -> None:
    check_scene(seed)


@pytest.mark.long("other tests reach its code")
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
