"""Computed verdicts on the equations of the report."""

import re
from collections.abc import Callable
from fractions import Fraction
from functools import cache

import sympy as sp

from derive.formulas.expression import Value, parse
from derive.formulas.syntax import ExpressionError
from derive.verification.judging.engine import Check, Context
from derive.verification.judging.verdict import Verdict
from derive.verification.report import contexts
from derive.verification.report.contexts import STRAY
from derive.verification.report.equation import ReportEquation
from derive.verification.report.printed_tableau import STAGES, NotRungeKuttaError, coefficients
from derive.verification.report.report_equations import equations
from solvers.io.suggestion import did_you_mean

#: Returns the order of the Runge–Kutta method with stage matrix A and weights b.
OrderOf = Callable[[list[list[Fraction]], list[Fraction]], int]

#: A quantity with the arguments on which alone it depends.
ONLY = re.compile(r"only\((\w+), (.*)\)")
#: The equations of the report by id, in printed order.
EQUATIONS = equations()


def verdicts(order_of: OrderOf) -> list[Verdict]:
    """Judge all equations of the report."""
    return [verdict(equation, order_of) for equation in EQUATIONS.values()]


def equation_by_id(name: str) -> ReportEquation:
    """Return an equation of the report.

    Parameters
    ----------
    name : str
        Its id: ``eq33`` for equation (33), ``A9`` for the ninth unnumbered display.

    Returns
    -------
    Equation

    Raises
    ------
    LookupError
        When no equation has this id.
    """
    if name in EQUATIONS:
        return EQUATIONS[name]
    suggestion = did_you_mean(name, EQUATIONS)
    raise LookupError(f"the report has no equation {name[:50]!r}{suggestion}")


def verdict(equation: ReportEquation, order_of: OrderOf) -> Verdict:
    """Judge one equation.

    ``verified``: it holds as printed. ``misprint``: it does not, but its correction
    does. ``wrong``: neither does, which would be an error of this project.

    Parameters
    ----------
    equation : Equation
        As `equation_by_id` returns it.
    order_of : callable
        ``order_of(A, b)``, the order of a Runge–Kutta method by its order conditions.

    Returns
    -------
    Verdict
        For a misprint with the correction, the residual and its value.

    Raises
    ------
    ExpressionError
        When the equation is not a formula, or contains an undefined name.
    NotImplementedError
        When it is not rational in symbols, sines and cosines, and thus undecidable here.
    """
    return verdict_on(equation, equation.printed, order_of)


@cache
def verdict_on(equation: ReportEquation, text: str, order_of: OrderOf) -> Verdict:
    """Judge `text` in place of the printed form: if it holds neither, it is ``wrong``."""
    label, note = equation.id, equation.note
    if equation.exempt:
        return Verdict(label, equation.exempt, text, note=note)
    result = check(equation, text, order_of)
    if result.holds:
        return Verdict(label, "verified", text, note=note)
    is_printed, witness = text == equation.printed, result.witness
    corrected = equation.corrected or ("" if is_printed else equation.printed)
    if not corrected or not check(equation, corrected, order_of).holds:
        return Verdict(label, "wrong", text, witness=witness, note=note)
    if not is_printed:
        return Verdict(label, "wrong", text, corrected, witness=witness)
    residual, state = _residual(equation, result.comparison)
    return Verdict(
        label, "misprint", text, corrected, residual, witness=witness, state=state, note=note
    )


def check(equation: ReportEquation, text: str, order_of: OrderOf) -> Check:
    """Check `equation` with `text` in place of the printed form."""
    if equation.system == "method":
        try:
            order = order_of(*coefficients(_method_lines(equation, text)))
        except NotRungeKuttaError as error:
            return Check(holds=False, witness=str(error))
        return Check(order == 4, witness=f"order {order}")
    context, known = _context(equation), _definitions_used(equation)
    if not equation.check:
        return context.check(_with_measure(equation, text), known)
    defined = _definitions(text, context, known)
    if set(defined) != set(_definitions(equation.printed, context, known)):
        return Check(holds=False, witness="it defines another quantity")
    result = context.check(equation.check, known | defined)
    # an inequality defines nothing and must hold by itself, too
    return context.check(text, known | defined) if result.holds and "<" in text else result


def _residual(equation: ReportEquation, index: int) -> tuple[str, str]:
    """Printed minus corrected form, in the comparison where they first differ, and a state."""
    context, known = _context(equation), _definitions_used(equation)
    texts = (_with_measure(equation, text) for text in (equation.printed, equation.corrected))
    printed, corrected = (context.comparisons(text, known)[index].residual for text in texts)
    residual = sp.factor_terms(sp.together(sp.expand(printed - corrected)))
    names = {str(symbol): symbol for symbol in context.states[0] if symbol in residual.free_symbols}
    state = context.state(residual, sp.S.Zero, names)
    return sp.sstr(residual), ", ".join(f"{name} = {number}" for name, number in state.items())


def _context(equation: ReportEquation) -> Context:
    if equation.system == "rigid":
        return contexts.rigid_body()
    pendulum = contexts.single_pendulum if equation.system == "single" else contexts.double_pendulum
    # with a measure, the equation is an identity in free accelerations
    return pendulum(moving=not equation.measure)


def _with_measure(equation: ReportEquation, text: str) -> str:
    if not equation.measure:
        return text
    if re.search(r"\bE(_?[12i])?\b", text):
        raise ExpressionError(f"{text!r} contains the Euler–Lagrange residual")
    sides = [part.split("=") for part in text.split(";")]
    if any(len(pair) != 2 for pair in sides):
        raise ExpressionError(f"{text!r} must have two sides")
    return "; ".join(f"({left}) - ({right}) = {equation.measure}" for left, right in sides)


def _definitions_used(equation: ReportEquation) -> dict[str, Value]:
    """Quantities that the used equations define, as printed, and a letter without a meaning."""
    known: dict[str, Value] = {equation.stray: STRAY} if equation.stray else {}
    for key in equation.using:
        used = EQUATIONS[key]
        known |= _definitions(used.printed, _context(used), known)
    return known


def _definitions(text: str, context: Context, known: dict[str, Value]) -> dict[str, Value]:
    """Quantities that ``name = formula`` defines; of an inequality, its left side ``left_1``."""
    namespace = {**context.namespace, **known}
    values: dict[str, Value] = {}
    for number, part in enumerate(text.split(";"), start=1):
        if "<" in part:
            values[f"left_{number}"] = parse(part.partition("<")[0], namespace)
            continue
        name, _, formula = (side.strip() for side in part.partition("="))
        if dependent := ONLY.fullmatch(name):
            name, formula = dependent[1], f"only({formula}, {dependent[2]})"
        values[name] = parse(formula, namespace)
    return values


def _method_lines(equation: ReportEquation, text: str) -> list[str]:
    """The four stages and the step of one method, with `text` for `equation`."""
    keys = [*equation.using, equation.id]
    if not equation.using:  # the equations of one method follow each other
        keys = [e.id for e in EQUATIONS.values() if e.system == "method" and not e.using]
        first = keys.index(equation.id) // (STAGES + 1) * (STAGES + 1)
        keys = keys[first : first + STAGES + 1]
    return [text if key == equation.id else EQUATIONS[key].printed for key in keys]
