"""Symbols of velocities, accelerations, momenta and prescribed motions."""

from collections.abc import Iterable, Mapping

import sympy as sp
from sympy.printing.latex import LatexPrinter

from derive.system.parts import Input


class Derived(sp.Symbol):
    """A symbol that belongs to a coordinate."""

    @classmethod
    def class_key(cls) -> tuple[int, int, str]:
        """Sort among the other symbols, by name."""
        return sp.Symbol.class_key()


class Rate(Derived):
    """Time derivative of a coordinate, ``theta1_dot``; LaTeX sets the dots above."""

    def _latex(self, printer: LatexPrinter) -> str:
        base, _, dots = self.name.rpartition("_")
        letter, subscript, index = printer.doprint(sp.Symbol(base)).partition("_")
        return rf"\{dots}{{{letter}}}{subscript}{index}"


class Momentum(Derived):
    """Momentum conjugate to a coordinate, ``p_theta1``; LaTeX sets the coordinate below."""

    def _latex(self, printer: LatexPrinter) -> str:
        return f"p_{{{printer.doprint(sp.Symbol(self.name.removeprefix('p_')))}}}"


def velocity(coordinate: sp.Symbol) -> Rate:
    """The symbol of a coordinate's first time derivative.

    Parameters
    ----------
    coordinate : sympy.Symbol
        A coordinate.

    Returns
    -------
    sympy.Symbol
        Named as the coordinate, with ``_dot``.

    Examples
    --------
    >>> from sympy import Symbol
    >>> from derive import velocity
    >>> velocity(Symbol("theta1", real=True))
    theta1_dot
    """
    return Rate(f"{coordinate.name}_dot", real=True)


def acceleration(coordinate: sp.Symbol) -> Rate:
    """The symbol of a coordinate's second time derivative."""
    return Rate(f"{coordinate.name}_ddot", real=True)


def variation(variable: sp.Symbol) -> sp.Symbol:
    """The symbol of a linear perturbation of a coordinate or velocity."""
    return sp.Symbol(f"delta_{variable.name}", real=True)


def momentum(coordinate: sp.Symbol) -> Momentum:
    """The symbol of the momentum conjugate to a coordinate."""
    return Momentum(f"p_{coordinate.name}", real=True)


#: Time, in positions, potentials and forces that depend on it.
TIME = sp.Symbol("t", real=True)


def parts(motion: Input) -> tuple[Input, ...]:
    """The inputs that describe a motion s: itself, s_dot, s_ddot and s_time."""
    s, unit, meaning = motion.symbol, motion.unit, motion.meaning
    return (
        motion,
        Input(velocity(s), f"{unit}/s", f"velocity of {meaning}"),
        Input(acceleration(s), f"{unit}/s^2", f"acceleration of {meaning}"),
        Input(_time(s), "s", f"time of {meaning}"),
    )


def motions(inputs: Iterable[Input]) -> dict[sp.Symbol, tuple[sp.Symbol, ...]]:
    """The symbols of the `parts` of each motion."""
    symbols = (part.symbol for part in inputs if part.motion)
    return {s: (s, velocity(s), acceleration(s), _time(s)) for s in symbols}


def prescribed_symbols(inputs: Iterable[Input]) -> set[sp.Symbol]:
    """The symbols of the `parts` of all motions."""
    return {symbol for symbols in motions(inputs).values() for symbol in symbols}


def as_functions_of_time(inputs: Iterable[Input]) -> Mapping[sp.Symbol, sp.Expr]:
    """Each motion and its velocity at any time, with a constant acceleration."""
    values: dict[sp.Symbol, sp.Expr] = {}
    for s, rate, change, time in motions(inputs).values():
        elapsed = TIME - time
        values |= {s: s + rate * elapsed + change * elapsed**2 / 2, rate: rate + change * elapsed}
    return values


def _time(s: sp.Symbol) -> sp.Symbol:
    return sp.Symbol(f"{s.name}_time", real=True)
