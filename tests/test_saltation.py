"""Perturbations jump where forces jump, in the variational and in the sensitivity form."""

from functools import cache

import numpy as np
import pytest
import sympy as sp
from test_sliding import belt, friction, slope, stacked

from solvers.equations.module import GeneratedModule
from solvers.integration.ensemble import ensemble
from solvers.integration.integrate import integrate
from solvers.integration.transition_matrix import transition_matrix

BACKENDS = ("python", "compiled")
TIGHT = {"rtol": 1e-13, "atol": 1e-14}


def perturbed(
    module: GeneratedModule, end: float, values: dict[str, float], backend: str
) -> np.ndarray:
    """Derivatives of the end by each of the values, in columns."""
    columns = []
    for name in values:
        given = values | {f"delta_{name}": 1.0}
        start = {n: x for n, x in given.items() if n.removeprefix("delta_") in module.STATE}
        start = dict.fromkeys(module.COORDINATES, 0.0) | start
        params = {n: x for n, x in given.items() if n not in start}
        options = {"form": "sensitivity", "backend": backend, **TIGHT}
        motion = integrate(module, (0, end), start, params, **options)
        columns.append(motion.y[len(module.STATE) :, -1])
    return np.array(columns).T


@cache
def back() -> tuple[sp.Matrix, list[sp.Symbol]]:
    """A block that slides up a slope, and back or not: its position and velocity after 3 s."""
    x, v, alpha, mu = sp.symbols("x x_dot alpha mu")
    up, down = (sp.Rational("9.81") * (sp.sin(alpha) + s * mu * sp.cos(alpha)) for s in (1, -1))
    left = 3 + v / up
    return sp.Matrix([x - v**2 / (2 * up) + down * left**2 / 2, down * left]), [x, v, alpha, mu]


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("mu", [0.5, 0.2])
def test_a_turn_on_a_slope(mu: float, backend: str) -> None:
    end, symbols = back()
    values = {"x": 0.1, "x_dot": -2.0, "alpha": 0.3, "mu": mu}
    if mu == 0.5:  # it stays where it turns
        up = sp.Rational("9.81") * (sp.sin(symbols[2]) + symbols[3] * sp.cos(symbols[2]))
        end = sp.Matrix([symbols[0] - symbols[1] ** 2 / (2 * up), 0])
    exact = end.jacobian(symbols).subs({s: values[s.name] for s in symbols})
    result = perturbed(slope(), 3.0, values, backend)
    assert result == pytest.approx(np.array(exact, float), rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("backend", BACKENDS)
def test_two_functions_that_stay_0(backend: str) -> None:
    F, G, P, t = sp.symbols("F G P t")
    start, apart, left = G / P, (3 * F - G) / (2 * P), sp.Symbol("left")
    speed, place = P * (apart - start) ** 2 / 6, P * (apart - start) ** 3 / 18
    velocity = speed + sp.integrate(P * t - F, (t, apart, apart + left))
    block = place + sp.integrate(velocity.subs(left, t - apart), (t, apart, 4))
    cart = place + speed * left + (F - G) * left**2 / 4
    end = sp.Matrix([block, cart, velocity, speed + (F - G) * left / 2]).subs(left, 4 - apart)
    values = {"F": 2.0, "G": 1.0, "P": 1.0}
    exact = end.jacobian([F, G, P]).subs({F: 2, G: 1, P: 1})
    result = perturbed(stacked(), 4.0, values, backend)
    assert result == pytest.approx(np.array(exact, float), abs=1e-11)


def test_slips_make_a_motion_forget_its_start() -> None:
    # after a phase in which the block moves with the belt, motions differ in time only
    module, times = belt(), np.linspace(0, 30, 301)
    motion = integrate(module, (0, 30), (1.0, 0.4), module.DEFAULTS, t_eval=times, **TIGHT)
    slips = np.flatnonzero(motion.y[1] < 0.2)
    first, last = slips[slips > 50][0], slips[slips > 200][0]
    result = transition_matrix(module, times[[first, last]], motion.y[:, first], {})
    assert result.y == pytest.approx(motion.y[:, last], abs=1e-10)
    rates = [module.rhs(0.0, motion.y[:, k], module.DEFAULTS) for k in (first, last)]
    assert result.matrix @ rates[0] == pytest.approx(rates[1], abs=1e-9)
    assert np.linalg.svd(result.matrix)[1][1] < 1e-10


def test_ensembles_perturb_every_motion() -> None:
    module, n = friction(), 20
    starts = np.zeros((4, n))
    starts[0], starts[2] = np.linspace(-1, 1, n), 1.0
    params = np.stack([np.linspace(0.5, 2.0, n), np.full(n, 0.8)])
    motions = ensemble(module, (0, 9), starts, params, form="variational", **TIGHT)
    for k in range(0, n, 5):
        options = {"form": "variational", "backend": "python", **TIGHT}
        single = integrate(module, (0, 9), starts[:, k], params[:, k], **options)
        assert motions.y[:, k] == pytest.approx(single.y[:, -1], abs=1e-10)
