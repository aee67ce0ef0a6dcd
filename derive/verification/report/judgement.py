"""The verdict on every equation of the report, computed."""

from __future__ import annotations

import re
from collections.abc import Callable
from fractions import Fraction
from functools import cache

import sympy as sp

from derive.formulas.expression import ExpressionError, Value, parse
from derive.verification.report import appendix, chapters, contexts
from derive.verification.report.contexts import STRAY
from derive.verification.report.equation import Equation, Stated, Verdict
from derive.verification.report.method import NotRungeKuttaError, coefficients
from derive.verification.statement import Context, Finding
from solvers.io.suggestion import did_you_mean

#: Tells the order of the Runge–Kutta method with stage matrix A and weights b.
OrderOf = Callable[[list[list[Fraction]], list[Fraction]], int]

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
        ``order_of(A, b)``, the order of a Runge–Kutta method by its order conditions.

    Returns
    -------
    list of Verdict
        One for each of `EQUATIONS`.
    """
    return [verdict(equation, order_of) for equation in EQUATIONS]


def named(name: str) -> Equation | Stated:
    """The equation of the report whose id this is.

    Parameters
    ----------
    name : str
        Such as ``eq33`` for equation (33), or ``A9`` for the ninth display without a number.

    Returns
    -------
    Equation or Stated
        Stated where nothing here can decide it.

    Raises
    ------
    LookupError
        When no equation has this id.
    """
    for equation in EQUATIONS:
        if equation.id == name:
            return equation
    known = [equation.id for equation in EQUATIONS]
    raise LookupError(f"the report has no equation {name[:50]!r}{did_you_mean(name, known)}")


@cache  # what stands beside a derivation is asked for again in the whole verdict
def verdict(equation: Equation | Stated, order_of: OrderOf) -> Verdict:
    """The verdict on one equation.

    ``verified``: it holds as printed. ``misprint``: it does not, and its correction
    does. ``wrong``: neither does, which would be a fault of this project's.

    Parameters
    ----------
    equation : Equation or Stated
        As `named` gives it; one that is stated has its verdict with it.
    order_of : callable
        ``order_of(A, b)``, the order of a Runge–Kutta method by its order conditions.

    Returns
    -------
    Verdict
        Of a misprint with its correction, how far it is from that, and a number that shows it.

    Raises
    ------
    ExpressionError
        When the equation is no formula, or has a name without a meaning.
    NotImplementedError
        When it is not rational in symbols, sines and cosines, so that nothing decides it.
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
        try:
            order = order_of(*coefficients(_steps(equation, text)))
        except NotRungeKuttaError as error:
            return Finding(False, witness=str(error))
        return Finding(order == 4, witness=f"order {order}")
    context = _context(equation)
    known = _known(equation)
    if not equation.check:
        return context.judged(_measured(equation, text), known)
    defined = _defined(text, context, known)
    if set(defined) != set(_defined(equation.printed, context, known)):
        return Finding(False, witness="it defines something else")
    finding = context.judged(equation.check, known | defined)
    # an inequality defines nothing: it must hold by itself, too
    return context.judged(text, known | defined) if finding.holds and "<" in text else finding


def _residual(equation: Equation, finding: Finding) -> str:
    """How far the printed form is from the corrected one, where it first differs."""
    context, known = _context(equation), _known(equation)
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
    if re.search(r"\bE(_?[12i])?\b", text):
        raise ExpressionError(f"{text!r} names what it is measured by")
    sides = [part.split("=") for part in text.split(";")]
    if any(len(pair) != 2 for pair in sides):
        raise ExpressionError(f"{text!r} should have two sides")
    return "; ".join(f"({left}) - ({right}) = {equation.measure}" for left, right in sides)


@cache
def _by_id() -> dict[str, Equation]:
    return {e.id: e for e in EQUATIONS if isinstance(e, Equation)}


def _known(equation: Equation) -> dict[str, Value]:
    """What the equations that it uses define, as printed; and a letter without a meaning."""
    known: dict[str, Value] = {equation.stray: STRAY} if equation.stray else {}
    for key in equation.using:
        used = _by_id()[key]
        known |= _defined(used.printed, _context(used), known)
    return known


def _defined(text: str, context: Context, known: dict[str, Value]) -> dict[str, Value]:
    """What ``name = formula; ...`` defines; of ``a < b; ...``, its left sides as ``left_1`` etc."""
    scope = {**context.scope, **known}
    values: dict[str, Value] = {}
    for number, part in enumerate(text.split(";"), start=1):
        if "<" in part:
            values[f"left_{number}"] = parse(part.partition("<")[0], scope)
            continue
        name, _, formula = (side.strip() for side in part.partition("="))
        value = parse(formula, scope)
        # alpha1 is also alpha_1, for statements about every index
        values |= {name: value, f"{name[:-1]}_{name[-1]}": value}
    return values


def _steps(equation: Equation, text: str) -> list[str]:
    """The four stages and the step that belong together, `equation` reading `text`."""
    if equation.using:
        keys = [*equation.using, equation.id]
    else:
        keys = [e.id for e in EQUATIONS if e.id in _by_id() and _is_plain_method(_by_id()[e.id])]
        first = keys.index(equation.id) // 5 * 5
        keys = keys[first : first + 5]
    return [text if key == equation.id else _by_id()[key].printed for key in keys]


def _is_plain_method(equation: Equation) -> bool:
    return equation.system == "method" and not equation.using
