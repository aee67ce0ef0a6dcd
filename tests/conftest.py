"""What several tests look at."""

from importlib import import_module
from types import ModuleType

import pytest
import sympy as sp

from derive import Derivation, load, names
from solvers.cli import generated_module
from solvers.commands.stability import scene_steps
from solvers.scenes.shipped import find
from solvers.stability.critical import CriticalStep


@pytest.fixture(scope="session", params=names())
def derivation(request: pytest.FixtureRequest) -> Derivation:
    return Derivation(load(request.param))


@pytest.fixture(scope="session")
def module(derivation: Derivation) -> ModuleType:
    return import_module(f"generated.{derivation.system.name}")


@pytest.fixture(scope="session")
def report_steps() -> dict[str, CriticalStep]:
    """Every method's critical step for the report's scene."""
    return {step.method: step for step in scene_steps(find("report", generated_module))}


@pytest.fixture(scope="session")
def double() -> Derivation:
    return Derivation(load("double_pendulum"))


@pytest.fixture(scope="session")
def motion(derivation: Derivation) -> dict[sp.Symbol, sp.Expr]:
    """Accelerations by coordinates and velocities, solved by SymPy from the residuals."""
    system = derivation.system
    solution = sp.solve(list(derivation.euler_lagrange), system.qddot, dict=True)
    return dict(solution[0])
