"""Starts complete themselves: coordinates without effect are 0, lengths at their equilibrium."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import generated.cart_3 as cart
import generated.double_pendulum as dp
import generated.elastic_pendulum as elastic
import generated.heavy_top as top
import generated.swinging_atwood as atwood
from holonomic import build
from solvers import ensemble, integrate, load_scene, prepare


def test_a_length_starts_at_its_equilibrium() -> None:
    # Hooke: the spring carries the weight where k (r - l) = m g
    start = {"theta": 0.3}
    motion = integrate(elastic, (0, 1), start, {"m": 2.0, "k": 50.0, "l": 0.7})
    assert motion.y[0, 0] == pytest.approx(0.7 + 2.0 * 9.81 / 50.0, rel=1e-15)
    run = prepare(elastic, elastic.params(m=2.0, k=50.0, l=0.7))
    assert run((0, 1), start)[0] == pytest.approx(motion.y[0, -1], rel=1e-6)


def test_each_motion_of_an_ensemble_has_its_own_equilibrium() -> None:
    masses = np.array([1.0, 2.0, 3.0])
    motions = ensemble(elastic, (0, 0), {"theta": [0.1, 0.2, 0.3]}, {"m": masses})
    assert motions.y[0] == pytest.approx(1.0 + masses * 9.81 / 100.0, rel=1e-15)
    one = ensemble(elastic, (0, 0), {"theta": [0.1, 0.2]}, {"m": 2.0})
    assert one.y[0] == pytest.approx(1.1962, rel=1e-15)


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize(
    ("module", "start", "free"),
    [
        (cart, {"theta1": 1.0, "theta2": 0.5, "theta3": 0.0}, ["x"]),
        (top, {"theta": 0.5, "psi_dot": 50.0}, ["phi", "psi"]),
    ],
)
def test_a_cyclic_coordinate_starts_at_0(module, start, free: list[str]) -> None:
    motion = integrate(module, (0, 1), start, {})
    explicit = integrate(module, (0, 1), start | dict.fromkeys(free, 0.0), {})
    assert np.array_equal(motion.y, explicit.y)
    rows = [module.STATE.index(name) for name in free]
    assert (motion.y[rows, 0] == 0).all()


def test_a_module_that_is_built_completes_its_starts() -> None:
    from derive import load

    motion = integrate(build(load("elastic_pendulum")), (0, 0.1), {"theta": 0.3}, {})
    assert motion.y[0, 0] == pytest.approx(1.0981, rel=1e-15)


def test_a_coordinate_that_matters_is_missing() -> None:
    with pytest.raises(ValueError, match="y0 lacks theta2, on which the motion depends"):
        integrate(dp, (0, 1), {"theta1": 1.0}, {})
    with pytest.raises(ValueError, match="y0 lacks theta, on which the motion depends"):
        integrate(elastic, (0, 1), {}, {})
    with pytest.raises(ValueError, match=r"y0 lacks r, on which .*motion depends"):
        integrate(atwood, (0, 1), {"theta": 1.0}, {})  # a length, but no equilibrium is known


def test_a_scene_states_what_it_completed(tmp_path: Path) -> None:
    path = tmp_path / "spring.toml"
    path.write_text(
        'system = "elastic_pendulum"\nduration = "1 s"\n[parameters]\nm = "2 kg"\n'
        "[initial]\ntheta = 0.3\n"
    )
    scene = load_scene(path)
    assert scene.y0[0] == pytest.approx(1.1962, rel=1e-15)
    assert scene.completed == "at equilibrium: r = 1.1962 m"
    assert replace(scene, duration=2.0).completed == scene.completed
    path.write_text(
        'system = "cart_3"\nduration = "1 s"\n[initial]\ntheta1 = 1\ntheta2 = 0.5\ntheta3 = 0\n'
    )
    assert load_scene(path).completed == "without effect on accelerations: x = 0"
