"""Symbols of velocities, accelerations and momenta, with names for code and LaTeX."""

import sympy as sp
from sympy.printing.latex import LatexPrinter


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
