"""The coordinates and parameters of known systems, by their names and units."""

import sympy as sp

from derive.system.parts import Coordinate, Parameter

#: Gravity, which can be negative.
g = sp.Symbol("g", real=True)


def coordinates(*pairs: tuple[sp.Symbol, str]) -> list[Coordinate]:
    """Coordinates with their units."""
    return [Coordinate(symbol, unit, "a coordinate") for symbol, unit in pairs]


def lengths(*symbols: sp.Symbol) -> list[Coordinate]:
    """Coordinates that are lengths."""
    return coordinates(*((symbol, "m") for symbol in symbols))


def parameters(**units: str) -> list[Parameter]:
    """Positive parameters by their names, and gravity."""
    return [
        Parameter(g if name == "g" else sp.Symbol(name, positive=True), unit, 1.0, "")
        for name, unit in units.items()
    ]
