"""Motions by Gragg's extrapolated midpoint rule in extended precision.

The equations are in Lagrange's form: only the physics is that of `solvers.references.taylor`.
"""

from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from solvers.equations.module import GeneratedModule

Array = NDArray[np.float64]
Long = NDArray[np.longdouble]
Rhs = Callable[[np.longdouble, Long], Long]

#: Midpoint rules with 2, 4, … 2·COLUMNS substeps are extrapolated: order 2·COLUMNS.
COLUMNS = 9


def extrapolated(
    module: GeneratedModule,
    params: Sequence[float],
    y0: Sequence[float],
    times: ArrayLike,
    h: float = 0.02,
) -> Array:
    """States (q, q̇) at `times`, in rows; the state at the first of them is `y0`.

    Steps are at most `h` long; there is no step control. The rule and its extrapolation in h² are
    W. B. Gragg's (E. Hairer, S. P. Nørsett, G. Wanner, Solving Ordinary Differential Equations I,
    section II.9, without smoothing). Numbers have a mantissa of 64 bits where the platform supports
    it, else of 53.
    """
    constants = np.array(params, dtype=np.longdouble)

    def rhs(t: np.longdouble, y: Long) -> Long:
        return np.asarray(module.rhs_many(t, y, constants), dtype=np.longdouble)

    y = np.array(y0, dtype=np.longdouble)
    states = [y]
    for begin, end in pairwise(np.asarray(times, dtype=float)):
        count = int(np.ceil(abs(end - begin) / h))
        t = np.longdouble(begin)
        length = (np.longdouble(end) - t) / count
        for k in range(count):
            y = _extrapolated_step(rhs, t + k * length, y, length)
        states.append(y)
    return np.array(states, dtype=float)


def _extrapolated_step(rhs: Rhs, t: np.longdouble, y: Long, h: np.longdouble) -> Long:
    """The state after a step, by the rule with more and more substeps, extrapolated."""
    row: list[Long] = []
    for j in range(1, COLUMNS + 1):
        above, row = row, [_midpoint_rule(rhs, t, y, h, 2 * j)]
        for k, older in enumerate(above, start=1):
            ratio = np.longdouble(j) / np.longdouble(j - k)
            row.append(row[-1] + (row[-1] - older) / (ratio * ratio - 1))
    return y + row[-1]


def _midpoint_rule(rhs: Rhs, t: np.longdouble, y: Long, h: np.longdouble, count: int) -> Long:
    """The change over `count` substeps, an even number; apart from y it keeps its digits."""
    part = h / count
    before, now = np.zeros_like(y), part * rhs(t, y)
    for k in range(1, count):
        before, now = now, before + 2 * part * rhs(t + k * part, y + now)
    return now
