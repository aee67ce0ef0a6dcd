"""Chaos: how fast errors grow, up to when a trajectory can be trusted, and what can be after it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import log
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from solvers.equations.energy import energy_error
from solvers.equations.module import GeneratedModule
from solvers.integration.compiled.compiler import NoCompilerError
from solvers.integration.integrate import integrate
from solvers.integration.predictability import ignore_predictability
from solvers.integration.prepare import prepare
from solvers.references.taylor import taylor

Array = NDArray[np.float64]

#: Seconds after which a small change is brought back to length 1, and those left out at first.
STRETCH, TRANSIENT = 1.0, 100
#: Tolerance of the motion whose exponent is sought, and those whose horizons are.
ACCURATE, TOLERANCES = 1e-9, (1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
#: Of what size a change is whose growth is followed.
OFFSET = 1e-12
#: Parts of a run count as independent from this duration in s on; how many there are.
INDEPENDENT, FEWEST, MOST = 150.0, 8, 40
#: Digits of references; an ordinary number's are lost within 40 s. And how often to look, in 1/s.
DIGITS, LOOKS = 30, 10
#: Error in rad or rad/s from which on a trajectory is another one.
APART = 1.0


@dataclass(frozen=True)
class Mean:
    """A mean over time, with its standard error."""

    value: float
    error: float

    @classmethod
    def of(cls, values: Array, duration: float) -> Mean:
        """The mean of `values`, of which neighbours are not independent: by means of blocks."""
        count = int(np.clip(duration / INDEPENDENT, FEWEST, MOST))
        blocks = np.array([part.mean() for part in np.array_split(values, count)])
        return cls(float(blocks.mean()), float(blocks.std(ddof=1) / np.sqrt(count)))


def lyapunov(
    module: GeneratedModule, params: Sequence[float], y0: Sequence[float], duration: float
) -> Mean:  # fmt: skip
    """The largest Lyapunov exponent in 1/s, along the motion from `y0`.

    A small change is carried along by the generated variational equations and brought
    back to length 1 every second; the exponent is the mean of the logarithms by which it
    has grown (G. Benettin, L. Galgani, J.-M. Strelcyn, Physical Review A 14, 2338, 1976).

    Parameters
    ----------
    module : module
        A generated module.
    params : sequence of float
        In the order of ``module.PARAMETERS``.
    y0 : sequence of float
        Coordinates and velocities at the beginning, in the order of ``module.STATE``.
    duration : float
        Over which the mean is taken, in s: `FEWEST` at least, and whole seconds of it. The
        first `TRANSIENT` seconds of the motion come before it.

    Returns
    -------
    Mean
        The exponent and its standard error, both in 1/s.

    Raises
    ------
    ValueError
        When an argument makes no sense.
    solvers.integration.prepare.NotFinishedError
        When the motion does not go on that long.
    """
    run = _stretch(module, params)
    n = len(module.STATE)
    state = np.array([*y0, *np.ones(n) / np.sqrt(n)])
    growth = []
    for _ in range(TRANSIENT + int(duration / STRETCH)):
        state = np.array(run(state.tolist()))
        length = float(np.linalg.norm(state[n:]))
        state[n:] /= length
        growth.append(log(length) / STRETCH)
    return Mean.of(np.array(growth[TRANSIENT:]), duration)


def _stretch(
    module: GeneratedModule, params: Sequence[float]
) -> Callable[[list[float]], ArrayLike]:  # fmt: skip
    """A function that carries a motion and a small change over one stretch of time."""
    try:
        run = prepare(module, params, form="variational", rtol=ACCURATE, atol=ACCURATE)
    except NoCompilerError:
        return lambda y: integrate(
            module, (0.0, STRETCH), y, params, form="variational", rtol=ACCURATE,
            atol=ACCURATE, t_eval=[STRETCH], backend="python",
        ).y[:, -1]  # fmt: skip
    return lambda y: run((0.0, STRETCH), y)


@dataclass(frozen=True)
class Separation:
    """How two motions part.

    Attributes
    ----------
    t : ndarray of shape (n,)
        In s.
    distance : ndarray of shape (n,)
        Length of the difference of states, from two references.
    predicted : ndarray of shape (n,)
        The same by the variational equations, to first order.
    rate : float
        Slope of its logarithm in 1/s, as long as it is small.
    """

    t: Array
    distance: Array
    predicted: Array
    rate: float


def reference(
    module: GeneratedModule, params: Sequence[float], y0: Sequence[float], duration: float
) -> tuple[Array, Array]:  # fmt: skip
    """Times, and states at them, shape (n, state), with more digits than chaos eats."""
    t = np.linspace(0, duration, round(LOOKS * duration) + 1)
    return t, taylor(module, params, y0, t, DIGITS)


def separation(
    module: GeneratedModule, params: Sequence[float], t: Array, truth: Array
) -> Separation:  # fmt: skip
    """What becomes of `OFFSET` in the first coordinate, beside a reference."""
    n = truth.shape[1]
    near = truth[0] + OFFSET * np.eye(n)[0]
    distance = np.linalg.norm(taylor(module, params, near.tolist(), t, DIGITS) - truth, axis=1)
    with ignore_predictability():
        carried = integrate(
            module, (0, t[-1]), [*truth[0], *(near - truth[0])], params, form="variational",
            rtol=1e-12, atol=1e-30, t_eval=t,
        ).y[n:]  # fmt: skip
    small = (distance < 1e-2) & (t > 0)
    rate = np.polyfit(t[small], np.log(distance[small]), 1)[0]
    return Separation(t, distance, np.linalg.norm(carried, axis=0), float(rate))


@dataclass(frozen=True)
class Horizon:
    """Up to when a trajectory is the right one.

    Attributes
    ----------
    method : str
        Which.
    tolerance : float
        Relative and absolute.
    predicted : float
        ln(1/tolerance)/λ, in s.
    seen : float
        When its error reached `APART`, in s.
    energy_error : float
        The largest over the whole run, in parts of the energy at its beginning above rest.
    """

    method: str
    tolerance: float
    predicted: float
    seen: float
    energy_error: float


def horizons(
    module: GeneratedModule, params: Sequence[float], t: Array, truth: Array, exponent: float,
    methods: Sequence[str],
) -> list[Horizon]:  # fmt: skip
    """Predicted and seen horizons of adaptive methods, beside a reference."""
    found = []
    for method in methods:
        for tolerance in TOLERANCES:
            with ignore_predictability():
                run = integrate(
                    module, (0, t[-1]), truth[0], params, method=method, rtol=tolerance,
                    atol=tolerance, t_eval=t, energy=True,
                )  # fmt: skip
            assert run.energy is not None
            apart = np.abs(run.y.T - truth).max(axis=1) > APART
            energy = np.abs(energy_error(module, params, run.energy)).max()
            seen = float(t[np.argmax(apart)]) if apart.any() else float("inf")
            found.append(
                Horizon(method, tolerance, log(1 / tolerance) / exponent, seen, float(energy))
            )
    return found


@dataclass(frozen=True)
class Statistics:
    """What a long run says of the motion as a whole.

    Attributes
    ----------
    run : str
        Method and tolerance or step.
    energy_error : float
        At the end, in parts of the energy at the beginning above rest.
    kinetic : Mean
        Mean kinetic energy in J.
    upright : Mean
        Part of the time for which the second coordinate is above the horizontal.
    """

    run: str
    energy_error: float
    kinetic: Mean
    upright: Mean


def statistics(
    module: GeneratedModule, params: Sequence[float], y0: Sequence[float], duration: float,
    runs: Sequence[Mapping[str, Any]],
) -> list[Statistics]:  # fmt: skip
    """Means over a time that is many horizons long, by runs that agree in no trajectory."""
    t = np.linspace(0, duration, int(2 * duration) + 1)
    found = []
    for options in runs:
        with ignore_predictability():
            run = integrate(
                module, (0, duration), y0, params, t_eval=t, energy=True, max_steps=10**8, **options
            )
        assert run.energy is not None
        still = run.y.copy()
        still[len(y0) // 2 :] = 0.0
        kinetic = run.energy - module.energy_many(0.0, still, params)
        found.append(Statistics(
            run.run.rpartition(", ")[0],
            float(energy_error(module, params, run.energy)[-1]),
            Mean.of(kinetic, duration),
            Mean.of((np.cos(run.y[1]) < 0).astype(float), duration),
        ))  # fmt: skip
    return found
