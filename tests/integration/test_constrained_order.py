"""The order of every method with constraints, in decimal numbers, and loops in doubles beside them.

In doubles, rounding errors hide the order of many methods before steps are short enough for it: of
those of high order, and of those with small leading errors, such as tsit54.
"""

from collections.abc import Callable, Iterator
from decimal import Decimal, localcontext
from fractions import Fraction
from functools import cache, cached_property
from typing import Any

import numpy as np
import pytest
from constrained_systems import lifted
from linkages import four_bar, slider_crank
from velocity_constraints import yoke

from derive import System
from holonomic import build, integrate
from solvers.equations.consistent_start import consistent_start
from solvers.equations.forms import Form, fastest_form
from solvers.equations.module import with_functions
from solvers.references.decimal_numbers import decimal_state, sine_and_cosine, with_exact_literals
from solvers.references.taylor import DecimalProjection, decimal_motion
from solvers.runge_kutta.method_catalogue import load, names
from solvers.runge_kutta.surd import Surd
from solvers.runge_kutta.tableau import Tableau

DIGITS = 50
#: Fewest steps with errors of the asymptotic range, by order. Explicit pairs of orders 5 and 8 have
#: small leading errors, so that the next ones count for long.
EXPLICIT = {1: 64, 2: 32, 3: 32, 4: 32, 5: 128, 8: 64, 9: 64}
IMPLICIT = {2: 24, 3: 24, 4: 8, 5: 8, 6: 8, 8: 8, 9: 8, 13: 8, 16: 8}
#: Steps of a fast motion with errors far above rounding errors.
COARSE = {1: 256, 2: 64, 3: 64, 4: 32, 5: 32, 6: 12, 8: 16, 9: 16, 13: 12, 16: 16}


#: Systems with the start of a slow and of a fast motion, and a guess of what follows.
SYSTEMS: dict[Callable[[], System], tuple[dict, dict, dict]] = {
    slider_crank: (
        {"phi": 2.0, "phi_dot": 1.0},
        {"phi": 0.75, "phi_dot": 3.0},
        {"psi": -0.3, "x": 0.9},
    ),
    four_bar: (
        {"phi": 1.5, "phi_dot": 1.0},
        {"phi": 0.75, "phi_dot": 3.0},
        {"theta": 0.5, "psi": 1.0},
    ),
    yoke: ({"x": 0.3, "phi": -1.0, "phi_dot": 3.0}, {"x": 0.3, "phi": -1.0, "phi_dot": 4.0}, {}),
    lifted: ({"x": 0.48, "x_dot": 3.0}, {"x": 0.48, "x_dot": 4.0}, {"y": -0.6}),
}
RUNGE_KUTTA = [name for name in names() if not load(name).is_splitting]
SLOW, FAST = (0, 0.125), (1, 0.5)  # which start, and the duration


class DecimalMotion:
    """A motion of a system, and its approximations by methods in decimal numbers."""

    def __init__(
        self, make: Callable[[], System], which: int, duration: float, *, has_jacobian: bool = False
    ) -> None:
        self.module, self.duration = build(make()), duration
        start, guess = SYSTEMS[make][which], SYSTEMS[make][2]
        self.start = consistent_start(self.module, start, {}, guess=guess).y
        name = "lagrangian" if has_jacobian else fastest_form(self.module)
        self.form = Form(self.module, name, self.module.DEFAULTS)
        rhs = with_exact_literals(self.form.function, lambda number: number)
        rhs = with_functions(rhs, {"sin": _sine, "cos": _cosine})
        params = [Decimal(p) for p in self.module.DEFAULTS]
        self.rhs = lambda t, z: np.array(rhs(t, z, params))
        self._project = DecimalProjection(self.form, self.module.DEFAULTS)

    def projected(self, t: Decimal, z: np.ndarray) -> np.ndarray:
        """The state of the form on the constraints."""
        angles = [Decimal(0)] * len(self.form.angle_columns)
        return np.array(self._project(t, [*z, *angles])[: len(z)])

    @cached_property
    def end(self) -> np.ndarray:
        """The end of the motion by Taylor series."""
        times, z = [0.0, self.duration], np.empty(len(self.form.state), object)
        y = decimal_motion(self.module, self.module.DEFAULTS, self.start, times, DIGITS)[-1]
        for k, i in self.form.shared_columns:
            z[i] = y[k]
        for k, i in self.form.angle_columns:
            z[i : i + 2] = sine_and_cosine(y[k])
        return z

    def after(self, method: Tableau, steps: int) -> np.ndarray:
        """The end of the motion by equal steps of a method."""
        h, t = Decimal(self.duration) / steps, Decimal(0)
        start = decimal_state(self.form, self.start)
        self._project.keep_integrals(t, start)
        z = self.projected(t, np.array(start)[: len(self.form.state)])
        A, b, c = (_decimals(part) for part in (method.A, method.b, method.c))
        k = np.array([self.rhs(t, z)] * len(b))
        for step in range(steps):
            known = method.is_fsal and step > 0  # the first stage, before the projection
            k[0] = k[-1] if known else k[0]
            change = Decimal(1)
            while change > Decimal(10) ** (4 - DIGITS):  # until the stages are solved
                before = k.copy()
                for i in range(known, len(b)):
                    k[i] = self.rhs(t + c[i] * h, z + h * (A[i] @ k))
                change = Decimal(0) if method.is_explicit else abs(k - before).max()
            t += h
            z = self.projected(t, z + h * (b @ k))
        return z

    def global_error(self, method: Tableau, steps: int) -> float:
        """Largest error of the state at the end."""
        return float(abs(self.after(method, steps) - self.end).max())


def _sine(angle: Decimal) -> Decimal:
    return sine_and_cosine(angle)[0]


def _cosine(angle: Decimal) -> Decimal:
    return sine_and_cosine(angle)[1]


def _decimals(numbers: Any) -> Any:
    """The exact coefficients of a method in decimals."""
    if isinstance(numbers, tuple):
        return np.array([_decimals(one) for one in numbers])
    if isinstance(numbers, Surd):
        return _decimals(numbers.a) + _decimals(numbers.b) * Decimal(numbers.d).sqrt()
    if isinstance(numbers, Fraction):
        return Decimal(numbers.numerator) / numbers.denominator
    return Decimal(numbers)


@pytest.fixture(scope="module", autouse=True)
def digits() -> Iterator[None]:
    with localcontext(prec=DIGITS):
        yield


motion = cache(DecimalMotion)


@pytest.mark.long("more cases of the same kind", keep=2, daily=46)
@pytest.mark.parametrize("make", SYSTEMS)
@pytest.mark.parametrize("name", RUNGE_KUTTA)
def test_every_method_keeps_its_order(name: str, make: Callable[[], System]) -> None:
    method = load(name)
    fewest = EXPLICIT if method.is_explicit else IMPLICIT
    steps = fewest[method.order] * np.array([1, 2, 4])
    one = motion(make, *SLOW)
    errors = [one.global_error(method, n) for n in steps.tolist()]
    order, _ = np.polyfit(np.log(steps), -np.log(errors), 1)
    assert abs(order - method.order) < 0.1, errors


@pytest.mark.long("other tests reach its code", daily=12)
@pytest.mark.parametrize("name", RUNGE_KUTTA)
def test_loops_agree_with_decimal_numbers(name: str) -> None:
    method = load(name)
    one = motion(four_bar, *FAST, has_jacobian=method.needs_jacobian)
    steps, module, params = COARSE[method.order], one.module, one.module.DEFAULTS
    expected = one.after(method, steps)
    error = float(abs(expected - one.end).max())
    assert error > 1e-10  # far above rounding errors
    for backend in ("python", "compiled"):
        options = {"form": one.form.name, "backend": backend, "h": one.duration / steps}
        found = integrate(module, (0, one.duration), one.start, params, method=name, **options)
        end = found.y[:, -1]
        difference = one.form.from_ordinary(one.duration, end) - expected.astype(float)
        assert abs(difference).max() < 1e-3 * error
        residuals = np.abs(module.constraints_many(0.0, found.y, params))
        assert residuals.max() < 4e-16 * (1 + np.abs(found.y).max())
