"""Formulas that follow from definitions of a document alone, whatever the motion is.

These are chains such as f = ω/(2π) = √(k/m)/(2π), and velocities and accelerations by unit vectors
of polar coordinates.
"""

import re
from collections.abc import Iterator, Sequence

import sympy as sp

from derive.formulas.evaluation.generic_values import is_small
from derive.formulas.expression import FUNCTIONS, Value, parse
from derive.formulas.syntax import ExpressionError
from derive.system.symbols import TIME
from derive.verification.documents.rules.side_verdict import SideVerdict, plain
from derive.verification.documents.statements import WORD, DocumentFormula, definitions
from derive.verification.documents.text import RATES, order, stem

#: Unit vectors of polar coordinates, along r and along an angle.
UNIT = re.compile(r"(?:(?:e|ehat|u|uhat)_([a-zA-Z]+)|([a-zA-Z]+)hat)(?:_column)?\Z")
RADII, ANGLES = ("r", "R", "rho", "s"), ("theta", "phi", "varphi", "alpha", "vartheta")
#: What cannot be computed.
ERRORS = (ExpressionError, NotImplementedError, TypeError, ValueError, ZeroDivisionError)


class Identities:
    """The formulas of a document as identities in letters, which may be any functions of time."""

    def __init__(self, formulas: Sequence[DocumentFormula]) -> None:
        self._formulas = formulas
        words = {word for one in formulas for word in one.words}
        self._moving = {stem(word) for word in words if order(word)}
        units = {name: match[1] or match[2] for name in map(stem, words)
                 if (match := UNIT.match(name))}  # fmt: skip
        angles = {one for one in units.values() if one in ANGLES}
        self._values: dict[str, Value] = {}
        if len(angles) == 1:
            angle = self._symbol(*angles)
            radial = sp.ImmutableDenseMatrix([sp.cos(angle), sp.sin(angle)])
            for name, letter in units.items():
                if letter in (*RADII, *angles):
                    self._values[name] = radial if letter in RADII else radial.diff(angle)
        #: Names with the texts that define them, at each formula those before it.
        self._texts: dict[str, str] = {}

    def verdicts(self) -> Iterator[tuple[DocumentFormula, SideVerdict]]:
        """Yield the formulas that hold, the definitions that they use, and contradictions.

        A side is wrong if it has the letters of the side before it, and if other formulas hold by
        each of the definitions that both contain, of which there is one for each name.
        """
        confirmed, failed = set[str](), list[tuple[DocumentFormula, set[str]]]()
        defining: dict[str, list[DocumentFormula]] = {}
        verified: list[DocumentFormula] = []
        for formula in self._formulas:
            if {*formula.relations} <= {"=", ":="}:
                results = [*self._compared(formula)]
                used = {name for _, names in results for name in names}
                if results and all(holds for holds, _ in results):
                    confirmed |= used
                    verified.append(formula)
                elif any(holds is False for holds, _ in results):
                    failed.append((formula, used))
            for name, text in definitions(formula):
                if not order(name) and name not in WORD.findall(text):
                    self._texts[name] = text
                    own = defining.setdefault(name, [])
                    if formula not in own and (formula not in verified or not own):
                        own.append(formula)
        single = {name: own[0] for name, own in defining.items() if len(own) == 1}
        for name in sorted(confirmed & {*single}):
            yield single[name], plain("definition", single[name], "others follow from it")
        for formula in verified:
            yield formula, plain("verified", formula, "it follows whatever the motion is")
        for formula, used in failed:
            if used and used <= confirmed and used <= {*single, *self._values}:
                lines = sorted({single[name].occurrence.line for name in used & {*single}})
                note = f"it contradicts line {', '.join(map(str, lines))}" if lines else ""
                yield formula, plain("wrong", formula, note or "it contradicts its unit vectors")

    def _compared(self, formula: DocumentFormula) -> Iterator[tuple[bool | None, set[str]]]:
        """Yield whether neighbouring sides are equal, and the names whose definitions they use.

        None is for sides that can be equal along a motion; nothing for a definition.
        """
        names = {*self._values, *self._texts}
        for one, other in zip(formula.sides, formula.sides[1:], strict=False):
            words = {stem(w) for side in (one, other) for w in WORD.findall(side.text)}
            is_definition = any(
                side.text.isidentifier() and not order(side.text) for side in (one, other)
            )
            used = words & names
            try:
                left, right = (self._value(side.text) for side in (one, other))
                difference = left - right
                entries = [*difference] if isinstance(difference, sp.MatrixBase) else [difference]
                holds = all(map(is_small, entries))
            except ERRORS:
                if not is_definition:
                    yield None, used
                continue
            if holds and one.text != other.text and (used or "ddt" in words):
                yield True, used
            elif not holds and not is_definition:
                is_alike = left.free_symbols == right.free_symbols
                yield False if is_alike and used else None, used

    def _value(self, text: str, depth: int = 0) -> Value:
        words = {word for word in WORD.findall(text) if word not in FUNCTIONS}
        functions = {**FUNCTIONS, "ddt": self._rate}
        return parse(text, {**functions, **{w: self._name(w, depth) for w in words - {"ddt"}}})

    def _name(self, word: str, depth: int) -> Value:
        """The value of a name: that of its definition, or a symbol."""
        name = stem(word)
        if depth > len(self._texts):
            raise ExpressionError("names define one another")
        value = self._values.get(name)
        if value is None and name in self._texts and self._texts[name] != "0":
            value = self._value(self._texts[name], depth + 1)
        if value is None:
            return TIME if word == "t" else self._symbol(word)
        for _ in range(order(word)):
            value = self._rate(value)
        return value

    def _symbol(self, word: str) -> sp.Symbol:
        is_moving = stem(word) in self._moving
        return sp.Symbol(word, real=True) if is_moving else sp.Symbol(word, positive=True)

    def _rate(self, value: Value) -> Value:
        result = value.diff(TIME)
        for one in value.free_symbols:
            if stem(one.name) in self._moving:
                result += value.diff(one) * self._symbol(
                    stem(one.name) + RATES[order(one.name) + 1]
                )
        return result
