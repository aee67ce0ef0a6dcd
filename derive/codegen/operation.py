"""One straight-line operation."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import isqrt


@dataclass(frozen=True)
class Operation:
    """One value, computed from earlier ones.

    Attributes
    ----------
    kind : {"leaf", "number", "sum", "product", "quotient", "call"}
        Or ``factors``, ``solved``, ``component``: a matrix taken apart, a solution with it,
        and a part of that.
    operands : numbers of the operations it uses; a repeated factor stands twice
    coefficients : of a sum's operands, otherwise empty
    label : the leaf's or the called function's name
    value : the number, or which component
    constant : whether it depends on parameters alone
    """

    kind: str
    operands: tuple[int, ...] = ()
    coefficients: tuple[Fraction, ...] = ()
    label: str = ""
    value: Fraction = Fraction(0)
    constant: bool = False

    def cost(self) -> int:
        """Arithmetic operations and function calls, each counted as one."""
        if self.kind == "sum":
            scalings = sum(abs(c) != 1 for c in self.coefficients)
            negation = all(c == -1 for c in self.coefficients)
            return len(self.operands) - 1 + scalings + negation
        if self.kind == "factors":
            # of every pivot the inverse, and of every row below it a multiple of its row
            n = (isqrt(8 * len(self.operands) + 1) - 1) // 2
            return sum(1 + k + k * (k + 1) for k in range(n))
        if self.kind == "solved":
            n = len(self.operands) - 1
            return n + 2 * n * (n - 1)
        return {"product": len(self.operands) - 1, "quotient": 1, "call": 1}.get(self.kind, 0)
