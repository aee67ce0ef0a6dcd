"""Times at which sweeps record states: multiples of a period, which may differ between motions."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import prod

import numpy as np

from solvers.equations.module import GeneratedModule
from solvers.equations.number_checks import real_number
from solvers.io.quantity import WORD, UnitError, dimension, formula
from solvers.sweeps.definition.axes import Array

#: Factors of m, kg, s and rad in the comparison of dimensions; an angle has none.
FACTORS = (2.0, 3.0, 5.0, 1.0)


@dataclass(frozen=True)
class Sampling:
    """`count` times (skip + k + phase/(2π)) T of each motion, k = 0, 1, …, with its own period T.

    Parameters
    ----------
    every : str or float
        The period T in s, or a formula of parameters such as ``2*pi/Omega``.
    count : int
        Number of times.
    phase : float
        Phase in rad.
    skip : int
        Number of periods before the first time.
    """

    every: str | float
    count: int
    phase: float = 0.0
    skip: int = 0

    def periods(self, module: GeneratedModule, params: Sequence[Array]) -> Array:
        """Periods in s of motions with these parameters."""
        if not isinstance(self.every, str):
            return np.full(np.shape(params[0]) if params else (1,), float(self.every))
        named = dict(zip(module.PARAMETERS, params, strict=True))
        with np.errstate(all="ignore"):
            periods = np.asarray(formula(self.every, named), float)
        wrong = ~(np.isfinite(periods) & (periods > 0))
        if wrong.any():
            k = int(np.argmax(wrong))
            used = (f"{p} = {named[p].flat[k]:g}" for p in WORD.findall(self.every) if p in named)
            raise ValueError(
                f"every = {self.every!r} is {periods.flat[k]:g} s, at {', '.join(used)}: "
                "a period must be positive"
            )
        return periods

    def times(self, module: GeneratedModule, params: Sequence[Array]) -> Array:
        """Times in s, of shape (n, count), of motions with these parameters."""
        numbers = self.skip + np.arange(self.count) + self.phase / (2 * np.pi)
        return np.multiply.outer(self.periods(module, params), numbers)

    def check(self, module: GeneratedModule) -> None:
        """Refuse a formula that is not a time, or numbers that are not possible."""
        if not 0 <= real_number("phase", self.phase, "rad") < 2 * np.pi:
            raise ValueError(f"phase = {self.phase:g} must be from 0 to 2π, without the end")
        if not isinstance(self.every, str):
            if real_number("every", self.every, "s") <= 0:
                raise ValueError(f"every = {self.every!r} must be a positive period in s")
            return
        units = {name: module.UNITS[name] for name in module.PARAMETERS}
        values = {name: 1 + k / 10 for k, name in enumerate(units, 1)}
        try:
            scaled = {name: values[name] * _scale(unit) for name, unit in units.items()}
        except UnitError:  # a unit may be any text
            scaled = {}
        one = formula(self.every, values)
        # in other units of length, mass and time a period changes as every time does
        if scaled and abs(formula(self.every, scaled) - one * _scale("s")) > 1e-9 * abs(one):
            used = ", ".join(f"{name} in {unit}" for name, unit in units.items())
            raise ValueError(f"every = {self.every!r} is not a time in s; parameters are {used}")


def _scale(unit: str) -> float:
    """The size of a unit where m, kg, s and rad have the sizes `FACTORS`."""
    _, powers = dimension(unit)
    return prod(factor**power for factor, power in zip(FACTORS, powers, strict=True))
