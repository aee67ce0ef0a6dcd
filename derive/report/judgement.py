"""The verdict on every equation of the report, computed."""

from __future__ import annotations

import ast
from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import cache

import sympy as sp

from derive.expression import Value, parsed, tree
from derive.report import appendix, chapters, contexts
from derive.report.equation import Equation, Stated, Verdict
from derive.statement import Context, Finding

#: Tells the order of the Runge–Kutta method with coefficients A, b, c.
OrderOf = Callable[[Sequence[Sequence[Fraction]], Sequence[Fraction], Sequence[Fraction]], int]

EQUATIONS: tuple[Equation | Stated, ...] = (
    *chapters.INTRODUCTION,
    *chapters.METHODOLOGY,
    *chapters.IMPLEMENTATION,
    *appendix.LAGRANGE,
    *appendix.EULER_LAGRANGE,
    *appendix.HAMILTON,
)


def verdicts(order_of: OrderOf) -> list[Verdict]:
    """The verdict on each equation, in the order of the report.

    Parameters
    ----------
    order_of : callable
        ``order_of(A, b, c)``, the order of a Runge–Kutta method by its order conditions.
    """
    return [verdict(equation, order_of) for equation in EQUATIONS]


def verdict(equation: Equation | Stated, order_of: OrderOf) -> Verdict:
    """The verdict on one equation.

    ``verified``: it holds as printed. ``misprint``: it does not, and its correction
    does. ``wrong``: neither does, which would be a fault of this project's.
    """
    if isinstance(equation, Stated):
        return Verdict(equation.id, equation.verdict, equation.printed, note=equation.reason)
    finding = judged(equation, equation.printed, order_of)
    if finding.holds:
        return Verdict(equation.id, "verified", equation.printed, note=equation.note)
    mended = bool(equation.corrected) and judged(equation, equation.corrected, order_of).holds
    return Verdict(
        equation.id,
        "misprint" if mended else "wrong",
        equation.printed,
        correction=equation.corrected if mended else "",
        residual=_residual(equation, finding) if mended else "",
        witness=finding.witness,
        note=equation.note,
    )


def judged(equation: Equation, text: str, order_of: OrderOf) -> Finding:
    """Whether `equation` holds with `text` in place of what is printed."""
    if equation.system == "method":
        order = order_of(*_tableau(equation, text))
        return Finding(order == 4, witness=f"order {order}")
    context = _context(equation)
    if not equation.check:
        return context.judged(_measured(equation, text), _definitions(equation.using))
    known = _definitions(equation.using) | _defined(text, context, equation.using)
    finding = context.judged(equation.check, known)
    # an inequality defines nothing: it must hold by itself, too
    return context.judged(text, known) if finding.holds and "<" in text else finding


def _residual(equation: Equation, finding: Finding) -> str:
    """How far the printed form is from the corrected one, where it first differs."""
    context, known = _context(equation), _definitions(equation.using)
    printed, corrected = (
        context.comparisons(_measured(equation, text), known)[finding.place].residual
        for text in (equation.printed, equation.corrected)
    )
    return sp.sstr(sp.factor_terms(sp.together(sp.expand(printed - corrected))))


def _context(equation: Equation) -> Context:
    # with a measure, accelerations are free: the equation is compared, not fulfilled
    moving = not equation.measure
    match equation.system:
        case "single":
            return contexts.single_pendulum(moving=moving)
        case "rigid":
            return contexts.rigid_body()
        case _:
            return contexts.double_pendulum(moving=moving)


def _measured(equation: Equation, text: str) -> str:
    if not equation.measure:
        return text
    sides = (part.split("=") for part in text.split(";"))
    return "; ".join(f"({left}) - ({right}) = {equation.measure}" for left, right in sides)


@cache
def _by_id() -> dict[str, Equation]:
    return {e.id: e for e in EQUATIONS if isinstance(e, Equation)}


def _definitions(using: Sequence[str]) -> dict[str, Value]:
    """What other equations define, as printed."""
    known: dict[str, Value] = {}
    for key in using:
        equation = _by_id()[key]
        known |= _defined(equation.printed, _context(equation), (), known)
    return known


def _defined(
    text: str, context: Context, using: Sequence[str], known: dict[str, Value] | None = None
) -> dict[str, Value]:
    """The names on the left of ``name = formula; …`` with the formulas' values."""
    scope = {**context.scope, **_definitions(using), **(known or {})}
    values: dict[str, Value] = {}
    for part in text.split(";"):
        name, equals, formula = part.partition("=")
        if equals and name.strip().isidentifier():
            value = parsed(formula, scope)
            values |= {name.strip(): value, f"{name.strip()[:-1]}_{name.strip()[-1]}": value}
    return values


def _tableau(
    equation: Equation, text: str
) -> tuple[list[list[Fraction]], list[Fraction], list[Fraction]]:
    """A, b, c of the four stages and the step around `equation`, which reads `text`."""
    texts = _family(equation)
    texts[equation.id] = text
    *stages, step = texts.values()
    rows, nodes = [], []
    for stage in stages:
        call = _only_call(stage)
        time, state = (ast.unparse(argument) for argument in call.args)
        nodes.append(_coefficient(time, "h"))
        rows.append([_coefficient(state, f"m_{j + 1}") for j in range(4)])
    weights = [_coefficient(step.partition("=")[2], f"m_{j + 1}") for j in range(4)]
    return rows, weights, nodes


def _family(equation: Equation) -> dict[str, str]:
    """The texts of the four stages and of the step that belong together."""
    if equation.using:
        return {key: _by_id()[key].printed for key in equation.using} | {equation.id: ""}
    ids = [
        e.id for e in EQUATIONS if isinstance(e, Equation) and e.system == "method" and not e.using
    ]
    first = ids.index(equation.id) // 5 * 5
    return {key: _by_id()[key].printed for key in ids[first : first + 5]}


def _only_call(stage: str) -> ast.Call:
    product = tree(stage.partition("=")[2])
    match product:
        case ast.BinOp(left=ast.Name(id="h"), op=ast.Mult(), right=ast.Call() as call):
            return call
    raise ValueError(f"a stage reads m = h*f(t, w), not {stage!r}")


def _coefficient(text: str, name: str) -> Fraction:
    names = ("t_i", "w_i", "h", "m_1", "m_2", "m_3", "m_4")
    symbols = {n: sp.Symbol(n) for n in names}
    coefficient = sp.expand(parsed(text, symbols)).coeff(symbols[name], 1)
    return Fraction(int(coefficient.p), int(coefficient.q))
