"""Formulas that follow from definitions of a document alone, whatever the motion is.

These are chains such as f = ω/(2π) = √(k/m)/(2π), and velocities and accelerations by unit vectors
of polar coordinates.
"""

import re
from collections.abc import Collection, Iterator, Sequence

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
ERRORS = (ExpressionError, NotImplementedError, TypeError, ValueError, IndexError)


class Identities:
    """The formulas of a document as identities in letters, which may be any functions of time."""

    def __init__(
        self, formulas: Sequence[DocumentFormula], left: Collection[DocumentFormula]
    ) -> None:
        self._formulas, self._left = formulas, left
        words = {word for one in formulas for word in one.words}
        self._moving = {stem(word) for word in words if order(word)}
        matches = {name: match for name in map(stem, words) if (match := UNIT.match(name))}
        units = {name: match[1] or match[2] for name, match in matches.items()}
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

        A side is wrong if it has the letters of the side before it, and each name in both has a
        single definition, by which other formulas hold.
        """
        confirmed, failed = set[str](), list[tuple[DocumentFormula, set[str]]]()
        defining: dict[str, list[DocumentFormula]] = {}
        verified: list[DocumentFormula] = []
        for formula in self._formulas:
            results = [*self._compared(formula)] if formula in self._left else []
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
                note = f"it contradicts the definition of {', '.join(sorted(used))}"
                yield formula, plain("wrong", formula, note)

    def _compared(self, formula: DocumentFormula) -> Iterator[tuple[bool | None, set[str]]]:
        """Yield whether neighbouring sides are equal, and the names whose definitions they use.

        None is for sides that can be equal along a motion; nothing for a definition.
        """
        if {*formula.relations} - {"=", ":="}:
            return
        for one, other in zip(formula.sides, formula.sides[1:], strict=False):
            words = {stem(w) for side in (one, other) for w in WORD.findall(side.text)}
            used = words & {*self._values, *self._texts}
            texts = one.text, other.text
            is_definition = any(text.isidentifier() and not order(text) for text in texts)
            holds: bool | None = None
            try:
                left, right = map(self._value, texts)
                rest = left - right
                holds = all(map(is_small, rest if isinstance(rest, sp.MatrixBase) else [rest]))
                if not holds and (left.free_symbols != right.free_symbols or not used):
                    holds = None
            except ERRORS:
                pass
            if not is_definition or (holds and texts[0] != texts[1] and (used or "ddt" in words)):
                yield holds, used

    def _value(self, text: str, depth: int = 0) -> Value:
        functions = {**FUNCTIONS, "ddt": self._rate}
        words = {*WORD.findall(text)} - {*functions}
        return parse(text, {**functions, **{word: self._name(word, depth) for word in words}})

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
            name = stem(one.name)
            if name in self._moving:
                result += value.diff(one) * self._symbol(name + RATES[order(one.name) + 1])
        return result
