"""Dimensions of the letters of a document, and the formula that contradicts those of all others.

Terms of a sum have the same dimension, and so have the sides of an equation; arguments of sines
have none. These are linear equations for the exponents of mass, length and time of each letter.
Those of masses, gravity, ω and energies are known, and those of coordinates and lengths by their
letters; others follow from the document.
"""

import ast
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction

from derive.formulas.syntax import ExpressionError, summands, syntax_tree
from derive.verification.documents.formula_translation import (
    RATES,
    FormulaText,
    order,
    stem,
)
from derive.verification.documents.letters.letters import ANGLES, MATRICES, Letters
from derive.verification.documents.statements import WORD, DocumentFormula
from derive.verification.judging.verdict import Correction

#: The exponent of each letter in a dimension; those of units are names that no letter has.
Dimension = Mapping[str, Fraction]
MASS, LENGTH, TIME = "[mass]", "[length]", "[time]"
UNITS = (MASS, LENGTH, TIME)
ONE: Dimension = {}
GRAVITY: Dimension = {LENGTH: Fraction(1), TIME: Fraction(-2)}
ENERGY: Dimension = {MASS: Fraction(1), LENGTH: Fraction(2), TIME: Fraction(-2)}
#: Functions of numbers without a dimension.
FUNCTIONS = ("sin", "cos", "tan", "exp", "sinh", "cosh", "tanh", "asin", "acos", "atan")
#: Letters of coordinates and of parameters that are lengths.
COORDINATES, PARAMETERS = ("x", "y", "z", "r", "s"), ("l", "ell")
#: Names of the numbers of a state in programs, whatever they are.
STATE = re.compile(r"[a-zA-Z]+_\d+")
#: A name, perhaps with a square; not that of a function, or with another power.
POWER = re.compile(r"(?<![\w.])(?P<name>[A-Za-z_]\w*)(?![\w(])(?:(?P<square>\*\*2)(?!\d)|(?!\*\*))")
#: The fewest formulas with dimensions.
FEWEST = 2


class _NoDimensionError(ValueError):
    """A formula whose dimensions are not known, such as one with matrices or numbers of units."""


def inhomogeneous_formula(
    letters: Letters,
    formulas: Sequence[DocumentFormula],
    derivatives: Mapping[str, tuple[str, tuple[str, ...]]],
) -> int | None:
    """The number of the one formula whose dimensions contradict those of all others, if any.

    There is none if these contradict each other as well, as without units, or if another formula
    could be the one. A formula whose parameters have no dimension can be one in other units.
    """
    equations = _Equations(letters, formulas, derivatives)
    rows = equations.rows()
    if len(rows) < FEWEST or _pivots(rows.values()) is not None:
        return None
    odd = {
        number: pivots
        for number in rows
        if (pivots := _pivots(own for other, own in rows.items() if other != number)) is not None
    }
    if len(odd) != 1:
        return None
    ((number, pivots),) = odd.items()
    own = (one for one in letters.parameters if one in formulas[number].words)
    dimensions = (_reduced(equations.letter(one), pivots) for one in own)
    has_units = any(one and {*one} <= {*UNITS} for one in dimensions)
    return number if has_units else None


def lost_dots(
    letters: Letters,
    formulas: Sequence[DocumentFormula],
    derivatives: Mapping[str, tuple[str, tuple[str, ...]]],
    number: int,
) -> tuple[Correction, ...]:
    """The rates in place of letters in the last side of a formula that restore its dimensions.

    These are one rate, or those of all letters without dots; none if several would do.
    """
    formula = formulas[number]
    *first, last = formula.sides
    words = {word for one in formulas for word in one.words}
    moving = {*letters.coordinates, *(stem(word) for word in words if order(word))}
    places = [one for one in WORD.finditer(last.text) if stem(one[0]) in moving]
    found: dict[str, tuple[Correction, ...]] = {}
    for chosen in ([one for one in places if not order(one[0])], *([one] for one in places)):
        text, pieces = last.text, list[Correction]()
        for place in reversed(chosen):
            rate = stem(place[0]) + RATES[min(2, order(place[0]) + 1)]
            text = text[: place.start()] + rate + text[place.end() :]
            pieces.append(Correction(place[0], rate, place.span()))
        other = replace(formula, sides=(*first, FormulaText(text)))
        changed = (*formulas[:number], other, *formulas[number + 1 :])
        if _pivots(_Equations(letters, changed, derivatives).rows().values()) is not None:
            found[text] = tuple(pieces[::-1])
    return next(iter(found.values())) if len(found) == 1 and not formula.index else ()


def with_other_powers(
    letters: Letters,
    formulas: Sequence[DocumentFormula],
    derivatives: Mapping[str, tuple[str, tuple[str, ...]]],
    number: int,
) -> Iterator[tuple[DocumentFormula, ...]]:
    """Yield the formulas with a square for a letter, or a letter for a square, in one of them.

    With these, the dimensions of the last side of this formula contradict no others.
    """
    formula = formulas[number]
    *first, last = formula.sides
    for place in POWER.finditer(last.text):
        name = place["name"]
        power = name if place["square"] else f"{name}**2"
        text = f"{last.text[: place.start()]}({power}){last.text[place.end() :]}"
        other = replace(formula, sides=(*first, FormulaText(text)))
        changed = (*formulas[:number], other, *formulas[number + 1 :])
        if _pivots(_Equations(letters, changed, derivatives).rows().values()) is not None:
            yield changed


class _Equations:
    """The linear equations for the dimensions of a document's letters."""

    def __init__(
        self,
        letters: Letters,
        formulas: Sequence[DocumentFormula],
        derivatives: Mapping[str, tuple[str, tuple[str, ...]]],
    ) -> None:
        self._known: dict[str, Dimension] = {"t": {TIME: Fraction(1)}, "pi": ONE}
        for name in letters.of_kind("mass"):
            self._known[name] = {MASS: Fraction(1)}
        for name in letters.of_kind("gravity"):
            if name.startswith("g"):  # G is the constant of gravitation
                self._known[name] = GRAVITY
        for name in (*letters.coordinates, *letters.parameters):
            letter, is_coordinate = name.partition("_")[0], name in letters.coordinates
            if is_coordinate and letters.are_of_program and STATE.fullmatch(name):
                continue
            if letter in (COORDINATES if is_coordinate else PARAMETERS):
                self._known[name] = {LENGTH: Fraction(1)}
            elif is_coordinate and letter in ANGLES and letter != "q":
                self._known[name] = ONE
        for name in {stem(word) for formula in formulas for word in formula.words}:
            if name.lower().startswith("omega"):
                self._known[name] = {TIME: Fraction(-1)}
        for name, kind in letters.quantities.items():
            if kind not in MATRICES.values():
                self._known[name] = ENERGY
        self._formulas, self._derivatives = formulas, derivatives
        self._are_of_program = letters.are_of_program
        self._equal: list[Dimension] = []

    def rows(self) -> dict[int, list[Dimension]]:
        """The equations of each formula with any: dimensions that vanish."""
        result: dict[int, list[Dimension]] = {}
        for number, formula in enumerate(self._formulas):
            if {*formula.relations} - {"=", ":="} or len(formula.sides) < 2:
                continue
            self._equal = []
            try:
                trees = [syntax_tree(side.text) for side in formula.sides]
                if not any(isinstance(one, ast.Constant) and one.value for one in trees):
                    self._sum(trees)
            except (_NoDimensionError, ExpressionError):
                continue
            if self._equal:
                result[number] = self._equal
        return result

    def _sum(self, terms: Sequence[ast.expr]) -> Dimension | None:
        """The dimension of terms, which have the same; None of zero, which has any.

        A number that a program adds, such as a constant force, can have any unit as well.
        """
        if self._are_of_program:
            terms = [one for one in terms if any(isinstance(x, ast.Name) for x in ast.walk(one))]
        known = [one for term in terms if (one := self._dimension(term)) is not None]
        self._equal += [_product(one, known[0], -1) for one in known[1:]]
        return known[0] if known else None

    def _number(self, node: ast.expr) -> None:
        """Require that an expression has no dimension."""
        if own := self._dimension(node):
            self._equal.append(own)

    def _dimension(self, node: ast.expr) -> Dimension | None:
        match node:
            case ast.Constant(value=value):
                if isinstance(value, float) and not (8 * value).is_integer():
                    raise _NoDimensionError  # as 9.81
                return ONE if value else None
            case ast.Name(id=name):
                return self.letter(name)
            case ast.UnaryOp(operand=operand):
                return self._dimension(operand)
            case ast.BinOp(op=ast.Add() | ast.Sub()):
                return self._sum([term for term, _ in summands(node)])
            case ast.BinOp(left=left, op=ast.Mult() | ast.Div() as operation, right=right):
                one, other = self._dimension(left), self._dimension(right)
                if one is None or other is None:
                    return None
                return _product(one, other, 1 if isinstance(operation, ast.Mult) else -1)
            case ast.BinOp(left=left, op=ast.Pow(), right=right):
                return self._power(left, right)
            case ast.Call(func=ast.Name(id="sqrt"), args=[argument]):
                return _product(ONE, self._dimension(argument) or ONE, Fraction(1, 2))
            case ast.Call(func=ast.Name(id="ddt"), args=[argument]):
                return _product(self._dimension(argument) or ONE, {TIME: Fraction(-1)})
            case ast.Call(func=ast.Name(id="diff"), args=[one, other]):
                return _product(self._dimension(one) or ONE, self._dimension(other) or ONE, -1)
            case ast.Call(func=ast.Name(id="log"), args=[argument]):
                self._dimension(argument)  # log(x/a) can stand as log(x) - log(a)
                return ONE
            case ast.Call(func=ast.Name(id=name), args=[argument]) if name in FUNCTIONS:
                self._number(argument)
                return ONE
        raise _NoDimensionError

    def _power(self, base: ast.expr, exponent: ast.expr) -> Dimension:
        own = self._dimension(base) or ONE
        try:
            return _product(ONE, own, Fraction(ast.unparse(exponent).strip("()").replace(" ", "")))
        except (ValueError, ZeroDivisionError):  # a letter, or no number
            self._number(base)
            self._number(exponent)
            return ONE

    def letter(self, name: str) -> Dimension:
        """The dimension of a name, which can contain those of letters."""
        if name in self._derivatives:
            operand, variables = self._derivatives[name]
            result = self.letter(operand)
            for variable in variables:
                result = _product(result, self.letter(variable), -1)
            return result
        if name.endswith("_column"):
            raise _NoDimensionError
        own = self._known.get(stem(name), {stem(name): Fraction(1)})
        return _product(own, {TIME: Fraction(-order(name))})


def _product(one: Dimension, other: Dimension, exponent: int | Fraction = 1) -> Dimension:
    """The dimension of a product of one with a power of another."""
    result = dict(one)
    for name, number in other.items():
        result[name] = result.get(name, Fraction(0)) + number * exponent
    return {name: number for name, number in result.items() if number}


def _pivots(groups: Iterable[Sequence[Dimension]]) -> dict[str, Dimension] | None:
    """The products that determine a letter each; None if not all products can have no dimension."""
    pivots: dict[str, Dimension] = {}
    for one in (one for group in groups for one in group):
        row = _reduced(one, pivots)
        own = [name for name in row if name not in UNITS]
        if row and not own:
            return None
        if own:
            pivots[own[0]] = row
    return pivots


def _reduced(row: Dimension, pivots: Mapping[str, Dimension]) -> Dimension:
    """A dimension without the letters that products without dimension determine."""
    for letter, pivot in pivots.items():
        if letter in row:
            row = _product(row, pivot, -row[letter] / pivot[letter])
    return row
