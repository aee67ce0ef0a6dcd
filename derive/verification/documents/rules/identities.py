"""Formulas that follow from definitions of a document alone, whatever the motion is.

These are chains such as f = ω/(2π) = √(k/m)/(2π), and velocities and accelerations by unit vectors
of polar coordinates.
"""

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cached_property

import sympy as sp

from derive.formulas.expression import FUNCTIONS, Value, parse
from derive.formulas.generic_values import is_small
from derive.formulas.syntax import ExpressionError
from derive.mechanics.derivation import Derivation
from derive.reading.latex.tree import Application, Letter, nodes
from derive.system.parts import Coordinate, Parameter, SystemDefinitionError
from derive.system.symbols import TIME, acceleration, velocity
from derive.system.system import System
from derive.verification.documents.formula_translation import RATES, identifier, order, stem
from derive.verification.documents.letters.energies import StatedInertia
from derive.verification.documents.letters.stated_positions import axis_of
from derive.verification.documents.rules.side_verdict import SideVerdict, plain
from derive.verification.documents.rules.small_motions import has_initial_values
from derive.verification.documents.statements import (
    WORD,
    Derivatives,
    DocumentFormula,
    definitions,
)
from derive.verification.judging.engine import joined
from derive.verification.judging.reference_system import ReferenceSystem
from derive.verification.quantity_verdicts import judge_formula

#: Unit vectors of polar coordinates, along r and along an angle.
UNIT = re.compile(r"(?:(?:e|ehat|u|uhat)_([a-zA-Z]+)|([a-zA-Z]+)hat)(?:_column)?\Z")
RADII, ANGLES = ("r", "R", "rho", "s"), ("theta", "phi", "varphi", "alpha", "vartheta")
#: A component of a vector, such as v_theta.
COMPONENT = re.compile(r"(\w+)_([a-zA-Z]+)\Z")
#: Vectors that are rates of others.
RATE_OF = {"v_column": "r_column", "a_column": "v_column", "vbar": "rbar", "abar": "vbar"}
#: The name of the value that a side must have.
REQUIRED = "required"
#: What cannot be computed.
ERRORS = (ExpressionError, NotImplementedError, TypeError, ValueError, IndexError)


class Identities:
    """The formulas of a document as identities in letters, which may be any functions of time."""

    def __init__(
        self,
        formulas: Sequence[DocumentFormula],
        derivatives: Derivatives,
        left: Collection[DocumentFormula],
    ) -> None:
        self._formulas, self._derivatives, self._left = formulas, derivatives, left
        words = {word for one in formulas for word in one.words}
        self._moving = {stem(word) for word in words if order(word)}
        matches = {name: match for name in map(stem, words) if (match := UNIT.match(name))}
        units = {name: match[1] or match[2] for name, match in matches.items()}
        axes = {name: axis for name in map(stem, words) if (axis := axis_of(name)) is not None}
        turned = {one.subject for one in formulas if {*axes} & {*one.words}}  # by their definitions
        angles = {one for one in units.values() if one in ANGLES}
        #: Unit vectors, and those that belong to components such as v_r.
        self._values: dict[str, Value] = {
            name: sp.ImmutableDenseMatrix([int(i == axis) for i in range(3)])
            for name, axis in axes.items()
        }
        self._axes = {*axes}
        self._units = {letter: name for name, letter in units.items()}
        if len(angles) == 1:
            angle = self._symbol(*angles)
            rest = [0] * (bool(axes) or "cross" in words)
            radial = sp.ImmutableDenseMatrix([sp.cos(angle), sp.sin(angle), *rest])
            for name, letter in units.items():
                if letter in (*RADII, *angles) and name not in turned:
                    self._values[name] = radial if letter in RADII else radial.diff(angle)
        #: Names with the texts that define them, at each formula those before it.
        self._texts: dict[str, str] = {}

    def verdicts(self) -> Iterator[tuple[DocumentFormula, SideVerdict]]:
        """Yield the formulas that hold, the definitions that they use, and contradictions.

        A side is wrong if it has the letters of the side before it, and each name in both has a
        single definition, by which other formulas hold, or which has initial values.
        """
        confirmed, failed = set[str](), list[tuple[DocumentFormula, set[str], int]]()
        defining: dict[str, list[DocumentFormula]] = {}
        verified: list[DocumentFormula] = []
        for formula in self._formulas:
            results = [*self._compared(formula)] if formula in self._left else []
            used = {name for _, names in results for name in names}
            if results and all(holds for holds, _ in results):
                confirmed |= {*used, formula.subject}
                verified.append(formula)
            elif False in (kinds := [holds for holds, _ in results]):
                failed.append((formula, used, kinds.index(False)))
            for name, text in definitions(formula):
                is_place = formula.is_value and name in self._moving
                if not order(name) and name not in WORD.findall(text) and not is_place:
                    self._texts[name] = text
                    own = defining.setdefault(name, [])
                    if formula not in own and (formula not in verified or not own):
                        own.append(formula)
        wrong = [formula for formula, *_ in failed]
        defining = {name: [f for f in own if f not in wrong] for name, own in defining.items()}
        single = {name: own[0] for name, own in defining.items() if len(own) == 1}
        confirmed |= {*self._axes}
        for name in sorted(confirmed & {*single}):
            yield single[name], plain("definition", single[name], "others follow from it")
        for formula in verified:
            yield formula, plain("verified", formula, "it follows whatever the motion is")
        for formula, used, number in failed:
            confirmed |= {*filter(self._has_initial_values, used & {*single})}
            defined = used - {*self._derivatives}
            if used and used <= confirmed and defined <= {*single, *self._values}:
                note = f"it contradicts the definition of {', '.join(sorted(defined))}"
                yield formula, self._wrong(formula, number, note)

    def _has_initial_values(self, name: str) -> bool:
        """Whether a name is a function of time of which value and rate at 0 are letters."""
        with suppress(*ERRORS):
            value = self._value(name)
            return not isinstance(value, sp.MatrixBase) and has_initial_values(value)
        return False

    def multiples(self) -> Iterator[tuple[DocumentFormula, SideVerdict]]:
        """Yield chains of three sides or more of which one is the side before it times a number."""
        for formula in self._formulas:
            if (number := self._multiple(formula)) is not None:
                yield formula, self._wrong(formula, number, "two of its sides differ by a factor")

    def _multiple(self, formula: DocumentFormula) -> int | None:
        """The number of a side in a chain of which the next one is a multiple by a number."""
        if len(formula.sides) < 3 or formula.index or any(one.text == "0" for one in formula.sides):
            return None
        letters = {word: self._symbol(word) for word in formula.words}  # whatever defines them
        for number, sides in enumerate(zip(formula.sides, formula.sides[1:], strict=False)):
            with suppress(*ERRORS):
                left, right = (parse(side.text, {**FUNCTIONS, **letters}) for side in sides)
                ratio = sp.simplify(left / right) if left.free_symbols else sp.S.One
                if ratio.is_Rational and ratio not in (0, 1):
                    return number
        return None

    def _wrong(self, formula: DocumentFormula, number: int, note: str) -> SideVerdict:
        """The verdict on a formula whose sides with this number and the next are not equal.

        With a correction of the second one if it is no column.
        """
        result, side = plain("wrong", formula, note), formula.sides[number + 1]
        with suppress(*ERRORS, SystemDefinitionError):
            words = {*WORD.findall(side.text)} - {*FUNCTIONS}
            names = {word: self._name(word, 0) for word in words}
            names[REQUIRED] = self._value(formula.sides[number].text)
            verdict = judge_formula(self._model(names), "", side.text, "value", REQUIRED)
            if verdict.verdict == "wrong" and verdict.corrections:
                verdict = replace(verdict, note=joined(verdict.note, note))
                return SideVerdict(verdict, ((0, side),), "value")
        return result

    def _model(self, names: Mapping[str, Value]) -> ReferenceSystem:
        """Names as those of a system that has the moving letters as coordinates, or any letter."""
        symbols = sorted(sp.Tuple(*names.values()).free_symbols - {TIME}, key=str)
        moving = {stem(one.name) for one in symbols if stem(one.name) in self._moving}
        moving = moving or {stem(one.name) for one in symbols[:1]}
        q = {name: sp.Symbol(name, real=True) for name in sorted(moving)}
        orders = (lambda one: one), velocity, acceleration
        own = {
            one: orders[order(one.name)](q[stem(one.name)])
            for one in symbols
            if stem(one.name) in moving
        }
        origin, inertia = (sp.S.Zero, sp.S.Zero), sp.ImmutableDenseMatrix(sp.eye(len(q)))
        system = System(
            "definitions", "Definitions", [Coordinate(one, "1", "a letter") for one in q.values()],
            [Parameter(one, "1", 1.0, "a letter") for one in symbols if one not in own],
            [StatedInertia(sp.S.One, origin, inertia)], gravity=origin,
        )  # fmt: skip
        values = {name: value.xreplace(own) for name, value in names.items()}
        return ReferenceSystem(Derivation(system), values)

    def _compared(self, formula: DocumentFormula) -> Iterator[tuple[bool | None, set[str]]]:
        """Yield whether neighbouring sides are equal, and the names whose definitions they use.

        None is for sides that can be equal along a motion; nothing for a definition.
        """
        if {*formula.relations} - {"=", ":="}:
            return
        for one, other in zip(formula.sides, formula.sides[1:], strict=False):
            written = {w for side in (one, other) for w in WORD.findall(side.text)}
            partial = {w: self._derivatives[w][0] for w in written if self._is_partial(w)}
            words = {*map(stem, written - {*partial}), *partial.values()}
            used = words & {*self._values, *self._texts} | {*partial}
            used |= {known for word in words if (known := self._column(word) or self._place(word))}
            texts = one.text, other.text
            is_definition = any(
                text.isidentifier() and not order(text) and text not in partial for text in texts
            )
            holds: bool | None = None
            try:
                left, right = map(self._value, texts)
                is_zero = isinstance(left, sp.MatrixBase) and right == 0
                rest = left if is_zero else left - right
                holds = all(map(is_small, rest if isinstance(rest, sp.MatrixBase) else [rest]))
                if not holds and (not used or _letters(left) != _letters(right)):
                    holds = None
            except ERRORS:
                pass
            is_known = holds is False and texts[0] in RATE_OF  # the rate of a vector, or another
            is_shown = holds and texts[0] != texts[1] and (used or "ddt" in words)
            if not is_definition or is_known or is_shown:
                yield holds, used

    def _value(self, text: str, depth: int = 0) -> Value:
        functions = {
            **FUNCTIONS,
            "ddt": self._rate,
            "cross": lambda one, other: one.cross(other),
            "norm": lambda one: sp.sqrt(one.dot(one)),
            "transpose": lambda one: one.T,
        }
        words = {*WORD.findall(text)} - {*functions}
        return parse(text, {**functions, **{word: self._name(word, depth) for word in words}})

    def _name(self, word: str, depth: int) -> Value:
        """The value of a name: that of its definition, or a symbol."""
        name = stem(word)
        if depth > len(self._texts):
            raise ExpressionError("names define one another")
        if self._is_partial(word):
            operand, variables = self._derivatives[word]
            value, by = self._name(operand, depth + 1), [*map(self._symbol, variables)]
            if value.free_symbols.isdisjoint(by) and (operand, variables[0]) in self._arguments:
                raise ExpressionError(f"{word} is a derivative along the motion")
            return value.diff(*by)
        value = self._values.get(name)
        if value is None and name in self._texts and self._texts[name] != "0":
            value = self._value(self._texts[name], depth + 1)
        if value is None and (place := self._place(name)):
            value = self._rate(self._name(place, depth + 1))
        if value is None and (column := self._column(name)):
            unit = self._units[name.removeprefix(column.removesuffix("column"))]
            vector, direction = (self._name(one, depth + 1) for one in (column, unit))
            if not isinstance(vector, sp.MatrixBase) or not isinstance(direction, sp.MatrixBase):
                raise ExpressionError(f"{name} is the component of a vector that is not known")
            value = vector.dot(direction)
        if value is None:
            return TIME if word == "t" else self._symbol(word)
        for _ in range(order(word)):
            value = self._rate(value)
        return value

    @cached_property
    def _arguments(self) -> set[tuple[str, str]]:
        """Names and letters of which they are written as functions, such as u and θ of u(θ)."""
        trees = (side for one in self._formulas for side in one.occurrence.sides)
        return {
            (identifier(node.head), identifier(one))
            for node in nodes(tuple(trees))
            if isinstance(node, Application) and isinstance(node.head, Letter)
            for one in node.arguments
            if isinstance(one, Letter)
        }

    def _is_partial(self, name: str) -> bool:
        """Whether a name is a partial derivative of another that has a definition."""
        operand, variables = self._derivatives.get(name, ("", ()))
        return operand in self._texts and not {*map(stem, variables)} & {*self._texts, "t"}

    def _column(self, name: str) -> str:
        """The known vector of which a name is the component along a unit vector, or ""."""
        match = COMPONENT.match(name)
        column = f"{match[1]}_column" if match and match[2] in self._units else ""
        return column if column in self._texts and name not in self._texts else ""

    def _place(self, name: str) -> str:
        """The known vector of which a name without a definition is the rate, or ""."""
        place = RATE_OF.get(name, "")
        return place if place in self._texts and name not in self._texts else ""

    def _symbol(self, word: str) -> sp.Symbol:
        is_moving = stem(word) in self._moving
        return sp.Symbol(word, real=True) if is_moving else sp.Symbol(word, positive=True)

    def _rate(self, value: Value) -> Value:
        result = value.diff(TIME)
        for one in value.free_symbols:
            name = stem(one.name)
            if name in self._moving:
                result += value.diff(one) * self._symbol(name + RATES[order(one.name) + 1])
        return result


def _letters(value: Value) -> set[sp.Symbol]:
    """The letters on which a value depends, without those that drop out."""
    entries = [*value] if isinstance(value, sp.MatrixBase) else [value]
    return {
        letter
        for letter in value.free_symbols
        if not all(is_small(one.diff(letter)) for one in entries)
    }
