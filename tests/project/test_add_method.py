"""A new method is one file: the catalogue, integration, proofs and the table all find it."""

import shutil
from collections.abc import Iterator
from math import exp
from pathlib import Path

import pytest

import generated.single_pendulum as sp
from solvers import integrate
from solvers.app.readme_tables import methods_table
from solvers.runge_kutta import method_catalogue, methods
from solvers.runge_kutta.method_catalogue import load, names
from solvers.runge_kutta.stability_function import StabilityFunction
from solvers.runge_kutta.stepper import Stepper

FILE = '''"""A throw-away pair of orders 2 and 1, 2 stages.

Nobody, Journal of Nothing 1 (1901) 1-2.
"""

from solvers.runge_kutta.tableau import Tableau

tableau = Tableau.explicit("Throw-away 2(1)", rows="3/4", b="1/3 2/3", b_hat="1 0")
'''
#: The implicit midpoint rule twice: stages at one node, between which no polynomial interpolates.
TWICE = '''"""A throw-away method of order 2, implicit, 2 stages.

Nobody, Journal of Nothing 1 (1901) 3-4.
"""

from fractions import Fraction

from solvers.runge_kutta.tableau import Tableau

half = Fraction(1, 2)
tableau = Tableau("Throw-away twice", A=((half, half * 0), (half * 0, half)), b=(half, half))
'''
#: Backends that this machine can run.
BACKENDS = ["python", *(["compiled"] if shutil.which("cc") else [])]


@pytest.fixture
def throwaway(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """The name of a method whose file lies in a temporary folder, beside another one."""
    (tmp_path / "throwaway.py").write_text(FILE)
    (tmp_path / "twice.py").write_text(TWICE)
    monkeypatch.setattr(methods, "__path__", [*methods.__path__, str(tmp_path)])
    yield "throwaway"
    method_catalogue.load.cache_clear()


def test_the_catalogue_finds_it_and_its_properties_follow(throwaway: str) -> None:
    assert throwaway in names()
    method = load(throwaway)
    assert (method.order, method.embedded_order, method.stages) == (2, 1, 2)
    assert StabilityFunction.of(method).real_stability_interval == 2
    end, error, *_ = Stepper(method, lambda t, y: y).step(0.0, [1.0], 0.1, [1.0])
    assert abs(end[0] - exp(0.1)) < 2e-4 < abs(error[0, 0])


@pytest.mark.parametrize("backend", BACKENDS)
def test_it_integrates_with_fixed_and_with_controlled_steps(throwaway: str, backend: str) -> None:
    run = {"t_span": (0, 1), "y0": (1.0, 0.0), "params": sp.DEFAULTS, "backend": backend}
    exact = integrate(sp, **run | {"method": "verner98", "rtol": 1e-12, "atol": 1e-12}).y[:, -1]
    ends = [integrate(sp, **run, method=throwaway, h=h).y[:, -1] for h in (0.002, 0.001)]
    coarse, fine = (abs(end - exact).max() for end in ends)
    assert coarse / fine == pytest.approx(4, rel=0.05)
    controlled = integrate(sp, **run, method=throwaway, rtol=1e-6, atol=1e-6)
    assert abs(controlled.y[:, -1] - exact).max() < 1e-4


def test_an_implicit_one_may_have_coinciding_nodes(throwaway: str) -> None:
    """Against the rule that its stages repeat; as many iterations in compiled code as in Python."""
    run, costs = {"t_span": (0, 4), "y0": (2.0, 0.0), "params": sp.DEFAULTS, "h": 0.1}, []
    for backend in BACKENDS:
        once, twice = (
            integrate(sp, **run, method=name, backend=backend) for name in ("gauss1", "twice")
        )
        assert twice.y == pytest.approx(once.y, abs=1e-9)
        assert twice.nfev < 2 * once.nfev
        costs.append(twice.nfev)
    assert costs == pytest.approx([costs[0]] * len(costs), abs=3)


def test_it_is_in_the_table(throwaway: str) -> None:
    assert "| `throwaway` | Throw-away 2(1) | explicit | 2 | 1 | 2 | 2.00 | 0.00 |" in (
        methods_table().splitlines()
    )
