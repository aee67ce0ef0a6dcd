"""What several tests look at."""

from importlib import import_module
from types import ModuleType

import pytest
import sympy as sp

from derive import Derivation, load, names


@pytest.fixture(scope="session", params=names())
def derivation(request: pytest.FixtureRequest) -> Derivation:
    return Derivation(load(request.param))


@pytest.fixture(scope="session")
def module(derivation: Derivation) -> ModuleType:
    return import_module(f"generated.{derivation.system.name}")


@pytest.fixture(scope="session")
def double() -> Derivation:
    return Derivation(load("double_pendulum"))


@pytest.fixture(scope="session")
def motion(derivation: Derivation) -> dict[sp.Symbol, sp.Expr]:
    """Accelerations by coordinates and velocities, solved by SymPy from the residuals."""
    system = derivation.system
    solution = sp.solve(list(derivation.euler_lagrange), system.qddot, dict=True)
    return dict(solution[0])
