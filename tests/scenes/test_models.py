"""Models of a motion: each is exact about its own domain, its error below its estimate."""

import json
from collections import Counter
from dataclasses import replace
from functools import partial
from math import pi, sqrt

import numpy as np
import pytest
import scipy
from sharing import Shared

import generated.double_pendulum as dp
import generated.driven_pendulum as driven
import generated.duffing as duffing
import generated.elastic_pendulum as ep
import generated.rotating_hoop as hoop
import generated.single_pendulum as sp
import generated.spherical_pendulum as spherical
from solvers.app.modules import load as load_module
from solvers.equations.linearisation.normal_modes import _generalized_eigh, mode_spread
from solvers.integration.accuracy import checked_run, sufficient_run
from solvers.integration.accuracy.checked_motion import Motion, OutsideDomainError
from solvers.integration.accuracy.checked_run import estimated_error
from solvers.integration.accuracy.double_precision import check_times
from solvers.integration.accuracy.integration_run import (
    IntegrationRun,
    NotAccurateError,
    TooLongError,
)
from solvers.integration.accuracy.method_choice import RECORD, MethodChoice, cheapest, usual_form
from solvers.integration.accuracy.sufficient_run import by_series
from solvers.integration.checks.predictability import ignore_predictability
from solvers.integration.integrate import integrate
from solvers.references.taylor import taylor
from solvers.scenes.models import equilibrium, modal_motion, quadrature
from solvers.scenes.models.equilibrium import Equilibrium, _exponentials
from solvers.scenes.models.light_masses import PendulumAndLightMasses
from solvers.scenes.models.modal_motion import NormalModes
from solvers.scenes.models.model_catalogue import closed_forms, load
from solvers.scenes.models.one_degree_of_freedom import ReducedMotion
from solvers.scenes.models.pendulum import Pendulum
from solvers.scenes.models.quadrature import Orbit, Quadrature, orbit
from solvers.scenes.scene import Scene
from solvers.scenes.scene_reading import find
from solvers.scenes.selection import ModelSelection, select_model

Array = np.ndarray


def motion_from(module, y0, duration, params=None, requested=None) -> Motion:
    params = tuple(params or module.DEFAULTS)
    return Motion(module, params, tuple(y0), duration, requested or tuple(range(len(y0))))


def selected(scene: Scene) -> ModelSelection:
    return select_model(scene, lambda motion, _: motion, lambda _: None)


def reference(motion: Motion, times: Array, digits: int = 24) -> Array:
    return taylor(motion.module, motion.params, motion.y0, times, digits)


def largest_error(motion: Motion, model, digits: int = 24) -> float:
    """The largest error of requested components, compared with Taylor series."""
    apart = np.abs(
        model.states(motion.sample_times) - reference(motion, motion.sample_times, digits)
    )
    return float(apart[:, list(motion.requested)].max())


def random_scene(random: np.random.Generator) -> Scene:
    """A random scene: at rest or nearly, small, without gravity, with a light bob, or large."""
    module = (dp, sp, ep)[random.integers(3)]
    n = len(module.COORDINATES)
    params = np.array(module.DEFAULTS) * np.exp(random.uniform(-1, 1, len(module.PARAMETERS)))
    y0, outputs = np.zeros(2 * n), module.STATE
    kind = random.choice(["still", "small", "weightless", "light", "large"])
    duration = min(10 ** random.uniform(-1, 1.3), 12.0)  # longer motions may need many digits
    if kind == "weightless":
        params[-1] = 0.0
    y0[:n] = module.equilibrium(params)
    if kind in ("still", "small"):
        size = 10 ** random.uniform(-9, -1)
        y0[:n] += size * random.normal(size=n)
        if kind == "small":
            y0[n:] = size * random.normal(size=n)
            duration = 10 ** random.uniform(-1, 2.5)
        elif module is not ep:
            y0[:n] += pi * random.integers(0, 2, n)  # upright, or nearly
    else:
        y0[:n] += random.uniform(-0.5, 0.5, n) * y0[0] if module is ep else random.uniform(-3, 3, n)
        y0[n:] = 2 * random.normal(size=n) * random.integers(0, 2)
    if kind == "light" and module is dp:
        params[1] = 10 ** random.uniform(-12, -5)
        outputs = ("theta1", "theta1_dot")
    return Scene(
        module,
        tuple(params),
        tuple(y0),
        duration,
        accuracy=10 ** random.uniform(-10, -2),
        outputs=outputs,
    )


def accuracy_of(scene: Scene) -> tuple[str, float]:
    """Model, and error relative to the requested accuracy."""
    model = selected(scene).model
    motion = Motion(scene.module, scene.params, scene.y0, scene.duration, scene.requested)
    with ignore_predictability():
        fine = integrate(
            scene.module,
            (0, scene.duration),
            scene.y0,
            scene.params,
            method="verner98",
            rtol=3e-14,
            atol=1e-16,
            t_eval=motion.sample_times,
            max_steps=10**7,
        ).y.T
    error = np.abs(model.states(motion.sample_times) - fine)[:, list(scene.requested)].max()
    if error > min(scene.accuracy, model.error_estimate):  # or it is the reference that is wrong
        error = largest_error(motion, model, digits=40)
    return model.name, error / scene.accuracy


#: Random scenes are divided into this many parts, which workers share.
PARTS = 4


def accuracies_of_part(part: int) -> list[tuple[str, float]]:
    """Models and errors, relative to the accuracy, of some of 60 random scenes."""
    random = np.random.default_rng(5)
    scenes = [random_scene(random) for _ in range(60)]
    return [accuracy_of(scene) for scene in scenes[part::PARTS]]


@pytest.mark.long("more cases of the same kind")
@pytest.mark.slow
@pytest.mark.parametrize("part", range(PARTS))
def test_in_random_scenes_the_error_stays_below_the_accuracy(part: int, shared: Shared) -> None:
    results = shared(f"random_scenes_{part}", partial(accuracies_of_part, part))
    assert len(results) == 60 // PARTS
    assert all(error <= 1 for _, error in results), results


@pytest.mark.long("all parts of the random scenes")
def test_random_scenes_use_every_model(shared: Shared) -> None:
    parts = [
        shared(f"random_scenes_{part}", partial(accuracies_of_part, part)) for part in range(PARTS)
    ]
    count = Counter(model for part in parts for model, _ in part)
    assert set(count) == {"rest", "normal modes", "pendulum", "quadrature", "full equations"}
    assert min(count.values()) >= 2


def test_an_equilibrium_stays_until_its_residual_acceleration_grows() -> None:
    hanging = Equilibrium.of(motion_from(dp, (0, 0, 0, 0), 1000))
    assert hanging.error_estimate == 0
    assert hanging.states(np.array([0.0, 7.0])).tolist() == [[0] * 4] * 2
    # the number next to pi is not upright: that is rest for a while, and no longer
    for duration, least, most in ((1, 1e-16, 1e-13), (5, 1e-13, 1e-10), (14, 1e-4, 1e-1)):
        motion = motion_from(sp, (pi, 0.0), duration)
        model = Equilibrium.of(motion)
        assert least < model.error_estimate < most
        assert (
            largest_error(motion, model) <= model.error_estimate < 40 * largest_error(motion, model)
        )
    with pytest.raises(OutsideDomainError, match="leaves the initial state"):
        Equilibrium.of(motion_from(sp, (pi, 0.0), 40))


def test_a_very_small_velocity_is_rest_where_its_motion_is_below_the_accuracy() -> None:
    scene = Scene(sp, sp.DEFAULTS, (0.0, 1e-9), 10.0, accuracy=1e-8)
    model = selected(scene).model
    assert model.name == "rest"
    # the velocity becomes -1e-9 rad/s
    assert 1 < model.error_estimate / 2e-9 < 2
    finer = selected(replace(scene, accuracy=1e-9))
    assert finer.model.name == "normal modes"
    assert finer.declined["rest"] == "its error may reach 3e-09"


def test_a_driven_pendulum_that_hangs_or_stands_is_at_rest() -> None:
    hanging = selected(Scene(driven, driven.DEFAULTS, (0.0, 0.0), 10.0)).model
    assert (hanging.name, hanging.error_estimate) == ("rest", 0.0)
    beside = motion_from(driven, (1e-6, 0.0), 1.0)
    error = largest_error(beside, model := Equilibrium.of(beside))
    assert 1e-6 < error < model.error_estimate < 2 * error
    # 100 oscillations a second hold it upright, as P. L. Kapitza's
    upright = selected(Scene(driven, driven.DEFAULTS, (pi, 0.0), 10.0, accuracy=1e-9)).model
    assert upright.name == "rest"


@pytest.mark.parametrize("periods", [0.3, 128, 1024])
def test_rest_beside_a_small_periodic_force(periods: float) -> None:
    # x'' + x = F cos(Ω t), also over whole periods, of which each interval has many
    size, Omega = 1e-9, 9.0
    parameters = {"m": 1.0, "k": 1.0, "beta": 0.0, "c": 0.0, "F": size, "Omega": Omega}
    params = tuple(parameters[name] for name in duffing.PARAMETERS)
    motion = motion_from(duffing, (0.0, 0.0), periods * 2 * pi / Omega, params)
    t = np.linspace(0, motion.duration, 100_001)
    x = size * (np.cos(Omega * t) - np.cos(t)) / (1 - Omega**2)
    x_dot = size * (np.sin(t) - Omega * np.sin(Omega * t)) / (1 - Omega**2)
    error = np.abs([x, x_dot]).max()
    assert error <= Equilibrium.of(motion).error_estimate < 2 * error


def test_small_motion_is_its_normal_modes_up_to_the_nonlinear_terms() -> None:
    for module, shift in ((sp, [0.01]), (dp, [0.004, -0.001]), (ep, [0.001, 0.004])):
        n = len(shift)
        start = np.array([*module.equilibrium(module.DEFAULTS), *[0.0] * n])
        start[:n] += shift
        motion = motion_from(module, start.tolist(), 20.0)
        model = NormalModes.of(motion)
        error = largest_error(motion, model)
        assert error < model.error_estimate < 1.5 * error
    assert NormalModes.of(motion_from(dp, (1.0, 1.0, 0, 0), 20.0)).error_estimate > 1e3
    with pytest.raises(OutsideDomainError, match="does not oscillate"):
        NormalModes.of(motion_from(sp, (0.1, 0), 1.0, params=(1, 2, 0.0)))


@pytest.mark.long("more cases of the same kind", keep=2)
@pytest.mark.parametrize(("angle", "duration"), [(1e-3, 300.0), (1e-2, 30.0), (0.05, 3.0)])
def test_the_error_of_normal_modes_is_estimated_closely(angle: float, duration: float) -> None:
    for module, params, y0 in (
        (hoop, (1, 1, 2, 9.81), (angle, 0.5 * angle)),
        (dp, dp.DEFAULTS, (angle, -0.5 * angle, 0.0, 0.0)),
        (ep, (1, 40, 1, 9.81), (1 + 9.81 / 40 + angle / 3, angle, 0.0, 0.0)),
    ):
        motion = motion_from(module, y0, duration, params)
        with ignore_predictability():
            fine = integrate(
                module, (0, duration), y0, params, method="verner98", rtol=1e-13, atol=1e-15,
                t_eval=motion.sample_times,
            )  # fmt: skip
        model = NormalModes.of(motion)
        error = np.abs(model.states(motion.sample_times) - fine.y.T).max()
        assert error < model.error_estimate < 1.5 * error


def test_of_the_smallest_motions_only_rounding_remains() -> None:
    motion = motion_from(dp, (1e-9, -2e-9, 0, 0), 20.0)
    model = NormalModes.of(motion)
    assert 1e-26 < largest_error(motion, model) <= model.error_estimate < 1e-20
    # of a length that stays the same but for rounding
    stretched = motion_from(ep, (1.24525 + 1e-9, 0, 0, 0), 20.0, (1, 40, 1, 9.81), (0,))
    estimate = NormalModes.of(stretched).error_estimate
    assert largest_error(stretched, NormalModes.of(stretched)) < estimate < 1e-13


@pytest.mark.long("more cases of the same kind", keep=2)
@pytest.mark.parametrize(("params", "y0", "duration"), [
    ((1, 2, 9.81), (2.0, 0.0), 60),
    ((1, 2, 9.81), (0.0, 10.0), 60),  # over and over
    ((1, 1, 9.0), (0.0, 6.0), 5),  # on the separatrix
    ((1, 1, 9.0), (0.0, 6.0 - 1e-12), 5),
    ((1, 2, -9.81), (pi - 2.0, 0.5), 60),  # upside down
])  # fmt: skip
def test_a_single_pendulum_has_a_closed_form(params, y0, duration) -> None:
    motion = motion_from(sp, y0, duration, params)
    model = Pendulum.of(motion)
    assert model.error_estimate < 1e-6
    assert largest_error(motion, model) <= model.error_estimate


@pytest.mark.parametrize("angle", [0.3, 2.0, 10 * pi + 0.3, 10 * pi + 2.0])
def test_a_mirrored_motion_has_the_same_estimate(angle: float) -> None:
    right, left = (
        Pendulum.of(motion_from(sp, (sign * angle, sign * 0.1), 8.0)) for sign in (1, -1)
    )
    assert left.error_estimate == pytest.approx(right.error_estimate, rel=0.03, abs=0)


def test_a_mirrored_motion_is_affected_as_much_by_a_light_bob() -> None:
    speed, params = 2 * (9.81 / 2) ** 0.5 - 1e-9, (1, 1e-9, 2, 2, 9.81)  # next to the separatrix
    right, left = (
        PendulumAndLightMasses.of(motion_from(dp, (0, s, s * speed, 0), 20.0, params, (0, 2)))
        for s in (1, -1)
    )
    assert left.error_estimate == pytest.approx(right.error_estimate, rel=0.01)


def test_near_the_separatrix_the_estimate_contains_rounding() -> None:
    for duration in (5, 8, 10, 12):
        motion = motion_from(sp, (0.0, 6.0 - 1e-12), duration, (1, 1, 9.0))
        model = Pendulum.of(motion)
        assert largest_error(motion, model) <= model.error_estimate
    assert model.error_estimate > 1e-3


def test_an_absent_mass_or_length_leaves_a_single_pendulum() -> None:
    for absent, length in (((1, 0, 2, 2, 9.81), 2.0), ((1, 1, 2, 0, 9.81), 2.0)):
        model = Pendulum.of(motion_from(dp, (2.0, 1.0, 0.5, 0.0), 10, absent, (0, 2)))
        single = motion_from(sp, (2.0, 0.5), 10, (1, length, 9.81))
        states = model.states(single.sample_times)
        assert np.abs(states[:, [0, 2]] - reference(single, single.sample_times)).max() < 1e-12
        assert np.isnan(states[:, [1, 3]]).all()
    with pytest.raises(OutsideDomainError, match="theta2 has no inertia"):
        Equilibrium.of(motion_from(dp, (0, 0, 0, 0), 1, (1, 0, 2, 2, 9.81)))
    with pytest.raises(OutsideDomainError, match="2 coordinates have inertia"):
        Pendulum.of(motion_from(dp, (2.0, 1.0, 0, 0), 1))


def test_a_light_bob_has_no_effect_and_a_heavy_one_has() -> None:
    params = (1.0, 1e-9, 2.0, 2.0, 9.81)
    motion = motion_from(dp, (1.5, 0.3, 0, 1), 3, params, (0, 2))
    model = PendulumAndLightMasses.of(motion)
    assert 0 < largest_error(motion, model) < model.error_estimate < 1e-3
    heavy = PendulumAndLightMasses.of(
        motion_from(dp, (1.5, 0.3, 0, 1), 3, (1.0, 1e-2, 2.0, 2.0, 9.81), (0, 2))
    )
    assert heavy.error_estimate > 1
    with pytest.raises(OutsideDomainError, match="1 of 1 coordinates are requested"):
        PendulumAndLightMasses.of(motion_from(sp, (1.5, 0.0), 3))
    with pytest.raises(OutsideDomainError, match="2 of 2 coordinates are requested"):
        PendulumAndLightMasses.of(motion_from(dp, (1.5, 0.3, 0, 1), 3, params))


@pytest.mark.parametrize(("model", "module", "params", "y0", "requested"), [
    (Pendulum, sp, (1.0, 2.0, 9.81), (2.0, 0.5), None),
    (PendulumAndLightMasses, dp, (1.0, 1e-9, 2.0, 2.0, 9.81), (1.5, 0.3, 0, 1), (0, 2)),
    (NormalModes, dp, (1.0, 0.5, 2.0, 1.0, 9.81), (0.01, -0.02, 0, 0), None),
    (Quadrature, ep, (1.0, 40.0, 1.0, 0.0), (1.4, 0.0, 0, 0.5), None),
])  # fmt: skip
def test_the_unit_of_mass_does_not_matter(model, module, params, y0, requested) -> None:
    """Accelerations depend on ratios of masses, and of a stiffness to a mass."""
    scaled = {"m", "m1", "m2", "k"}
    times, found = np.linspace(0, 2, 9), []
    for unit in (1.0, 1e-3, 1e3):  # kg, t and g
        values = [p * unit if name in scaled else p
                  for name, p in zip(module.PARAMETERS, params, strict=True)]  # fmt: skip
        one = model.of(motion_from(module, y0, 2.0, values, requested))
        found.append((one.states(times), one.error_estimate))
    for states, estimate in found[1:]:
        assert states == pytest.approx(found[0][0], abs=1e-9, nan_ok=True)
        assert estimate == pytest.approx(found[0][1], rel=0.5)


def test_a_light_bob_below_a_pendulum_without_weight_is_no_pendulum() -> None:
    for gravity in (0.0, -9.81):
        motion = motion_from(dp, (1.5, 0.3, 0, 1), 1, (1.0, 1e-9, 2.0, 2.0, gravity), (0, 2))
        with pytest.raises(OutsideDomainError, match="does not move as a pendulum"):
            PendulumAndLightMasses.of(motion)


def test_accelerations_by_a_light_bob_add_up_although_their_signs_change() -> None:
    # the integral of the acceleration is a fifteenth of the integral of its magnitude
    params = (1.0, 1e-9, 2.0, 2.0, 9.81)
    motion = motion_from(dp, (1.5, 0.3, 0, 1), 0.684, params, (0, 2))
    model = PendulumAndLightMasses.of(motion)
    error = largest_error(motion, model)
    assert error < model.error_estimate < 10 * error


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize(("module", "params", "y0"), [
    (dp, (1, 1, 2, 2, 0), (0, 1.5, 2, -3)),  # the shape rotates
    (dp, (1, 0.3, 2, 1, 0), (0, 0.5, 2, 2.5)),  # it swings
    (dp, (1, 0.3, 2, 1, 0), (0.4, 0.5, 0, 2.5)),
    (ep, (1, 40, 0.75, 0), (1.0, 0.3, 0.5, 2.0)),
    (ep, (1, 40, 0.75, 0), (1.0, 0.3, 0.0, 2.0)),  # starts at a turning point
    (sp, (1, 2, 9.81), (1.0, 2.0)),
])  # fmt: skip
def test_one_degree_of_freedom_is_a_quadrature(module, params, y0) -> None:
    motion = motion_from(module, y0, 30.0, params)
    model = Quadrature.of(motion)
    assert model.error_estimate < 1e-8
    assert largest_error(motion, model) <= model.error_estimate
    # at any time, and far away at no further cost
    later = motion_from(module, y0, 1000.0, params)
    end = Quadrature.of(later).states(np.array([1000.0]))
    with ignore_predictability():
        run = integrate(module, (0, 1000), y0, params, method="verner98", rtol=1e-13, atol=1e-14)
    assert np.abs(end - run.y[:, -1]).max() < 1e-6


@pytest.mark.parametrize("speed", [1e-3, 1e-6, -1e-6, 1e-9])
def test_a_start_next_to_a_turning_point_costs_no_accuracy(speed: float) -> None:
    for module, y0, params in (
        (sp, (1.0, speed), sp.DEFAULTS),
        (ep, (1.0, 0.3, speed, 2.0), (1, 40, 0.75, 0)),
    ):
        motion = motion_from(module, y0, 3.0, params)
        model = Quadrature.of(motion)
        assert largest_error(motion, model) <= min(model.error_estimate, 1e-11)


def test_the_error_of_turning_points_is_estimated() -> None:
    # of a slow swing of 1e-4 rad the energy above rest has half of all digits, and so have the
    # turning points; errors of velocities and of the time are much smaller
    params = (1, 2, 9.81e-12)
    for share in np.geomspace(1e-3, 1e-2, 12):
        y0 = (1e-4, share * 1e-4 * (params[2] / params[1]) ** 0.5)
        motion = motion_from(sp, y0, 1.0, params, (0,))
        assert largest_error(motion, model := Quadrature.of(motion)) <= model.error_estimate < 1e-9


@pytest.mark.parametrize(("module", "params", "y0"), [
    (spherical, spherical.DEFAULTS, (1.0, 0.0, 0.0, 3.0)),
    (hoop, (1, 1, 2, 9.81), (0.01, 0.0)),
    (hoop, (1, 1, 2, 9.81), (1e-3, 0.01)),
])  # fmt: skip
def test_rounding_errors_of_a_quadrature_are_estimated_closely(module, params, y0) -> None:
    motion = motion_from(module, y0, 1.0, params)
    model = Quadrature.of(motion)
    error = largest_error(motion, model)
    assert error <= model.error_estimate < 30 * error


def test_an_error_of_the_period_counts_by_the_fastest_motion(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    delay = 1e-6

    def late(reduced: ReducedMotion, n: int | None = None) -> Orbit:
        one = orbit(reduced, n)
        time = replace(one.time, mean=(1 + delay) * one.time.mean)
        return replace(one, time=time, period_error=delay)

    monkeypatch.setattr(quadrature, "orbit", late)
    motion = motion_from(sp, (2.0, 0.0), 30.0)
    error = largest_error(motion, model := Quadrature.of(motion))
    assert 1e-4 < error < model.error_estimate < 1.1 * error


def test_quadrature_refuses_motions_outside_its_domain() -> None:
    with pytest.raises(OutsideDomainError, match="rotating the whole system changes its energy"):
        Quadrature.of(motion_from(dp, (0, 1, 2, 3), 1))
    with pytest.raises(OutsideDomainError, match="no Fourier series"):  # on the separatrix
        Quadrature.of(motion_from(dp, (0, pi / 2, 2, -1), 1, (1, 1, 2, 2, 0)))
    with pytest.raises(OutsideDomainError, match="the shape is at rest"):
        Quadrature.of(motion_from(dp, (0, 1, 0, 0), 1, (1, 1, 2, 2, 0)))
    with pytest.raises(OutsideDomainError, match="approaches a singularity"):
        Quadrature.of(motion_from(ep, (1.0, 0, 3.0, 0), 1, (1, 1e-9, 1, 0)))


@pytest.mark.long("other tests reach its code")
def test_a_shorter_series_is_less_accurate_and_its_estimate_shows_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    motion = motion_from(dp, (0, 1.5, 2, -1.3), 30.0, (1, 1, 2, 2, 0))
    fine = Quadrature.of(motion)
    monkeypatch.setattr(quadrature, "END", 1e-3)
    monkeypatch.setattr(quadrature, "POINTS", (8, *quadrature.POINTS))
    rough = Quadrature.of(motion)
    assert len(rough.orbit.time.terms) < len(fine.orbit.time.terms)
    assert 1e-7 < largest_error(motion, rough) <= rough.error_estimate


@pytest.mark.parametrize("duration", [5000, 20_000])
def test_errors_of_normal_modes_grow_as_the_period_differs(duration: float) -> None:
    # the period of a pendulum is longer by a²/16 than that of its normal mode
    amplitude, (_, length, g) = 1e-4, sp.DEFAULTS
    late = amplitude**2 / 16 * sqrt(g / length) * duration  # rad of the phase
    modes = NormalModes.of(motion_from(sp, (amplitude, 0), duration))
    assert amplitude * late < modes.error_estimate < 10 * amplitude * late


def test_without_their_propagation_errors_would_be_underestimated(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # without the propagation of the defect the normal modes would claim too much
    motion = motion_from(dp, (0.005, -0.002, 0, 0), 20.0)
    monkeypatch.setattr(modal_motion, "MARGIN", 0.0)
    assert NormalModes.of(motion).error_estimate < largest_error(motion, NormalModes.of(motion))
    motion = motion_from(sp, (pi, 0.0), 14)
    monkeypatch.setattr(
        equilibrium, "_exponentials", lambda matrices: np.eye(matrices.shape[-1]) + matrices
    )
    assert Equilibrium.of(motion).error_estimate < largest_error(motion, Equilibrium.of(motion))


@pytest.mark.parametrize("size", [1e-3, 1.0, 10.0])
def test_exponentials_and_modes_are_those_of_scipy(size: float) -> None:
    rng = np.random.default_rng(5)
    matrices = size * rng.normal(size=(20, 5, 5))
    truth = scipy.linalg.expm(matrices)
    difference = np.abs(_exponentials(matrices) - truth).max(axis=(1, 2))
    assert (difference < 1e-12 * (1 + 10 * size) * np.abs(truth).max(axis=(1, 2))).all()
    factor, other = rng.normal(size=(2, 4, 4))
    mass_matrix, stiffness = factor @ factor.T + np.eye(4), size * (other @ other.T)
    squares, shapes = _generalized_eigh(stiffness, mass_matrix)
    assert squares == pytest.approx(scipy.linalg.eigh(stiffness, mass_matrix)[0], rel=1e-9)
    assert shapes.T @ mass_matrix @ shapes == pytest.approx(np.eye(4), abs=1e-12)
    assert stiffness @ shapes == pytest.approx(mass_matrix @ shapes * squares, abs=1e-11 * size)


@pytest.mark.parametrize("index", [0, 1])
def test_modes_of_matrices_that_are_not_finite_are_refused(index: int) -> None:
    matrices = np.array([np.eye(2), np.eye(2)])
    matrices[index, 0, 0] = np.inf
    with pytest.raises(ValueError, match="matrices are not finite"):
        _generalized_eigh(*matrices)


def test_the_full_equations_are_checked_by_another_method() -> None:
    scene = find("report", load_module)
    motion = Motion(dp, scene.params, scene.y0, scene.duration, scene.requested)
    model = selected(scene).model
    error = largest_error(motion, model)
    assert error <= model.error_estimate <= scene.accuracy
    assert model.error_estimate < 100 * error
    # a check of the run by itself would find nothing
    choice = MethodChoice("verner98", "rational", "")
    assert estimated_error(IntegrationRun(motion, choice, 1e-6), motion) > 1e-9
    assert set(checked_run.CHECKS) == {"dop853", "verner98"}


@pytest.mark.long("a decimal series of a chaotic motion")
@pytest.mark.slow
def test_where_no_compiled_numbers_are_sufficient_series_have_more_digits(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(sufficient_run, "PRECISIONS", {})
    scene = find("long", load_module)
    selection = selected(scene)
    assert selection.model.run.method_choice.method == "taylor"
    assert "at best where 1e-09 is requested" in selection.declined["double precision"]
    end = selection.model.states(np.array([20.0]))[0]
    fine = taylor(dp, scene.params, scene.y0, [0, 20], 40)[-1]  # errors grow by 1e7
    assert np.abs(end - fine).max() <= selection.model.error_estimate < 1e-13
    with pytest.raises(NotAccurateError, match="dop853 reaches"):
        selected(replace(scene, method="dop853"))


def test_a_series_in_double_precision_has_the_rounding_of_its_largest_number() -> None:
    # both coordinate and velocity are negative all the time
    motion = motion_from(sp, (-1.5, -3.0), 0.25)
    choice = MethodChoice("taylor", "lagrangian", "")
    times = np.array([0.0, 0.125, 0.25])
    model = by_series(motion, choice, 1e-15, times, lambda _: None)
    largest = np.abs(model.states(times)).max()
    assert model.error_estimate == np.spacing(largest) == 2.0**-51


def test_series_take_angles_of_up_to_a_million() -> None:
    times, choice = np.array([0.0, 0.01]), MethodChoice("taylor", "lagrangian", "")
    by_series(motion_from(sp, (-1e6, 0.0), 0.01), choice, 1e-9, times, lambda _: None)
    beyond = motion_from(sp, (np.nextafter(-1e6, -2e6), 0.0), 0.01)
    with pytest.raises(TooLongError, match=r"angles above 1e\+06 rad"):
        by_series(beyond, choice, 1e-9, times, lambda _: None)


@pytest.mark.long("other tests reach its code")
def test_a_scene_can_name_model_method_and_step() -> None:
    still = find("rest", load_module)
    assert selected(still).model.name == "rest"
    assert selected(replace(still, model="full")).model.name == "full equations"
    named = selected(replace(find("report", load_module), method="rk4", step=0.01)).model
    assert (named.run.method_choice.method, named.run.setting) == ("rk4", 0.01)
    assert (
        largest_error(named.run.motion, named)
        < named.error_estimate
        < 3 * largest_error(named.run.motion, named)
    )
    for method in ("rk4", "gauss3"):  # fixed steps are adapted, too
        fixed = selected(replace(find("report", load_module), method=method, accuracy=1e-6)).model
        assert largest_error(fixed.run.motion, fixed) <= fixed.error_estimate <= 1e-6
    # a model that is not sufficient can be named, with its error
    wide = replace(find("single", load_module), y0=(0.1, 0.0), model="normal modes")
    linear = selected(wide).model
    assert linear.name == "normal modes"
    assert (
        wide.accuracy
        < largest_error(motion_from(sp, wide.y0, 10.0), linear)
        < linear.error_estimate
    )
    absent = replace(find("one_bob", load_module), model="full")
    with pytest.raises(OutsideDomainError, match="theta2 has no inertia"):
        selected(absent)


def test_a_step_fixes_the_steps_of_methods_that_could_control_them() -> None:
    scene = replace(find("report", load_module), method="dop853", step=0.05)
    run = selected(scene).model.run
    assert (run.setting_name, run.setting) == ("h", 0.05)
    times, _ = run.integrate(None)
    assert len(times) == 101
    assert np.diff(times) == pytest.approx(0.05)


@pytest.mark.long("more cases of the same kind", keep=2)
@pytest.mark.parametrize(("periods", "requested"), [
    # a spring that bounces for whole periods, as many as there are samples, one less, or half as
    # many; and one whose oscillation excites the angle, which alone is requested
    (128, (0, 1, 2, 3)), (127, (0, 1, 2, 3)), (64, (0, 1, 2, 3)), (40, (1,)),
])  # fmt: skip
def test_an_equilibrium_is_not_mistaken_at_whole_periods(
    periods: int, requested: tuple[int, ...]
) -> None:
    start, params = (4 / 3 + 1e-6, 1e-10, 0, 0), (1, 29.43, 1, 9.81)
    motion = motion_from(ep, start, periods * 2 * pi / 29.43**0.5, params, requested)
    model = Equilibrium.of(motion)
    times = np.linspace(0, motion.duration, 1001)
    error = np.abs(reference(motion, times) - motion.y0)[:, requested].max()
    assert error < model.error_estimate < 2 * error


@pytest.mark.parametrize("offset", [0.1, 0.3])
def test_a_spring_that_bounces_is_not_at_rest(offset: float) -> None:
    start, params = (4 / 3 + offset, 1e-10, 0, 0), (1, 29.43, 1, 9.81)
    with pytest.raises(OutsideDomainError, match="leaves the initial state"):
        Equilibrium.of(motion_from(ep, start, 128 * 2 * pi / 29.43**0.5, params))


def test_a_run_that_ends_early_is_repeated_with_a_tenth_of_the_tolerance(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    settings: list[float] = []

    def estimated(run: IntegrationRun, _: Motion) -> float:
        settings.append(run.setting)
        return np.inf if len(settings) < 3 else 0.0

    monkeypatch.setattr(checked_run, "estimated_error", estimated)
    motion = motion_from(sp, (1.0, 1.0), 5.0)
    checked_run.checked_run(motion, MethodChoice("dp54", "rational", ""), 1e-4, motion)
    assert len(settings) == 3
    assert settings[1:] == pytest.approx([settings[0] / 10, settings[0] / 100])


def test_a_run_is_compared_at_the_ends_and_in_the_middle_of_its_steps() -> None:
    run = IntegrationRun(motion_from(sp, (1.0, 1.0), 5.0), MethodChoice("rk4", "rational", ""), 0.5)
    times = check_times(run)
    assert set(np.arange(0, 5.25, 0.25)) <= set(times)
    assert set(run.motion.sample_times) <= set(times)


@pytest.mark.long("other tests reach its code")
def test_estimates_include_fast_and_rare_events() -> None:
    # through the pivot within a millionth of the time
    narrow = Scene(ep, (1, 10, 1, 0), (2.5, 0.3, 0, 1e-4), 3.0, model="full")
    model = selected(narrow).model
    times = np.linspace(2.18, 2.185, 401)
    truths = taylor(ep, narrow.params, narrow.y0, [0, *times], 30)[1:]
    run = model.run.states(np.array([0, *times, 3.0]))
    assert np.abs(run[1:-1] - truths).max() < 2 * model.error_estimate


def test_next_to_the_separatrix_a_light_bob_has_a_large_effect() -> None:
    near = motion_from(dp, (pi - 1e-9, 1.0, 0, 0), 60.0, (1, 1e-20, 2, 2, 9.81), (0, 2))
    assert PendulumAndLightMasses.of(near).error_estimate > 0.1


def test_a_motion_that_takes_too_long_is_refused_at_once() -> None:
    with pytest.raises(TooLongError, match="shorten the duration"):
        selected(Scene(sp, sp.DEFAULTS, (1.0, 1.0), 1e9, model="full"))


@pytest.mark.parametrize(("error", "reason"), [
    (np.linalg.LinAlgError("DLASCLS"), "its matrices are singular or not finite"),
    (FloatingPointError("overflow"), "its numbers are not finite: overflow"),
])  # fmt: skip
def test_a_model_that_fails_numerically_is_declined_and_the_next_is_tried(
    error: Exception, reason: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(_: Motion) -> NormalModes:
        raise error

    monkeypatch.setattr(NormalModes, "of", fails)
    selection = selected(Scene(sp, sp.DEFAULTS, (1.0, 0.0), 0.1))
    assert selection.declined["normal modes"] == reason
    assert selection.model.name == "pendulum"


def test_a_model_is_selected_exactly_when_its_error_is_below_the_requested_accuracy() -> None:
    scene = find("small", load_module)
    estimate = selected(scene).model.error_estimate
    for share, name in ((1.01, "normal modes"), (0.99, "full equations")):
        assert selected(replace(scene, accuracy=share * estimate)).model.name == name


def test_a_coordinate_without_inertia_has_no_motion() -> None:
    turning = Scene(dp, (1, 0, 2, 2, 0), (0.5, 0, 2.0, 0), 10.0)
    model = selected(turning).model
    assert model.name == "quadrature"
    end = model.states(np.array([10.0]))[0]
    assert end[[0, 2]] == pytest.approx([20.5, 2.0], abs=1e-12)
    assert np.isnan(end[[1, 3]]).all()


def test_scenes_can_name_every_model_and_the_full_equations_come_last() -> None:
    assert [*load()] == [*closed_forms(), "full"]


def test_every_model_is_selected_by_a_scene_that_ships() -> None:
    expected = {
        "rest": "rest",
        "upright": "pendulum",
        "tremor": "normal modes",
        "single": "pendulum",
        "separatrix": "pendulum",
        "rotation": "pendulum",
        "one_bob": "pendulum",
        "flea": "pendulum and light masses",
        "weightless": "quadrature",
        "report": "full equations",
    }
    for name, model in expected.items():
        selection = selected(find(name, load_module))
        assert selection.model.name == model
        # there is a reason against each simpler model
        order = [*closed_forms(), "full equations"]
        assert [*selection.declined] == order[: len(selection.declined)]


def test_the_cheapest_method_is_the_recorded_one() -> None:
    choice = cheapest(dp, dp.DEFAULTS, 1e-9)
    recorded = next(scene for scene in json.loads(RECORD.read_text()) if scene["scene"] == "report")
    row = next(row for row in recorded["frontier"] if row["global_error"] == 1e-9)
    assert (choice.method, choice.form) == (row["method"], row["form"])
    assert choice.method in ("verner853", "verner98", "gauss8")
    assert "as measured in scene 'report'" in choice.why
    assert choice.seconds > 0
    assert mode_spread(dp, dp.DEFAULTS) == pytest.approx(1 + 2**0.5)
    # where one mode is three hundred times as fast, implicit methods win for large errors
    stiff = find("stiff_spring", load_module)
    assert mode_spread(ep, stiff.params) == pytest.approx(319, rel=0.01)
    assert cheapest(ep, stiff.params, 1e-2).method.startswith(("gauss", "radau"))
    assert cheapest(ep, ep.DEFAULTS, 1e-2).method not in ("gauss3", "radau3")


@pytest.mark.parametrize(("method", "form"), [
    ("verner98", "rational"), ("taylor", "rational"), ("gauss2", "lagrangian"),
    ("DOP853", "lagrangian"),
])  # fmt: skip
def test_methods_that_need_a_jacobian_and_those_of_scipy_have_lagrange_s_form(
    method: str, form: str
) -> None:
    assert usual_form(dp, method) == form


def test_an_orbit_is_periodic_apart_from_its_rotation() -> None:
    motion = motion_from(dp, (0.0, 0.5, 2, 2.5), 1.0, (1, 0.3, 2, 1, 0))
    result = orbit(Quadrature.of(motion).orbit.reduced)
    period = 2 * pi * result.time.mean
    first, second = result.states(np.array([0.3, 0.3 + 7 * period]))
    turned = second - first
    assert turned[2:] == pytest.approx([0, 0], abs=1e-10)
    assert turned[0] == pytest.approx(turned[1], abs=1e-10)
    assert 1e-16 < result.period_error < 1e-12
    assert abs(turned[0]) > 1
