"""Numbers as C text."""

from collections.abc import Iterable

from solvers.runge_kutta.order_conditions import Number


def real(number: Number) -> str:
    """A number of double precision, in brackets."""
    return f"({float(number)!r})"


def row(numbers: Iterable[Number]) -> str:
    """Numbers as the initial values of an array."""
    return f"{{{', '.join(map(real, numbers))}}}"
