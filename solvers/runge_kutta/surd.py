"""Exact numbers a + b√d, in which the coefficients of Gauss and Radau methods are written."""

from dataclasses import dataclass
from fractions import Fraction
from math import sqrt


@dataclass(frozen=True)
class Surd:
    """The number a + b√d, with a and b rational; d is fixed in one computation, and no square."""

    a: Fraction
    b: Fraction
    d: int

    @classmethod
    def root(cls, d: int) -> "Surd":
        """√d."""
        return cls(Fraction(0), Fraction(1), d)

    def _surd(self, other: "Surd | Fraction | int") -> "Surd":
        return other if isinstance(other, Surd) else Surd(Fraction(other), Fraction(0), self.d)

    def __add__(self, other: "Surd | Fraction | int") -> "Surd":
        other = self._surd(other)
        return Surd(self.a + other.a, self.b + other.b, self.d)

    def __mul__(self, other: "Surd | Fraction | int") -> "Surd":
        other = self._surd(other)
        product = self.a * other.a + self.d * self.b * other.b
        return Surd(product, self.a * other.b + self.b * other.a, self.d)

    __radd__ = __add__
    __rmul__ = __mul__

    def __neg__(self) -> "Surd":
        return Surd(-self.a, -self.b, self.d)

    def __sub__(self, other: "Surd | Fraction | int") -> "Surd":
        return self + -self._surd(other)

    def __rsub__(self, other: "Surd | Fraction | int") -> "Surd":
        return -self + other

    def __truediv__(self, other: Fraction | int) -> "Surd":
        return Surd(self.a / other, self.b / other, self.d)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Surd | Fraction | int):
            return NotImplemented
        return (self - other).a == (self - other).b == 0

    def __hash__(self) -> int:
        return hash(self.a) if self.b == 0 else hash((self.a, self.b, self.d))

    def __float__(self) -> float:
        # 30 digits of the root, so that a difference of both parts loses none of the float's
        root = Fraction(int(sqrt(self.d) * 2**52), 2**52)
        for _ in range(2):
            root = (root + self.d / root) / 2
        return float(self.a + self.b * root)

    def __abs__(self) -> "Surd":
        return self if float(self) >= 0 else -self
