"""Python, compiled loops and lanes take the same steps where no angle is reduced."""

import numpy as np
import pytest
import sympy

import generated.duffing as duffing
from holonomic import TIME, Coordinate, PointMass, System, build
from solvers.integration.checks.predictability import ignore_predictability
from solvers.integration.ensemble import ensemble
from solvers.integration.integrate import integrate

#: A fast force, so that rates depend on time from the first step on.
FAST = duffing.params(F=3.0, Omega=20.0)


@pytest.mark.long("more cases of the same kind")
@pytest.mark.parametrize("span", [(0.3, 1.5), (0.3, -0.9)])
@pytest.mark.parametrize("method", ["dp54", "dop853"])
@ignore_predictability()
def test_controlled_steps_of_a_driven_system_are_the_same(
    method: str, span: tuple[float, float]
) -> None:
    start = (0.8, -0.5)
    options = {"method": method, "rtol": 1e-8, "atol": 1e-10}
    python, compiled = (
        integrate(duffing, span, start, FAST, backend=backend, **options)
        for backend in ("python", "compiled")
    )
    assert python.steps > 10
    assert (python.steps, python.rejected) == (compiled.steps, compiled.rejected)
    assert 0 <= compiled.nfev - python.nfev <= 1  # the first derivative may be evaluated again
    assert compiled.t == pytest.approx(python.t, abs=1e-8)  # its logarithms are approximations
    assert compiled.y == pytest.approx(python.y, abs=1e-6)
    lanes = ensemble(duffing, span, np.array([start, (0.1, 0.2), start]).T, FAST, **options)
    for k in (0, 2):
        assert lanes.y[:, k] == pytest.approx(python.y[:, -1], abs=1e-8)
        assert (lanes.steps[k], lanes.nfev[k]) == (compiled.steps, compiled.nfev)


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize("method", ["leapfrog", "leapfrog4"])
@ignore_predictability()
def test_stages_of_splittings_are_at_the_same_times(method: str) -> None:
    x = sympy.Symbol("x", real=True)
    module = build(System("pushed", "", [Coordinate(x, "m", "")], [], [PointMass(1, (x, 0))],
        potential=x**2 / 2, forces=[sympy.cos(5 * TIME)]))  # fmt: skip
    options = {"method": method, "h": 0.05}
    python, compiled = (
        integrate(module, (0.3, 1.5), (0.8, -0.5), (), backend=backend, **options)
        for backend in ("python", "compiled")
    )
    assert compiled.y == pytest.approx(python.y, abs=1e-13)
    lanes = ensemble(module, (0.3, 1.5), np.array([[0.8], [-0.5]]), (), **options)
    assert lanes.y[:, 0] == pytest.approx(python.y[:, -1], abs=1e-13)
