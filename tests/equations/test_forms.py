"""Forms of the equations of motion: their parameters, and signs of friction that are held."""

import numpy as np
import pytest
import sympy as sp
from friction import BELT, block

import generated.double_pendulum as dp
import generated.four_bar as four_bar
from derive import Coordinate, Parameter, PointMass, System
from solvers.app.modules import build
from solvers.equations.forms import Form
from solvers.equations.singularities import condition_of_constraints

PARAMS = tuple(dp.DEFAULTS)


def test_parameters_are_not_perturbed_in_another_form() -> None:
    form = Form(dp, "lagrangian", PARAMS)
    sensitive = form.in_form("sensitivity")
    assert sensitive.params == (*[0.0] * len(PARAMS), *PARAMS)
    assert sensitive.constants == sensitive.in_form("rational").params == PARAMS


@pytest.mark.parametrize(("sign", "acceleration"), [
    # K x and the friction F (1 - c |V - v|) sgn(V - v) on a belt with the velocity V = 0.4
    (1.0, -0.3 + 1.0 * (1 - 0.2 * 0.3)), (-1.0, -0.3 - 1.0 * (1 - 0.2 * 0.3)), (0.0, 0.0),
])  # fmt: skip
def test_held_signs_decide_the_friction(sign: float, acceleration: float) -> None:
    module = block()
    params = [BELT.get(name, 0.0) for name in module.PARAMETERS]
    velocity = (
        0.4 if sign == 0 else 0.4 - 0.3 * sign
    )  # a block that stays on the belt moves with it
    form = Form(module, "lagrangian", params).with_signs((sign,))
    rates = form.rhs(0.0, np.array([0.3, velocity]))
    assert rates == pytest.approx([velocity, acceleration], abs=1e-15)


def test_no_condition_is_found_where_the_inertia_is_no_number() -> None:
    params = four_bar.DEFAULTS
    state = [0.5] * len(four_bar.STATE)
    condition, weakest = condition_of_constraints(four_bar, params, state, 0.0)
    assert condition >= 1
    assert weakest
    heavy = [float("inf") if name == "m1" else p
             for name, p in zip(four_bar.PARAMETERS, params, strict=True)]  # fmt: skip
    with np.errstate(invalid="ignore"):
        assert condition_of_constraints(four_bar, heavy, state, 0.0) == (0.0, "")


def test_more_constraints_than_coordinates_depend_on_each_other_everywhere() -> None:
    # two points, at each of which two of the constraints lock the mass
    x, y = sp.symbols("x y", real=True)
    m = sp.Symbol("m", positive=True)
    q = [Coordinate(s, "m", "position") for s in (x, y)]
    locked = build(
        System(
            "locked",
            "",
            q,
            [Parameter(m, "kg", 1, "mass")],
            [PointMass(m, (x, y))],
            potential=0,
            constraints=[x * (x - 1), y * (1 - x), x * y],
        )
    )
    assert len(locked.RESIDUALS) == 2 * 3
    condition, weakest = condition_of_constraints(locked, [1.0], [0.6, 0.8, 0.0, 0.0], 0.0)
    assert condition == float("inf")
    assert weakest in locked.RESIDUALS
