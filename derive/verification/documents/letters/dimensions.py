"""Dimensions of the letters of a document, and formulas that contradict those of all others.

Terms of a sum have the same dimension, and so have the sides of an equation; arguments of sines
have none. These are linear equations for the exponents of mass, length and time of each letter.
Those of masses, gravity, ω and energies are known, and those of coordinates and lengths by their
letters; others follow from the document.
"""

import ast
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from derive.formulas.syntax import ExpressionError, is_sum, place, summands, syntax_tree
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
#: A name, perhaps with a power; not that of a function.
FACTOR = re.compile(
    r"(?<![\w.])(?P<name>[A-Za-z_]\w*)(?![\w(])(?:\*\*(?P<power>\d)(?![\w.])|(?!\*\*))"
)
#: The sign and the number at the start of a term.
NUMBER = re.compile(r"-?(?:[\d./]+\*)?")
#: The fewest formulas with dimensions, and the most that contradict all others.
FEWEST, MOST_ODD = 2, 3
#: Whether a formula has no contradictory dimensions with another text of one of its sides.
Homogeneity = Callable[[int, str], bool]


@dataclass(frozen=True)
class Restoration:
    """Corrections in one side of a formula that restore its dimensions."""

    side: int
    #: A correct term is empty if several are possible.
    corrections: tuple[Correction, ...]
    #: The terms that can be correct, if several can.
    choices: tuple[str, ...] = ()


class _NoDimensionError(ValueError):
    """A formula whose dimensions are not known, such as one with matrices or numbers of units."""


def inhomogeneous_formulas(
    letters: Letters,
    formulas: Sequence[DocumentFormula],
    derivatives: Mapping[str, tuple[str, tuple[str, ...]]],
    elsewhere: Collection[DocumentFormula] = (),
) -> dict[int, Restoration | None]:
    """The fewest formulas whose dimensions contradict those of all others, by their numbers.

    There are none if as many others could be those, if a formula can be one in other units, as its
    parameters have no dimension, or if they alone agree with formulas `elsewhere` in the document.
    Of several, each has corrections, and no letter can have another meaning in them.
    """
    outside = {stem(word) for one in elsewhere for word in one.words if order(word)}
    outside -= {stem(word) for one in formulas for word in one.words}
    whole = replace(letters, coordinates=(*letters.coordinates, *sorted(outside)))
    equations = _Equations(whole, formulas, derivatives)
    rows = equations.rows()
    if len(rows) < FEWEST or _pivots(rows.values()) is not None:
        return {}
    sizes = ({*_removable(rows, count)} for count in range(1, MOST_ODD + 1))
    sets = next(filter(None, sizes), set[frozenset[int]]())
    if len(sets) != 1:
        return {}
    (odd,) = sets
    pivots = _pivots(own for number, own in rows.items() if number not in odd) or {}
    further = [*map(equations.row, elsewhere)]
    if _pivots(further, pivots) is None and _agree(further, (rows[number] for number in odd)):
        return {}
    shared = {*letters.parameters}.intersection(*(formulas[number].words for number in odd))
    if len(odd) > 1 and any(
        _pivots(equations.with_other_letter(one, odd).values()) is not None for one in shared
    ):
        return {}
    for number in odd:
        own = (one for one in letters.parameters if one in formulas[number].words)
        dimensions = (_reduced(equations.letter(one), pivots) for one in own)
        if not any(one and {*one} <= {*UNITS} for one in dimensions):
            return {}
    result = {k: _restoration(letters, formulas[k], equations, pivots) for k in sorted(odd)}
    return result if len(odd) == 1 or all(result.values()) else {}


def _removable(rows: Mapping[int, Sequence[Dimension]], count: int) -> Iterator[frozenset[int]]:
    """Yield the sets of so many formulas without which no dimensions contradict each other."""
    if _pivots(rows.values()) is not None:
        yield frozenset()
    elif count:
        for number in _conflict(rows):
            others = {k: own for k, own in rows.items() if k != number}
            yield from (odd | {number} for odd in _removable(others, count - 1))


def _agree(groups: Sequence[Sequence[Dimension]], others: Iterable[Sequence[Dimension]]) -> bool:
    """Whether no dimensions of two groups contradict each other."""
    pivots = _pivots(groups)
    return pivots is not None and _pivots(others, pivots) is not None


def _conflict(rows: Mapping[int, Sequence[Dimension]]) -> list[int]:
    """Formulas that contradict each other, but not without one of them."""
    numbers = [*rows]
    for number in rows:
        others = [k for k in numbers if k != number]
        if _pivots(rows[k] for k in others) is None:
            numbers = others
    return numbers


def _restoration(
    letters: Letters,
    formula: DocumentFormula,
    equations: "_Equations",
    others: Mapping[str, Dimension],
) -> Restoration | None:
    """What restores the dimensions of an inhomogeneous formula, if any is known.

    It changes the power or the rate of a letter in a term, or adds a factor of all other terms, if
    one term alone can be wrong so. If no term differs from the others, it has rates in place of
    letters of the last side.
    """
    if formula.index:
        return None

    def is_homogeneous(side: int, text: str) -> bool:
        sides = (*formula.sides[:side], FormulaText(text), *formula.sides[side + 1 :])
        return _pivots([equations.row(replace(formula, sides=sides))], others) is not None

    moving = {*letters.coordinates, *equations.moving}
    odd = [*_odd_terms(formula, is_homogeneous)]
    if not odd:
        return _lost_dots(letters, formula, moving, is_homogeneous)
    restorations = []
    for side, span, beside in odd:
        text = formula.sides[side].text
        changes = (*_changes(text, span, letters, moving), *_lost_factors(text, span, beside))
        found = [one for one in changes if is_homogeneous(side, one.applied(text))]
        terms = [one.widened(text, span) for one in found]
        if len(terms) == 1:
            restorations.append(Restoration(side, (*terms,)))
        elif terms:
            choices = tuple(one.correct for one in terms)
            restorations.append(Restoration(side, (replace(terms[0], correct=""),), choices))
    return restorations[0] if len(restorations) == 1 else None


def _lost_dots(
    letters: Letters,
    formula: DocumentFormula,
    moving: Collection[str],
    is_homogeneous: Homogeneity,
) -> Restoration | None:
    """The only rates in the last side that restore the dimensions: one, or all without dots.

    A letter of an energy with a product of rates can be another quantity.
    """
    last = formula.sides[-1]
    if formula.subject in letters.quantities and any(map(order, WORD.findall(last.text))):
        return None
    words = [one for one in WORD.finditer(last.text) if stem(one[0]) in moving]
    found: dict[str, tuple[Correction, ...]] = {}
    for chosen in ([one for one in words if not order(one[0])], *([one] for one in words)):
        text, pieces = last.text, list[Correction]()
        for word in reversed(chosen):
            rate = stem(word[0]) + RATES[min(2, order(word[0]) + 1)]
            pieces.append(Correction(word[0], rate, word.span()))
            text = pieces[-1].applied(text)
        if is_homogeneous(len(formula.sides) - 1, text):
            found[text] = tuple(pieces[::-1])
    if len(found) != 1:
        return None
    return Restoration(len(formula.sides) - 1, next(iter(found.values())))


def _odd_terms(
    formula: DocumentFormula, is_homogeneous: Homogeneity
) -> Iterator[tuple[int, tuple[int, int], list[str]]]:
    """Yield the terms of sums without which a formula is homogeneous, none with another in it.

    A term is the number of its side and its place, with the other terms of its sum.
    """
    for number, side in enumerate(formula.sides):
        text = side.text
        sums: dict[tuple[int, int], list[str]] = {}
        for node in ast.walk(syntax_tree(text)):  # from the outside
            if isinstance(node, ast.expr) and is_sum(node):
                spans = [place(text, term) for term, _ in summands(node)]
                for a, b in spans:
                    others = [text[slice(*one)] for one in spans if one != (a, b)]
                    if is_homogeneous(number, f"{text[:a]}0{text[b:]}"):
                        sums.setdefault((a, b), others)
        for a, b in sorted(sums):
            if not any(a <= c and d <= b and (a, b) != (c, d) for c, d in sums):
                yield number, (a, b), sums[a, b]


def _lost_factors(text: str, span: tuple[int, int], others: Sequence[str]) -> Iterator[Correction]:
    """Yield a term with a letter that all others of its sum have, two at least."""
    term = text[slice(*span)]
    letters = [{*WORD.findall(one)} - {*FUNCTIONS} for one in others]
    common = set.intersection(*letters) if len(letters) > 1 else set[str]()
    number = NUMBER.match(term)
    start = span[0] + (number.end() if number else 0)
    for name in sorted(common.difference(WORD.findall(term))):
        yield Correction("", f"{name}*", (start, start))


def _changes(
    text: str, span: tuple[int, int], letters: Letters, moving: Collection[str]
) -> Iterator[Correction]:
    """Yield another power or rate of each letter of a term."""
    own = {*letters.coordinates, *letters.parameters, *letters.momenta}
    for one in _other_powers(text, span):
        if stem(one.wrong.partition("**")[0]) in own:
            yield one
    for word in WORD.finditer(text, *span):
        if stem(word[0]) in moving:
            near = (order(word[0]) - 1, order(word[0]) + 1)
            for k in (k for k in near if k in range(3)):
                yield Correction(word[0], stem(word[0]) + RATES[k], word.span())


def with_other_powers(
    letters: Letters,
    formulas: Sequence[DocumentFormula],
    derivatives: Mapping[str, tuple[str, tuple[str, ...]]],
    number: int,
) -> Iterator[tuple[DocumentFormula, ...]]:
    """Yield the formulas with the next power of a letter in one of them.

    With these, the dimensions of the last side of this formula contradict no others.
    """
    formula = formulas[number]
    *first, last = formula.sides
    for one in _other_powers(last.text, (0, len(last.text))):
        other = replace(formula, sides=(*first, FormulaText(one.applied(last.text))))
        changed = (*formulas[:number], other, *formulas[number + 1 :])
        if _pivots(_Equations(letters, changed, derivatives).rows().values()) is not None:
            yield changed


def _other_powers(text: str, span: tuple[int, int]) -> Iterator[Correction]:
    """Yield the names in a part of a text with the next powers."""
    for one in FACTOR.finditer(text, *span):
        power = int(one["power"] or 1)
        for other in (power + 1, power - 1)[: 1 + (power > 1)]:
            new = one["name"] if other == 1 else f"{one['name']}**{other}"
            yield Correction(one[0], new, one.span())


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
            if not name.startswith("mu"):  # which can be that of gravity, or of friction
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
        words = {word for formula in formulas for word in formula.words}
        #: Letters of which there is a rate.
        self.moving = {stem(word) for word in words if order(word)}
        for name in map(stem, words):
            if name.lower().startswith("omega"):
                self._known[name] = {TIME: Fraction(-1)}
        for name, kind in letters.quantities.items():
            if kind not in MATRICES.values():
                self._known[name] = ENERGY
        self._formulas, self._derivatives = formulas, derivatives
        self._letters = letters
        self._equal: list[Dimension] = []

    def rows(self) -> dict[int, list[Dimension]]:
        """The equations of each formula with any."""
        rows = {number: self.row(formula) for number, formula in enumerate(self._formulas)}
        return {number: own for number, own in rows.items() if own}

    def with_other_letter(self, name: str, numbers: Collection[int]) -> dict[int, list[Dimension]]:
        """The equations with another letter in place of one in some formulas."""
        rows = self.rows()
        for number in numbers:
            formula = self._formulas[number]
            texts = [re.sub(rf"\b{name}\b", f"{name}_other", side.text) for side in formula.sides]
            rows[number] = self.row(replace(formula, sides=tuple(map(FormulaText, texts))))
        return rows

    def row(self, formula: DocumentFormula) -> list[Dimension]:
        """The equations of a formula: dimensions that vanish."""
        if {*formula.relations} - {"=", ":="} or len(formula.sides) < 2:
            return []
        if self._letters.reused(formula):
            return []
        self._equal = []
        try:
            trees = [syntax_tree(side.text) for side in formula.sides]
            if not any(isinstance(one, ast.Constant) and one.value for one in trees):
                self._sum(trees)
        except (_NoDimensionError, ExpressionError):
            return []
        return self._equal

    def _sum(self, terms: Sequence[ast.expr]) -> Dimension | None:
        """The dimension of terms, which have the same; None of zero, which has any.

        A number that a program adds, such as a constant force, can have any unit as well.
        """
        if self._letters.are_of_program:
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


def _pivots(
    groups: Iterable[Sequence[Dimension]], known: Mapping[str, Dimension] | None = None
) -> dict[str, Dimension] | None:
    """The products that determine a letter each; None if not all products can have no dimension.

    Those in `known` come first.
    """
    pivots = dict(known or {})
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
