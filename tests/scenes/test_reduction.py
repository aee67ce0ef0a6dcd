"""A cyclic coordinate leaves one degree of freedom, and models are declined for true reasons."""

import numpy as np
import pytest
import sympy as sp

import generated.double_pendulum as dp
import generated.foucault_pendulum as foucault
import generated.spherical_pendulum as spherical
import generated.swinging_atwood as atwood
from derive import Coordinate, Parameter, PointMass, System
from solvers.app.modules import build
from solvers.app.modules import load as load_module
from solvers.integration.accuracy.checked_motion import Motion, OutsideDomainError
from solvers.references.taylor import taylor
from solvers.scenes.models.one_degree_of_freedom import ReducedMotion
from solvers.scenes.models.quadrature import Quadrature
from solvers.scenes.scene import Scene
from solvers.scenes.selection import select_model


def motion_from(module, y0, duration: float) -> Motion:
    return Motion(module, module.DEFAULTS, tuple(y0), duration, tuple(range(len(y0))))


def declined(scene: Scene) -> dict[str, str]:
    return select_model(scene, lambda motion, _: motion, lambda _: None).declined


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize(("module", "y0"), [
    (spherical, (1.0, 0.3, 0.2, 1.5)),
    (spherical, (-0.8, 2.0, 0.5, -3.0)),
    (spherical, (2.0, 0.0, 0.0, 1.5)),  # starts at a turning point
    (spherical, (1.0, 0.3, 0.2, 0.0)),  # in a plane, through the pole of its angles
    (load_module("cart_1"), (0.2, 1.0, 0.3, -0.5)),
    (load_module("cart_1"), (0.0, 3.0, 0.0, 2.0)),  # the pendulum rotates
])  # fmt: skip
def test_a_cyclic_coordinate_leaves_a_quadrature(module, y0) -> None:
    motion = motion_from(module, y0, 20.0)
    model = Quadrature.of(motion)
    exact = taylor(module, motion.params, motion.y0, motion.sample_times, 24)
    error = np.abs(model.states(motion.sample_times) - exact).max()
    assert error <= model.error_estimate < 1e-8
    scene = Scene(module, motion.params, motion.y0, 20.0, accuracy=1e-8)
    assert select_model(scene, lambda m, _: m, lambda _: None).model.name == "quadrature"


def test_the_momentum_of_a_cyclic_coordinate_is_that_of_the_derivation() -> None:
    reduced = ReducedMotion.of(motion_from(spherical, (1.0, 0.3, 0.2, 1.5), 1.0))
    assert reduced.momentum == pytest.approx(np.sin(1.0) ** 2 * 1.5, rel=1e-14)
    assert (reduced.shape.tolist(), reduced.rotation.tolist()) == ([1, 0], [0, 1])


def test_a_coordinate_is_cyclic_where_the_energy_is_not_a_number_everywhere() -> None:
    # a bead in a bowl of 1 m on a cart: no position is farther from the middle
    x, w = sp.symbols("x w", real=True)
    masses = [PointMass(2, (x, 0)), PointMass(1, (x + w, -sp.sqrt(1 - w**2)))]
    coordinates = [Coordinate(one, "m", "position") for one in (x, w)]
    g = Parameter(sp.Symbol("g", positive=True), "m/s^2", 9.81, "gravity")
    bowl = build(System("bowl", "", coordinates, [g], masses))
    with np.errstate(invalid="ignore"):
        reduced = ReducedMotion.of(motion_from(bowl, (0.2, 0.3, 0.5, -0.4), 1.0))
    assert (reduced.shape.tolist(), reduced.rotation.tolist()) == ([0, 1], [1, 0])
    assert reduced.momentum == pytest.approx(2 * 0.5 + (0.5 - 0.4), rel=1e-14)


def test_a_barrier_at_a_pole_is_not_overlooked_however_narrow_it_is() -> None:
    for rate in (1e-3, 1e-6, 1e-9, 1e-13):  # the barrier is that narrow
        motion = motion_from(spherical, (1.0, 0.3, 0.2, rate), 5.0)
        with pytest.raises(OutsideDomainError, match=r"no Fourier series|too close to a pole"):
            Quadrature.of(motion)


def test_a_coordinate_of_a_light_mass_is_not_cyclic() -> None:
    for mass in (1e-13, 1e-16, 1e-20):
        params = (1.0, mass, 2.0, 2.0, 9.81)
        with pytest.raises(OutsideDomainError, match="no coordinate is cyclic"):
            Quadrature.of(Motion(dp, params, (1.0, 0.5, 0, 0), 1.0, (0, 1, 2, 3)))


def test_models_are_declined_for_true_reasons_where_there_are_no_linear_equations() -> None:
    swinging = declined(Scene(atwood, atwood.DEFAULTS, (1.0, 0.5, 0, 0), 1.0))
    assert swinging["normal modes"] == "no equilibrium is known"
    assert swinging["pendulum"] == "2 coordinates have inertia"
    assert swinging["quadrature"].startswith("no coordinate is cyclic")
    turning = declined(Scene(foucault, foucault.DEFAULTS, (1.0, 0, 0, 0), 10.0))
    assert turning["pendulum"] == "2 coordinates have inertia"
    assert turning["quadrature"] == "gyroscopic forces act"
    hanging = declined(Scene(spherical, spherical.DEFAULTS, (1.0, 0, 0, 1.0), 1.0))
    reason = "the mass matrix is not positive definite at the equilibrium"
    assert hanging["normal modes"].endswith(reason)
