"""Constraints that a document states, such as f = x**2 + y**2 - l**2 = 0 beside λ."""

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass

import sympy as sp

from derive.formulas.expression import FUNCTIONS, parse
from derive.formulas.generic_values import is_small
from derive.formulas.syntax import ExpressionError
from derive.system.symbols import TIME
from derive.verification.documents.formula_translation import RATES
from derive.verification.documents.statements import WORD, DocumentFormula

#: Letters of multipliers, and one that stands for a second of them.
MULTIPLIER, SECOND = re.compile(r"lambda(?:_\w+)?\Z"), "mu"
#: Names of functions that vanish, in documents with multipliers.
NAME = re.compile(r"(?:f|g|h|F|G|C|phi|Phi|psi|Psi|varphi)(?:_\w+)?\Z")
#: Words of sentences that state constraints.
WORDS = re.compile(
    r"constrain|subject to|holonomic|without (?:slip|slid)|no[- ]slip|roll(?:s|ing) condition|"
    r"clos(?:ure|ing|es)|knife|skate|blade",
    re.IGNORECASE,
)
#: Words of sentences that state relations of two coordinates of a body.
ROLLING = re.compile(r"\broll(?:s|ing)?\b", re.IGNORECASE)
#: What a reader can do if constraints are not recognised.
WAY_OUT = "state the system with its constraints by --system FILE"
#: States at which constraints are compared.
STATES = 2


@dataclass(frozen=True)
class StatedConstraint:
    """A formula in letters that remains 0, its coordinates, and the number of its statement."""

    text: str
    coordinates: frozenset[str]
    number: int


def multipliers_of(parameters: Sequence[str]) -> tuple[str, ...]:
    """The letters of multipliers among parameters."""
    result = [name for name in parameters if MULTIPLIER.match(name)]
    if result == ["lambda"] and SECOND in parameters:
        result.append(SECOND)
    return tuple(sorted(result))


def stated_constraints(
    formulas: Sequence[DocumentFormula],
    coordinates: Collection[str],
    parameters: Collection[str],
    multipliers: Collection[str],
    derivatives: Mapping[str, tuple[str, tuple[str, ...]]],
    lengths: Collection[str] = (),
) -> tuple[StatedConstraint, ...]:
    """The constraints of a document; none if it is not certain which they are.

    These are formulas without accelerations in a sentence that calls them constraints, or in a
    document with as many multipliers, and rates of two coordinates times `lengths`.
    """
    letters = {*parameters} - {*multipliers}
    result = [*_possible(formulas, {*coordinates}, letters, {*multipliers}, derivatives)]
    # of several forms of one constraint, multipliers belong to that which is zero
    result.sort(key=lambda one: all(side.text != "0" for side in formulas[one.number].sides))
    named = [
        one for one in result
        if _is_named(formulas[one.number], one) or _is_of_thread(one, {*lengths})
    ]  # fmt: skip
    if not multipliers:
        return tuple(_independent(named))
    groups = (_independent(result), _independent(named))
    return next((tuple(one) for one in groups if len(one) == len(multipliers)), ())


def _is_named(formula: DocumentFormula, one: StatedConstraint) -> bool:
    """Whether the sentence or the form of a formula says that it is a constraint."""
    has_name = len(formula.sides) > 2 and formula.sides[-1].text == "0"
    prose = formula.occurrence.prose
    is_rolling = len(one.coordinates) == 2 and bool(ROLLING.search(prose))
    return has_name or is_rolling or bool(WORDS.search(prose))


def _is_of_thread(one: StatedConstraint, lengths: set[str]) -> bool:
    """Whether it relates the rates of two coordinates by lengths alone, as a thread on a drum."""
    expression, rates = expression_of(one), [symbol(f"{q}_dot") for q in one.coordinates]
    if expression is None or len(rates) != 2:
        return False
    factors = [expression.diff(rate) for rate in rates]
    rest = sp.expand(expression - sp.Add(*map(sp.Mul, factors, rates)))
    names = {str(one) for one in sp.Tuple(*factors).free_symbols}
    return rest == 0 and all(factors) and bool(names) and names <= lengths


def _possible(
    formulas: Sequence[DocumentFormula],
    coordinates: set[str],
    parameters: set[str],
    multipliers: set[str],
    derivatives: Mapping[str, tuple[str, tuple[str, ...]]],
) -> Iterator[StatedConstraint]:
    used = {word for one in formulas if multipliers & {*one.words} for word in one.words}
    functions = used | {derivatives[word][0] for word in used if word in derivatives}
    moving = {q + ending for q in coordinates for ending in RATES[:2]}
    known = moving | parameters | {*FUNCTIONS, "t", "pi"}
    for number, formula in enumerate(formulas):
        text = _body(formula, moving, functions)
        words = {*WORD.findall(text)} - {*FUNCTIONS}
        if not text or formula.is_update or not words <= known or not words & moving:
            continue
        if words & parameters or len(words & moving) > 1 or WORDS.search(formula.occurrence.prose):
            own = frozenset(q for q in coordinates if words & {q, f"{q}_dot"})
            one = StatedConstraint(text, own, number)
            if _is_linear(one):
                yield one


def _body(formula: DocumentFormula, moving: set[str], functions: set[str]) -> str:
    """The expression that remains 0 by a formula of the form of a constraint, or ""."""
    if {*formula.relations} - {"=", ":="} or len(formula.sides) < 2:
        return ""
    first, *others = (side.text for side in formula.sides)
    if first.isidentifier() and first not in moving:  # its name
        is_zero = others[-1] == "0" and len(others) == 2
        is_used = len(others) == 1 and bool(NAME.match(first) or first in functions)
        return others[0] if is_zero or is_used else ""
    if len(others) > 1:
        return ""
    if first == "0":
        first, others = others[0], ["0"]
    return first if others[0] == "0" else f"{first} - ({others[0]})"


def _is_linear(one: StatedConstraint) -> bool:
    """Whether a constraint is one of coordinates, or linear in velocities."""
    expression, rates = expression_of(one), [symbol(f"{q}_dot") for q in one.coordinates]
    if expression is None:
        return False
    return all(map(is_small, sp.hessian(expression, rates)))


def symbol(name: str) -> sp.Symbol:
    """The symbol of a letter in the expressions of constraints."""
    return TIME if name == "t" else sp.Symbol(name, real=True)


def expression_of(one: StatedConstraint) -> sp.Expr | None:
    """The expression of a constraint in letters; None if it has none."""
    words = {*WORD.findall(one.text)} - {*FUNCTIONS, "pi"}
    try:
        value = parse(one.text, {**FUNCTIONS, **{word: symbol(word) for word in words}})
    except (ExpressionError, NotImplementedError, TypeError, ValueError):  # such as of columns
        return None
    return None if isinstance(value, sp.MatrixBase) else value


def rate_of(expression: sp.Expr, coordinates: Collection[str]) -> sp.Expr:
    """The rate of a constraint of coordinates; one of velocities is such a rate itself."""
    if expression.free_symbols & {symbol(f"{q}_dot") for q in coordinates}:
        return expression
    pairs = ((symbol(q), symbol(f"{q}_dot")) for q in coordinates)
    return sp.Add(*(expression.diff(q) * v for q, v in pairs), expression.diff(TIME))


def _independent(result: Sequence[StatedConstraint]) -> list[StatedConstraint]:
    """The constraints without those that follow from earlier ones, by their numbers."""
    every = sorted({q for one in result for q in one.coordinates})
    rates = [symbol(f"{q}_dot") for q in every]
    kept, rows = list[StatedConstraint](), sp.Matrix(0, len(rates), [])
    for one in result:
        expression = expression_of(one)
        assert expression is not None
        row = sp.Matrix([rate_of(expression, every)]).jacobian(rates)
        more = rows.col_join(row)
        names = sorted(more.free_symbols, key=str)
        places = [
            {name: sp.Rational(3 + 2 * k, 7 + 4 * i + k) for k, name in enumerate(names)}
            for i in range(STATES)
        ]
        ranks = [more.xreplace(place).evalf(30).rank(iszerofunc=_is_tiny) for place in places]
        if max(ranks) == more.rows:
            kept, rows = [*kept, one], more
    return sorted(kept, key=lambda one: one.number)


def _is_tiny(value: sp.Expr) -> bool:
    return bool(abs(value) < 1e-20)
