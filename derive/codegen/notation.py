"""How a target language writes the parts of an expression; by default as Python and C do."""

from __future__ import annotations

from fractions import Fraction


class Notation:
    """Names, numbers and calls; operators and brackets are common to all target languages."""

    def name(self, name: str) -> str:
        """An input."""
        return name

    def literal(self, value: Fraction) -> str:
        """A number, exact where the floating-point numbers are."""
        numerator, denominator = float(value.numerator), float(value.denominator)
        is_exact = (numerator, denominator) == (value.numerator, value.denominator)
        # a quotient of exact numbers is rounded once, in any type
        if value == float(value) or not is_exact:
            return repr(float(value))
        return f"({numerator!r}/{denominator!r})"

    def call(self, function: str, argument: str) -> str:
        """A call of a mathematical function, by its name in C99."""
        return f"{function}({argument})"

    def component(self, vector: str, index: int) -> str:
        """The component of a vector, from 0 on."""
        return f"{vector}[{index}]"
