"""A Runge–Kutta method read from its printed stages."""

from __future__ import annotations

import ast
from collections.abc import Sequence
from fractions import Fraction

import sympy as sp

from derive.formulas.expression import parse, syntax_tree

STAGES = 4
NAMES = ("t_i", "w_i", "h", *(f"m_{k + 1}" for k in range(STAGES)))
SYMBOLS = {name: sp.Symbol(name) for name in NAMES}


class NotRungeKuttaError(ValueError):
    """The lines are not the stages and the step of an explicit Runge–Kutta method."""


def coefficients(lines: Sequence[str]) -> tuple[list[list[Fraction]], list[Fraction]]:
    """A and b of ``m_k = h*f(t_i + c*h, w_i + Σ a*m_j)``, …, ``w_next = w_i + Σ b*m_k``.

    Parameters
    ----------
    lines : sequence of str
        The four stages, then the step.

    Returns
    -------
    A : list of list of Fraction
        Stage matrix, a row for each stage.
    b : list of Fraction
        Weights of the stages.

    Raises
    ------
    NotRungeKuttaError
        When a line has another form, or c is not the sum of its row of A.
    ExpressionError
        When a line is no formula.
    """
    *stages, step = lines
    A = []
    for number, line in enumerate(stages, start=1):
        time, state = _arguments(line, f"m_{number}")
        A.append(_weights(state, "w_i", NAMES[3:]))
        if _weights(time, "t_i", ["h"]) != [sum(A[-1])]:
            raise NotRungeKuttaError(f"{line!r}: time and state move by different parts of h")
    return A, _weights(_right(step, "w_next"), "w_i", NAMES[3:])


def _right(line: str, name: str) -> sp.Expr:
    left, _, right = line.partition("=")
    if left.strip() != name:
        raise NotRungeKuttaError(f"{line!r} should define {name}")
    return parse(right, SYMBOLS)


def _arguments(line: str, name: str) -> tuple[sp.Expr, sp.Expr]:
    left, _, right = line.partition("=")
    match left.strip(), syntax_tree(right):
        case str(found), ast.BinOp(
            left=ast.Name(id="h"),
            op=ast.Mult(),
            right=ast.Call(func=ast.Name(id="f"), args=[time, state], keywords=[]),
        ) if found == name:
            return parse(ast.unparse(time), SYMBOLS), parse(ast.unparse(state), SYMBOLS)
    raise NotRungeKuttaError(f"{line!r} should read {name} = h*f(t, w)")


def _weights(expression: sp.Expr, base: str, names: Sequence[str]) -> list[Fraction]:
    """The numbers before `names` in `expression`, which is `base` plus their sum."""
    found = [sp.expand(expression).coeff(SYMBOLS[name], 1) for name in names]
    total = SYMBOLS[base] + sum(n * SYMBOLS[name] for n, name in zip(found, names, strict=True))
    if not all(n.is_Rational for n in found) or sp.expand(expression - total) != 0:
        raise NotRungeKuttaError(f"{expression} should be {base} plus numbers times {names}")
    return [Fraction(int(n.p), int(n.q)) for n in found]
