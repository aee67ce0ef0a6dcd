"""Prescribed motions: inputs on which positions depend, with their rates of change."""

from collections.abc import Iterable, Mapping

import sympy as sp

from derive.system.parts import Input
from derive.system.symbols import TIME, acceleration, velocity


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
