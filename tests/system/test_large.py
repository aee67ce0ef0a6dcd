"""Large systems: loops factorise matrices, and texts grow with the square of the size."""

from dataclasses import replace
from types import ModuleType

import numpy as np
import pytest
from benchmarks import calls, pipeline
from benchmarks.derivation_timing import chain as chain_in_c
from benchmarks.derivation_timing import mechanics
from numpy.testing import assert_allclose

import generated.double_pendulum as dp
from derive import TIME, Derivation, PointMass, load
from derive.codegen.forms.factorisation import LARGE
from derive.codegen.module_files import files
from derive.codegen.module_functions import contents
from holonomic import build
from solvers.app.modules import load as load_module
from solvers.equations.forms import Form
from solvers.integration.ensemble import ensemble
from solvers.integration.integrate import integrate
from solvers.references.taylor import taylor

N = LARGE + 1


@pytest.fixture(scope="module")
def chain() -> ModuleType:
    """A chain whose pivot moves uniformly: the same equations, without a kinematic tree."""
    still = load(f"chain_{N}")
    masses = [
        PointMass(one.mass, (one.position[0] + TIME, one.position[1])) for one in still.masses
    ]
    return build(replace(still, name="moving_chain", masses=masses))


def state(seed: int) -> tuple[np.ndarray, np.ndarray]:
    random = np.random.default_rng(seed)
    return random.uniform(-3, 3, 2 * N), np.array([*random.uniform(0.5, 2, 2 * N), 9.81])


def textbook(y: np.ndarray, params: np.ndarray) -> np.ndarray:
    """Accelerations from M_ij = μ l_i l_j cos(θ_i - θ_j), with μ the mass below both joints."""
    theta, omega = y[:N], y[N:]
    m, length, g = params[:N], params[N : 2 * N], params[-1]
    below = np.cumsum(m[::-1])[::-1]
    mu = below[np.maximum.outer(np.arange(N), np.arange(N))] * np.outer(length, length)
    delta = np.subtract.outer(theta, theta)
    f = -(mu * np.sin(delta)) @ omega**2 - below * g * length * np.sin(theta)
    return np.linalg.solve(mu * np.cos(delta), f)


def test_loops_solve_the_textbook_equations(chain: ModuleType) -> None:
    assert "_factorised" in chain.rhs.__globals__
    assert "_factorised" not in load_module("chain_3").rhs.__globals__
    for seed in range(3):
        y, params = state(seed)
        expected = textbook(y, params)
        assert_allclose(chain.rhs(0.0, y, params)[N:], expected, rtol=1e-11)
        many = chain.rhs_many(0.0, np.tile(y[:, None], 4), params)
        assert_allclose(many[N:, 2], expected, rtol=1e-11)
        rational = Form(chain, "rational", params)
        assert_allclose(
            rational.rhs(0.0, rational.from_ordinary(0.0, y))[-N:], expected, rtol=1e-11
        )


@pytest.mark.long("derives a chain of many links")
def test_derivatives_and_hamilton_s_form_use_the_loops(chain: ModuleType) -> None:
    y, params = state(5)
    steps = y[:, None] + 1e-30j * np.eye(2 * N)
    expected = chain.rhs_many(0.0, steps, params).imag / 1e-30
    assert_allclose(chain.jacobian(0.0, y, params), expected, rtol=1e-8, atol=1e-8)
    z = chain.hamiltonian_state(0.0, y, params)
    assert_allclose(chain.lagrangian_state(0.0, z, params), y, rtol=1e-11)
    moved = y + 1e-30j * np.array(chain.rhs(0.0, y, params))
    slopes = np.asarray(chain.hamiltonian_state_many(0.0, moved, params)).imag / 1e-30
    assert_allclose(chain.rhs_hamiltonian(0.0, z, params), slopes, rtol=1e-9, atol=1e-9)
    form = Form(chain, "variational", params)
    rates = form.rhs(0.0, form.from_ordinary(0.0, np.array([*y, *np.ones(2 * N)])))
    assert_allclose(rates[-2 * N :], expected @ np.ones(2 * N), rtol=1e-8, atol=1e-8)
    assert not hasattr(chain, "jacobian_hamiltonian")


@pytest.mark.long("compiles a chain of many links")
@pytest.mark.slow
def test_loops_are_compiled_for_one_motion_and_for_lanes(chain: ModuleType) -> None:
    y, params = np.array([*np.linspace(0.3, 0.9, N), *np.zeros(N)]), chain.DEFAULTS
    truth = taylor(chain, params, y.tolist(), [0.0, 0.5], 22)[-1]
    for form in ("lagrangian", "rational"):
        found = integrate(chain, (0, 0.5), y, params, rtol=1e-11, form=form, backend="compiled")
        assert_allclose(found.y[:, -1], truth, atol=1e-9)
        loose = integrate(chain, (0, 0.5), y, params, rtol=1e-4, form=form, backend="compiled")
        assert np.abs(loose.y[:, -1] - truth).max() > 1e-9
    lanes = ensemble(chain, (0, 0.5), np.transpose([y, y * 0.5] * 8), params, rtol=1e-11)
    assert_allclose(lanes.y.T[::2], np.tile(truth, (8, 1)), atol=1e-8)


@pytest.mark.long("derives chains of many links")
@pytest.mark.slow
@pytest.mark.parametrize("larger", [
    LARGE + LARGE // 4,
    pytest.param(2 * LARGE, marks=pytest.mark.campaign),
])  # fmt: skip
def test_texts_grow_no_faster_than_the_square(larger: int) -> None:
    names, sizes = ("rhs", "rhs_rational", "rhs_hamiltonian", "jacobian", "energy"), {}
    for n in (LARGE, larger):
        generated = contents(Derivation(load(f"chain_{n}")), names)
        assert {f.name for f in generated.functions} == {*names}
        sizes[n] = len(files(generated)[f"chain_{n}.py"])
    assert sizes[larger] / sizes[LARGE] < (larger / LARGE) ** 2, sizes


@pytest.mark.long("derives a chain of many links")
def test_a_textbook_s_chain_in_c_gives_the_same_rates() -> None:
    for n in (5, LARGE):
        ours, theirs = calls.single(chain_in_c(n)[-1], n), calls.textbook(n)
        lanes = calls.lanes(chain_in_c(n, "_rational")[-1], n)
        for run in (ours, theirs, lanes):
            run.repetitions = 1
            run()
        assert_allclose(ours.rates, theirs.rates, rtol=1e-11)
        assert np.abs(lanes.rates).max() > 0.1


def test_sympys_mechanics_derives_the_generated_equations() -> None:
    # the benchmark's rivals get the right equations
    found = mechanics(2)
    y, params = (0.3, -1.2, 0.7, 2.1), (1.3, 0.4, 1.1, 0.6, 9.81)
    values = dict(
        zip((*found.coordinates, *found.speeds, *found.constants), (*y, *params), strict=True)
    )
    rates = [float(rate.subs(values)) for rate in found.rates]
    assert rates == pytest.approx(dp.rhs(0.0, y, params), rel=1e-12)


def test_the_pipeline_is_timed_with_the_loosest_sufficient_tolerance() -> None:
    found = pipeline._measured(
        "a program", 0.1, 0.2, lambda tol: lambda: np.add(pipeline.FINAL, 20 * tol)
    )
    assert found.global_error == pytest.approx(2e-10, rel=1e-3)
    assert (found.derivation, found.preparation) == (0.1, 0.2)
    with pytest.raises(ArithmeticError, match="a program does not reach an error of 1e-09"):
        pipeline._measured("a program", 0.1, 0.2, lambda _: lambda: np.add(pipeline.FINAL, 1e-8))


def test_the_pipelines_here_and_with_scipy_reach_the_final_state() -> None:
    ours = pipeline._measured("holonomic", *pipeline._ours(dp, chain_in_c))
    scipy = pipeline._measured("SciPy", *pipeline._scipy(dp, chain_in_c))
    assert 0 < max(ours.global_error, scipy.global_error) < pipeline.ERROR
    lines = list(pipeline.summary([ours, scipy]))
    assert lines[2].endswith("  1.0")
    assert len({len(line) for line in lines[1:]}) == 1
