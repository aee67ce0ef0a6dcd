"""Perturbations jump where forces jump, in the variational and in the sensitivity form."""

import numpy as np
import pytest
import sympy as sp
from friction import BELT, block, stacked

from solvers.equations.module import GeneratedModule
from solvers.integration.ensemble import ensemble
from solvers.integration.integrate import integrate
from solvers.integration.variations.transition_matrix import transition_matrix

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


@pytest.mark.long("more cases of the same kind", keep=2)
@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("friction", [4.0, 2.0])
def test_a_turn_on_a_slope(friction: float, backend: str) -> None:
    # the block slides up with W + F, stays if F > W, or slides back with W - F
    x, v, W, F = symbols = sp.symbols("x x_dot W F")
    up, down, left = W + F, W - F, 3 + v / (W + F)
    height = x - v**2 / (2 * up)
    end = sp.Matrix([height, 0])
    if friction == 2:
        end += down * sp.Matrix([left**2 / 2, left])
    values = {"x": 0.1, "x_dot": -2.0, "W": 3.0, "F": friction}
    exact = end.jacobian(symbols).subs({s: values[s.name] for s in symbols})
    result = perturbed(block(), 3.0, values, backend)
    assert result == pytest.approx(np.array(exact, float), rel=1e-12, abs=1e-12)


@pytest.mark.long("more cases of the same kind", keep=1)
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


@pytest.mark.long("other tests reach its code")
def test_slips_make_a_motion_forget_its_start() -> None:
    # after a phase in which the block moves with the belt, motions differ in time only
    module, times = block(), np.linspace(0, 30, 301)
    motion = integrate(module, (0, 30), (1.0, 0.4), BELT, t_eval=times, **TIGHT)
    slips = np.flatnonzero(motion.y[1] < 0.2)
    first, last = slips[slips > 50][0], slips[slips > 200][0]
    result = transition_matrix(module, times[[first, last]], motion.y[:, first], BELT)
    assert result.y == pytest.approx(motion.y[:, last], abs=1e-10)
    rates = [module.rhs(0.0, motion.y[:, k], module.params(**BELT)) for k in (first, last)]
    assert result.matrix @ rates[0] == pytest.approx(rates[1], abs=1e-9)
    assert np.linalg.svd(result.matrix)[1][1] < 1e-10


def test_ensembles_perturb_every_motion() -> None:
    module, n = block(), 20
    starts = np.zeros((4, n))
    starts[0], starts[2] = np.linspace(-1, 1, n), 1.0
    drives = np.linspace(0.5, 2.0, n)
    options = {"form": "variational", **TIGHT}
    motions = ensemble(module, (0, 9), starts, {"P": drives, "F": 0.8}, **options)
    for k in range(0, n, 5):
        own = {"P": drives[k], "F": 0.8}
        single = integrate(module, (0, 9), starts[:, k], own, backend="python", **options)
        assert motions.y[:, k] == pytest.approx(single.y[:, -1], abs=1e-10)
