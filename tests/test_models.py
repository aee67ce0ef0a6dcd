"""Models of a motion: each is exact about its own domain, its error below its estimate."""

from collections import Counter
from dataclasses import replace
from functools import partial
from math import pi

import numpy as np
import pytest
from sharing import Shared

import generated.double_pendulum as dp
import generated.elastic_pendulum as ep
import generated.single_pendulum as sp
from solvers.app.modules import load as load_module
from solvers.equations.normal_modes import mode_spread
from solvers.integration.integrate import integrate
from solvers.integration.predictability import ignore_predictability
from solvers.references.taylor import taylor
from solvers.scenes.models import equilibrium as at_rest
from solvers.scenes.models import full_equations as full_equations
from solvers.scenes.models import normal_modes as by_modes
from solvers.scenes.models import quadrature as by_quadrature
from solvers.scenes.models.equilibrium import rest
from solvers.scenes.models.full_equations import NotAccurateError, TooLongError, full
from solvers.scenes.models.light_masses import light
from solvers.scenes.models.method_choice import MethodChoice, cheapest
from solvers.scenes.models.model import Motion, OutsideDomainError
from solvers.scenes.models.normal_modes import small
from solvers.scenes.models.pendulum import pendulum
from solvers.scenes.models.quadrature import orbit, quadrature
from solvers.scenes.models.selection import RUNGS, ModelSelection, select_model
from solvers.scenes.scene import MODELS, Scene
from solvers.scenes.shipped import find

Array = np.ndarray


def asked(module, y0, duration, params=None, wanted=None) -> Motion:
    params = tuple(params or module.DEFAULTS)
    return Motion(module, params, tuple(y0), duration, wanted or tuple(range(len(y0))))


def chosen(scene: Scene) -> ModelSelection:
    return select_model(scene, lambda asked, _: asked, lambda _: None)


def truth(motion: Motion, times: Array, digits: int = 24) -> Array:
    return taylor(motion.module, motion.params, motion.y0, times, digits)


def worst(motion: Motion, model, digits: int = 24) -> float:
    """The largest error of what is wanted, beside Taylor series."""
    apart = np.abs(model.states(motion.looks) - truth(motion, motion.looks, digits))
    return float(apart[:, list(motion.wanted)].max())


def random_scene(random: np.random.Generator) -> Scene:
    """A scene of any kind: at rest or nearly, small, without gravity, with a light bob, or wild."""
    module = (dp, sp, ep)[random.integers(3)]
    n = len(module.COORDINATES)
    params = np.array(module.DEFAULTS) * np.exp(random.uniform(-1, 1, len(module.PARAMETERS)))
    y0, outputs = np.zeros(2 * n), module.STATE
    kind = random.choice(["still", "small", "weightless", "light", "wild"])
    duration = 10 ** random.uniform(-1, 1.3)
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
        module, tuple(params), tuple(y0), duration,
        accuracy=10 ** random.uniform(-10, -2), outputs=outputs,
    )  # fmt: skip


def judged(scene: Scene) -> tuple[str, float]:
    """Model, and error relative to the requested accuracy."""
    found = chosen(scene).model
    motion = Motion(scene.module, scene.params, scene.y0, scene.duration, scene.wanted)
    with ignore_predictability():
        fine = integrate(
            scene.module, (0, scene.duration), scene.y0, scene.params, method="verner98",
            rtol=3e-14, atol=1e-16, t_eval=motion.looks, max_steps=10**7,
        ).y.T  # fmt: skip
    error = np.abs(found.states(motion.looks) - fine)[:, list(scene.wanted)].max()
    if error > min(scene.accuracy, found.error_estimate):  # or it is the reference that is wrong
        error = worst(motion, found, digits=40)
    return found.name, error / scene.accuracy


#: Random scenes are judged in so many parts, which workers share.
PARTS = 4


def judged_part(part: int) -> list[tuple[str, float]]:
    """Models and errors, relative to the accuracy, of some of 60 random scenes."""
    random = np.random.default_rng(5)
    scenes = [random_scene(random) for _ in range(60)]
    return [judged(scene) for scene in scenes[part::PARTS]]


@pytest.mark.slow
@pytest.mark.parametrize("part", range(PARTS))
def test_in_random_scenes_the_error_stays_below_the_accuracy(part: int, shared: Shared) -> None:
    results = shared(f"random_scenes_{part}", partial(judged_part, part))
    assert len(results) == 60 // PARTS
    assert all(error <= 1 for _, error in results), results


def test_random_scenes_use_every_model(shared: Shared) -> None:
    parts = [shared(f"random_scenes_{part}", partial(judged_part, part)) for part in range(PARTS)]
    count = Counter(model for part in parts for model, _ in part)
    assert set(count) == {"rest", "normal modes", "pendulum", "quadrature", "full equations"}
    assert min(count.values()) >= 2


def test_rest_is_an_equilibrium_and_what_grows_from_it() -> None:
    hanging = rest(asked(dp, (0, 0, 0, 0), 1000))
    assert hanging.error_estimate == 0
    assert hanging.states(np.array([0.0, 7.0])).tolist() == [[0] * 4] * 2
    # the number next to pi is not upright: that is rest for a while, and no longer
    for duration, least, most in ((1, 1e-16, 1e-13), (5, 1e-13, 1e-10), (14, 1e-4, 1e-1)):
        motion = asked(sp, (pi, 0.0), duration)
        found = rest(motion)
        assert least < found.error_estimate < most
        assert worst(motion, found) <= found.error_estimate < 40 * worst(motion, found)
    with pytest.raises(OutsideDomainError, match="moves away"):
        rest(asked(sp, (pi, 0.0), 40))
    with pytest.raises(OutsideDomainError, match="moves at the beginning"):
        rest(asked(sp, (0.0, 1e-9), 1))


def test_small_motion_is_its_modes_up_to_the_nonlinear_terms() -> None:
    for module, shift in ((sp, [0.01]), (dp, [0.004, -0.001]), (ep, [0.001, 0.004])):
        n = len(shift)
        start = np.array([*module.equilibrium(module.DEFAULTS), *[0.0] * n])
        start[:n] += shift
        motion = asked(module, start.tolist(), 20.0)
        found = small(motion)
        error = worst(motion, found)
        # a bound, and no loose one: within a factor of ten for pendulums
        assert error < found.error_estimate < (10 if module is not ep else 1000) * error
    assert small(asked(dp, (1.0, 1.0, 0, 0), 20.0)).error_estimate > 1e3
    with pytest.raises(OutsideDomainError, match="does not oscillate"):
        small(asked(sp, (0.1, 0), 1.0, params=(1, 2, 0.0)))


@pytest.mark.parametrize(("params", "y0", "duration"), [
    ((1, 2, 9.81), (2.0, 0.0), 60),
    ((1, 2, 9.81), (0.0, 10.0), 60),  # over and over
    ((1, 1, 9.0), (0.0, 6.0), 5),  # on the separatrix
    ((1, 1, 9.0), (0.0, 6.0 - 1e-12), 5),
    ((1, 2, -9.81), (pi - 2.0, 0.5), 60),  # upside down
])  # fmt: skip
def test_a_single_pendulum_has_a_closed_form(params, y0, duration) -> None:
    motion = asked(sp, y0, duration, params)
    found = pendulum(motion)
    assert found.error_estimate < 1e-6
    assert worst(motion, found) <= found.error_estimate


def test_near_the_separatrix_rounding_is_not_taken_lightly() -> None:
    for duration in (5, 8, 10, 12):
        motion = asked(sp, (0.0, 6.0 - 1e-12), duration, (1, 1, 9.0))
        found = pendulum(motion)
        assert worst(motion, found) <= found.error_estimate
    assert found.error_estimate > 1e-3


def test_what_is_absent_leaves_a_single_pendulum() -> None:
    for absent, length in (((1, 0, 2, 2, 9.81), 2.0), ((1, 1, 2, 0, 9.81), 2.0)):
        found = pendulum(asked(dp, (2.0, 1.0, 0.5, 0.0), 10, absent, (0, 2)))
        single = asked(sp, (2.0, 0.5), 10, (1, length, 9.81))
        states = found.states(single.looks)
        assert np.abs(states[:, [0, 2]] - truth(single, single.looks)).max() < 1e-12
        assert np.isnan(states[:, [1, 3]]).all()
    with pytest.raises(OutsideDomainError, match="theta2 moves no mass"):
        rest(asked(dp, (0, 0, 0, 0), 1, (1, 0, 2, 2, 9.81)))
    with pytest.raises(OutsideDomainError, match="2 coordinates move"):
        pendulum(asked(dp, (2.0, 1.0, 0, 0), 1))


def test_a_light_bob_does_not_act_but_a_heavy_one_does() -> None:
    params = (1.0, 1e-9, 2.0, 2.0, 9.81)
    motion = asked(dp, (1.5, 0.3, 0, 1), 3, params, (0, 2))
    found = light(motion)
    assert 0 < worst(motion, found) < found.error_estimate < 1e-3
    heavy = light(asked(dp, (1.5, 0.3, 0, 1), 3, (1.0, 1e-2, 2.0, 2.0, 9.81), (0, 2)))
    assert heavy.error_estimate > 1
    with pytest.raises(OutsideDomainError, match="2 of 2 coordinates are wanted"):
        light(asked(dp, (1.5, 0.3, 0, 1), 3, params))


@pytest.mark.parametrize(("module", "params", "y0"), [
    (dp, (1, 1, 2, 2, 0), (0, 1.5, 2, -3)),  # the shape turns over
    (dp, (1, 0.3, 2, 1, 0), (0, 0.5, 2, 2.5)),  # it swings
    (dp, (1, 0.3, 2, 1, 0), (0.4, 0.5, 0, 2.5)),
    (ep, (1, 40, 0.75, 0), (1.0, 0.3, 0.5, 2.0)),
    (ep, (1, 40, 0.75, 0), (1.0, 0.3, 0.0, 2.0)),  # begins at a turning point
    (sp, (1, 2, 9.81), (1.0, 2.0)),
])  # fmt: skip
def test_one_degree_of_freedom_is_a_quadrature(module, params, y0) -> None:
    motion = asked(module, y0, 30.0, params)
    found = quadrature(motion)
    assert found.error_estimate < 1e-8
    assert worst(motion, found) <= found.error_estimate
    # at any time, and far away at no further cost
    later = asked(module, y0, 1000.0, params)
    end = quadrature(later).states(np.array([1000.0]))
    with ignore_predictability():
        run = integrate(module, (0, 1000), y0, params, method="verner98", rtol=1e-13, atol=1e-14)
    assert np.abs(end - run.y[:, -1]).max() < 1e-6


def test_quadrature_knows_where_it_ends() -> None:
    with pytest.raises(OutsideDomainError, match="turning the whole system changes its energy"):
        quadrature(asked(dp, (0, 1, 2, 3), 1))
    with pytest.raises(OutsideDomainError, match="no Fourier series"):  # on the separatrix
        quadrature(asked(dp, (0, pi / 2, 2, -1), 1, (1, 1, 2, 2, 0)))
    with pytest.raises(OutsideDomainError, match="rests"):
        quadrature(asked(dp, (0, 1, 0, 0), 1, (1, 1, 2, 2, 0)))
    with pytest.raises(OutsideDomainError, match="runs into a singular place"):
        quadrature(asked(ep, (1.0, 0, 3.0, 0), 1, (1, 1e-9, 1, 0)))


def test_a_smaller_series_is_less_accurate_and_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    motion = asked(dp, (0, 1.5, 2, -1.3), 30.0, (1, 1, 2, 2, 0))
    fine = quadrature(motion)
    monkeypatch.setattr(by_quadrature, "END", 1e-3)
    monkeypatch.setattr(by_quadrature, "FEWEST", 8)
    rough = quadrature(motion)
    assert len(rough.orbit.time.terms) < len(fine.orbit.time.terms)
    assert 1e-7 < worst(motion, rough) <= rough.error_estimate


def test_estimates_are_not_for_free(monkeypatch: pytest.MonkeyPatch) -> None:
    # without the defect's propagation the small model would claim too much
    motion = asked(dp, (0.005, -0.002, 0, 0), 20.0)
    monkeypatch.setattr(by_modes, "MARGIN", 0.0)
    assert small(motion).error_estimate < worst(motion, small(motion))
    motion = asked(sp, (pi, 0.0), 14)
    monkeypatch.setattr(at_rest, "expm", lambda matrix: np.eye(matrix.shape[-1]) + matrix)
    assert rest(motion).error_estimate < worst(motion, rest(motion))


def test_the_full_equations_are_checked_by_another_method() -> None:
    scene = find("report", load_module)
    motion = Motion(dp, scene.params, scene.y0, scene.duration, scene.wanted)
    found = chosen(scene).model
    error = worst(motion, found)
    assert error <= found.error_estimate <= scene.accuracy
    assert found.error_estimate < 100 * error
    # a check of the run by itself would find nothing
    choice = MethodChoice("verner98", "rational", "")
    assert full(motion, 1e-3, choice, motion, 1e-6).error_estimate > 1e-9
    assert set(full_equations.CHECKS) == {"dop853", "verner98"}


@pytest.mark.slow
def test_where_numbers_have_too_few_digits_series_have_more() -> None:
    scene = find("long", load_module)
    found = chosen(scene)
    assert found.model.method_choice.method == "taylor"
    assert "at best where 1e-09 was asked" in found.declined["ordinary numbers"]
    end = found.model.states(np.array([20.0]))[0]
    fine = taylor(dp, scene.params, scene.y0, [0, 20], 60)[-1]
    assert np.abs(end - fine).max() <= found.model.error_estimate < 1e-13
    with pytest.raises(NotAccurateError, match="dop853 comes to"):
        chosen(replace(scene, method="dop853"))


def test_the_choice_can_be_named_instead() -> None:
    still = find("rest", load_module)
    assert chosen(still).model.name == "rest"
    assert chosen(replace(still, model="full")).model.name == "full equations"
    named = chosen(replace(find("report", load_module), method="rk4", step=0.01)).model
    assert (named.method_choice.method, named.setting) == ("rk4", 0.01)
    assert worst(named.asked, named) < named.error_estimate < 3 * worst(named.asked, named)
    for method in ("rk4", "gauss3"):  # steps that are fixed are found, too
        fixed = chosen(replace(find("report", load_module), method=method, accuracy=1e-6)).model
        assert worst(fixed.asked, fixed) <= fixed.error_estimate <= 1e-6
    # a small model that is not good enough can be looked at, with its error
    wide = replace(find("single", load_module), y0=(0.1, 0.0), model="normal modes")
    linear = chosen(wide).model
    assert linear.name == "normal modes"
    assert wide.accuracy < worst(asked(sp, wide.y0, 10.0), linear) < linear.error_estimate
    absent = replace(find("one_bob", load_module), model="full")
    with pytest.raises(OutsideDomainError, match="theta2 moves no mass"):
        chosen(absent)


@pytest.mark.parametrize(("offset", "periods", "wanted"), [
    # a spring that bounces for whole periods, as many as there are looks or half as many; and
    # one whose bouncing makes it swing, of which the swing alone is wanted
    (0.3, 64, (0, 1, 2, 3)), (0.3, 128, (0, 1, 2, 3)), (0.1, 40, (1,)),
])  # fmt: skip
def test_rest_is_not_fooled_by_whole_periods(
    offset: float, periods: int, wanted: tuple[int, ...]
) -> None:
    start, params = (4 / 3 + offset, 1e-10, 0, 0), (1, 29.43, 1, 9.81)
    motion = asked(ep, start, periods * 2 * pi / 29.43**0.5, params, wanted)
    try:
        found = rest(motion)
    except OutsideDomainError:
        return
    assert worst(motion, found) < found.error_estimate


def test_estimates_see_what_is_quick_and_rare() -> None:
    # through the pivot within a millionth of the time
    narrow = Scene(ep, (1, 10, 1, 0), (2.5, 0.3, 0, 1e-4), 3.0, model="full")
    found = chosen(narrow).model
    times = np.linspace(2.18, 2.185, 401)
    truths = taylor(ep, narrow.params, narrow.y0, [0, *times], 30)[1:]
    run = full_equations.run(
        found.asked, found.method_choice, found.setting, np.array([0, *times, 3.0])
    )
    assert np.abs(run[1:-1] - truths).max() < 2 * found.error_estimate


def test_a_light_bob_next_to_the_separatrix_is_not_taken_lightly() -> None:
    near = asked(dp, (pi - 1e-9, 1.0, 0, 0), 60.0, (1, 1e-20, 2, 2, 9.81), (0, 2))
    assert light(near).error_estimate > 0.1


def test_what_takes_too_long_is_refused_at_once() -> None:
    with pytest.raises(TooLongError, match="shorten the duration"):
        chosen(Scene(sp, sp.DEFAULTS, (1.0, 1.0), 1e9, model="full"))


def test_a_model_is_taken_when_its_error_is_below_what_is_asked_and_not_before() -> None:
    scene = find("small", load_module)
    estimate = chosen(scene).model.error_estimate
    for share, name in ((1.01, "normal modes"), (0.99, "full equations")):
        assert chosen(replace(scene, accuracy=share * estimate)).model.name == name


def test_what_moves_no_mass_has_no_motion() -> None:
    turning = Scene(dp, (1, 0, 2, 2, 0), (0.5, 0, 2.0, 0), 10.0)
    found = chosen(turning).model
    assert found.name == "quadrature"
    end = found.states(np.array([10.0]))[0]
    assert end[[0, 2]] == pytest.approx([20.5, 2.0], abs=1e-12)
    assert np.isnan(end[[1, 3]]).all()


def test_every_rung_can_be_named() -> None:
    assert {*MODELS} == {"full", *RUNGS}


def test_every_rung_is_taken_by_a_scene_that_ships() -> None:
    expected = {
        "rest": "rest", "upright": "pendulum", "tremor": "normal modes", "single": "pendulum",
        "separatrix": "pendulum", "rotation": "pendulum", "one_bob": "pendulum",
        "flea": "pendulum", "weightless": "quadrature", "report": "full equations",
    }  # fmt: skip
    for name, model in expected.items():
        found = chosen(find(name, load_module))
        assert found.model.name == model
        # each smaller model says why not
        order = [*RUNGS, "full equations"]
        assert [*found.declined] == order[: len(found.declined)]


def test_the_cheapest_way_is_what_was_measured() -> None:
    choice = cheapest(dp, dp.DEFAULTS, 1e-9)
    assert (choice.method, choice.form) == ("verner87", "rational")
    assert "as measured in scene 'report'" in choice.why
    assert choice.seconds > 0
    assert mode_spread(dp, dp.DEFAULTS) == pytest.approx(1 + 2**0.5)
    # where one mode is three hundred times as fast, implicit methods win for large errors
    stiff = find("stiff_spring", load_module)
    assert mode_spread(ep, stiff.params) == pytest.approx(319, rel=0.01)
    assert cheapest(ep, stiff.params, 1e-2).method.startswith(("gauss", "radau"))
    assert cheapest(ep, ep.DEFAULTS, 1e-2).method not in ("gauss3", "radau3")


def test_an_orbit_is_periodic_but_for_its_turn() -> None:
    motion = asked(dp, (0.0, 0.5, 2, 2.5), 1.0, (1, 0.3, 2, 1, 0))
    found = orbit(quadrature(motion).orbit.form)
    period = 2 * pi * found.time.mean
    first, second = found.states(np.array([0.3, 0.3 + 7 * period]))
    turned = second - first
    assert turned[2:] == pytest.approx([0, 0], abs=1e-10)
    assert turned[0] == pytest.approx(turned[1], abs=1e-10)
    assert abs(turned[0]) > 1
