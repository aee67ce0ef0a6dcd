"""Energy over very many periods: Runge–Kutta methods lose it, symplectic ones give it back."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import NDArray

from solvers.equations.energy import energy_error
from solvers.equations.module import GeneratedModule
from solvers.equations.normal_modes import Modes
from solvers.integration.integrate import integrate

Array = NDArray[np.float64]

#: Regular motion of the double pendulum, far from small: angles in rad, at rest.
START = (0.5, 0.6, 0.0, 0.0)
#: Methods, forms and steps per period of the slow mode.
CASES = (
    ("rk4", "lagrangian", 60),
    ("dp54", "lagrangian", 40),
    ("verner87", "lagrangian", 15),
    ("radau3", "lagrangian", 20),
    ("gauss1", "hamiltonian", 60),
    ("gauss2", "hamiltonian", 30),
    ("gauss3", "hamiltonian", 20),
    ("gauss2", "lagrangian", 30),
)
#: Energy is looked at in so many blocks of so many periods, ever further apart.
BLOCKS, LENGTH = 40, 3


@dataclass(frozen=True)
class Drift:
    """What becomes of energy in a long run.

    Attributes
    ----------
    method, form : str
        What ran.
    steps_per_period : int
        How long its steps are.
    periods : ndarray of shape (samples,)
        Times in periods of the slow mode.
    energy_error : ndarray of shape (samples,)
        In parts of the energy above rest.
    exponent : float
        Of the error's growth with time: 1 is a steady drift, 0 none.
    rate : float
        Drift a period, by a straight line through the whole run.
    first, whole : float
        Largest error in the first hundredth of the run, and in all of it.
    """

    method: str
    form: str
    steps_per_period: int
    periods: Array
    energy_error: Array
    exponent: float
    rate: float
    first: float
    whole: float


def study(pendulum: GeneratedModule, periods: float, cases: Sequence[tuple[str, str, int]] = CASES,
          ) -> list[Drift]:  # fmt: skip
    """Energy errors of the double pendulum over so many periods of its slow mode.

    Parameters
    ----------
    pendulum : module
        The generated double pendulum.
    periods : float
        How many: more than `LENGTH` by one at least.
    cases : sequence of tuple
        Method, form and steps per period of each run.

    Returns
    -------
    list of Drift
        One for each of `cases`.

    Raises
    ------
    ValueError
        When a method or form does not exist, or there are too few periods.
    KeyboardInterrupt
        When the user interrupts; no further case is begun.
    """
    params = pendulum.DEFAULTS
    period = 2 * pi / Modes.at_rest(pendulum, params).frequencies[0]

    def drift(case: tuple[str, str, int]) -> Drift:
        method, form, steps = case
        h = period / steps
        # ends of steps: blocks of a few periods, so that oscillations are seen whole
        blocks = np.logspace(0, np.log10(periods - LENGTH), BLOCKS) * steps
        ends = np.unique(blocks.astype(np.int64)[:, None] + np.arange(LENGTH * steps))
        run = integrate(
            pendulum, (0, periods * period), START, params, method=method, form=form, h=h,
            t_eval=h * np.array([0, *ends]), energy=True, max_steps=10**9,
        )  # fmt: skip
        assert run.energy is not None
        error = energy_error(pendulum, params, run.energy)
        t = run.t / period
        largest = np.maximum.accumulate(np.abs(error))
        late = t >= periods / 100
        exponent = np.polyfit(np.log(t[late]), np.log(largest[late]), 1)[0]
        return Drift(
            method, form, steps, t, error, float(exponent), float(np.polyfit(t, error, 1)[0]),
            float(largest[~late][-1]), float(largest[-1]),
        )  # fmt: skip

    with ThreadPoolExecutor() as pool:
        try:
            return list(pool.map(drift, cases))
        except KeyboardInterrupt:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
