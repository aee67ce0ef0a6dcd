"""Coefficients of a Runge–Kutta method from its printed stages."""

import ast
from collections.abc import Sequence
from fractions import Fraction

import sympy as sp

from derive.formulas.expression import parse
from derive.formulas.syntax import syntax_tree

STAGES = 4
INCREMENTS = tuple(f"m{k + 1}" for k in range(STAGES))
SYMBOLS = {name: sp.Symbol(name) for name in ("t_i", "w_i", "h", *INCREMENTS)}


class NotRungeKuttaError(ValueError):
    """The lines are not the stages and the step of an explicit Runge–Kutta method."""


def coefficients(lines: Sequence[str]) -> tuple[list[list[Fraction]], list[Fraction]]:
    """Return A and b of ``m_k = h*f(t_i + c*h, w_i + Σ a*m_j)``, …, ``w_next = w_i + Σ b*m_k``."""
    *stages, step = lines
    A = []
    for name, line in zip(INCREMENTS, stages, strict=True):
        time, state = (parse(text, SYMBOLS) for text in _arguments(line, name))
        A.append(_weights(state, "w_i", INCREMENTS))
        if _weights(time, "t_i", ["h"]) != [sum(A[-1])]:
            raise NotRungeKuttaError(f"{line!r}: c is not the sum of the row of A")
    left, _, right = step.partition("=")
    if left.strip() != "w_next":
        raise NotRungeKuttaError(f"{step!r} must define w_next")
    return A, _weights(parse(right, SYMBOLS), "w_i", INCREMENTS)


def _arguments(line: str, name: str) -> tuple[str, str]:
    left, _, right = line.partition("=")
    match syntax_tree(right):
        case ast.BinOp(ast.Name("h"), ast.Mult(), ast.Call(ast.Name("f"), [time, state], [])):
            if left.strip() == name:
                return ast.unparse(time), ast.unparse(state)
    raise NotRungeKuttaError(f"{line!r} must have the form {name} = h*f(t, w)")


def _weights(expression: sp.Expr, base: str, names: Sequence[str]) -> list[Fraction]:
    """Return the coefficients of `names` in `expression`, which is `base` plus their sum."""
    symbols = [SYMBOLS[name] for name in names]
    weights = [sp.expand(expression).coeff(symbol, 1) for symbol in symbols]
    total = SYMBOLS[base] + sum(w * symbol for w, symbol in zip(weights, symbols, strict=True))
    if not all(w.is_Rational for w in weights) or sp.expand(expression - total) != 0:
        raise NotRungeKuttaError(f"{expression} must be {base} plus multiples of {names}")
    return [Fraction(int(w.p), int(w.q)) for w in weights]
