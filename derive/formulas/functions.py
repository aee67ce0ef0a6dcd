"""The functions of formulas: their table, derivatives, kinks and jumps, and switching functions.

A number whose sign decides between branches is a switching function (E. Hairer, S. P. Norsett,
G. Wanner, Solving Ordinary Differential Equations I, section II.6): between its zeros, formulas are
smooth.
"""

from collections.abc import Collection, Iterable, Iterator
from functools import lru_cache

import sympy as sp
from sympy.core.relational import Relational

#: By their names in formulas.
FUNCTIONS = {
    f.__name__: f
    for f in (
        *(sp.sin, sp.cos, sp.tan, sp.exp, sp.log, sp.sqrt),
        *(sp.sinh, sp.cosh, sp.tanh, sp.atan, sp.atan2, sp.sign),
    )
} | {"abs": sp.Abs, "min": sp.Min, "max": sp.Max, "Piecewise": sp.Piecewise}

#: Functions of generated code, beside those of formulas that it calls by the same names.
GENERATED = ("pow", "select")


#: Functions with kinks or jumps, and their derivatives.
CHOICES = (sp.Abs, sp.sign, sp.Max, sp.Min, sp.Heaviside, sp.DiracDelta, sp.Piecewise)


def decisive_numbers(
    expressions: Iterable[sp.Basic], variables: Collection[sp.Symbol]
) -> tuple[sp.Expr, ...]:
    """Numbers that depend on `variables`, whose signs decide between branches of expressions.

    Of two that differ in their sign alone there is one. It comes after those in its own formula.
    """
    result: dict[sp.Expr, None] = {}
    for expression in expressions:
        for part in sorted(expression.atoms(*CHOICES), key=sp.default_sort_key):
            for number in _decisive(part):
                if number.free_symbols & {*variables} and -number not in result:
                    result[number] = None
    return tuple(sorted(result, key=lambda number: len(number.atoms(*CHOICES))))


def turning_arguments(expression: sp.Basic) -> tuple[tuple[sp.Expr, str], ...]:
    """Numbers near whose zeros an expression can change its form, with the kind of function.

    They are decisive numbers, of the kind "choice", bases of roots, and arguments of functions
    other than sine, cosine and tangent: ``tanh(300*x)`` is close to 1 or -1 but near x = 0.
    """
    result: dict[tuple[sp.Expr, str], None] = {}
    for part in sp.preorder_traversal(expression):
        numbers: Iterable[sp.Expr] = ()
        kind = ""
        if isinstance(part, CHOICES):
            numbers, kind = _decisive(part), "choice"
        elif isinstance(part, sp.Pow) and not part.exp.is_Integer:
            numbers, kind = (part.base,), f"power {part.exp}"
        elif isinstance(part, sp.Function) and not isinstance(part, sp.sin | sp.cos | sp.tan):
            numbers, kind = part.args, part.func.__name__
        result |= {(number, kind): None for number in numbers if not number.is_number}
    return tuple(result)


def switching_functions(
    expressions: Collection[sp.Basic], variables: Collection[sp.Symbol]
) -> tuple[sp.Expr, ...]:
    """The decisive numbers beyond whose zeros expressions are smooth with their signs held.

    Omitted are those on which roots, powers and logarithms depend, such as x of abs(x)**1.5: with
    its sign held, there is no value beyond the zero.
    """
    choices = {part for expression in expressions for part in expression.atoms(*CHOICES)}
    wholes = {whole for expression in expressions for whole in _partial(expression)}
    wholes |= {part for part in choices if isinstance(part, sp.Piecewise) and any(_partial(part))}
    parts = {part for whole in wholes for part in whole.atoms(*CHOICES)}
    omitted = {number for part in parts for number in _decisive(part)}
    numbers = decisive_numbers(expressions, variables)
    return tuple(number for number in numbers if not {number, -number} & omitted)


def _partial(expression: sp.Basic) -> Iterator[sp.Expr]:
    """Parts that have no real value for some arguments."""
    yield from expression.atoms(sp.log)
    yield from (power for power in expression.atoms(sp.Pow) if not power.exp.is_Integer)


def _decisive(part: sp.Expr) -> Iterator[sp.Expr]:
    if isinstance(part, sp.Piecewise):
        for relation in sorted(part.atoms(Relational), key=sp.default_sort_key):
            yield relation.lhs - relation.rhs
    elif isinstance(part, sp.Max | sp.Min):
        first, *rest = part.args
        for argument in rest:
            yield argument - first
            first = part.func(first, argument)
    else:
        yield part.args[0]


#: Derivatives that are kept.
MOST = 100_000


@lru_cache(MOST)
def derivative(expression: sp.Expr, symbol: sp.Symbol) -> sp.Expr:
    """∂expression/∂symbol, as ``expression.diff(symbol)`` gives it; that of equal parts once.

    SymPy's own collects the symbols of every part of every part, which takes longer than the rest.
    """
    if expression == symbol:
        return sp.S.One
    if not expression.args:
        return sp.S.Zero
    if not isinstance(expression, sp.Add | sp.Mul | sp.Pow | sp.sin | sp.cos):
        return expression.diff(symbol)
    changes = [derivative(part, symbol) for part in expression.args]
    if not any(changes):
        return sp.S.Zero
    if expression.is_Add:
        return sp.Add(*changes)
    if expression.is_Mul:
        parts = expression.args
        terms = [sp.Mul(*parts[:k], d, *parts[k + 1 :]) for k, d in enumerate(changes) if d != 0]
        return sp.Add(*terms)
    if expression.is_Pow:
        base, exponent = expression.args
        growth = changes[1] * sp.log(base) if changes[1] != 0 else sp.S.Zero
        return expression * (growth + changes[0] * exponent / base)
    return expression.fdiff() * changes[0]
