"""Values of the names of a document for several meanings of its letters, in numbers."""

from collections.abc import Iterable, Iterator, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from derive.verification.corrections.goals import UP_TO_A_CONSTANT
from derive.verification.documents.formula_translation import RATES, order, stem
from derive.verification.documents.jets import (
    Array,
    Constants,
    Jet,
    UnknownNameError,
    Value,
    evaluated,
)
from derive.verification.documents.letters.letters import MATRICES, OPERATORS, Letters
from derive.verification.documents.letters.stated_positions import RADIUS, unit_vectors
from derive.verification.documents.numbers.candidate_motions import (
    ArbitraryMotion,
    CandidateMotions,
)
from derive.verification.documents.numbers.single_mistakes import is_near
from derive.verification.documents.statements import (
    EQUALITIES,
    WORD,
    Derivatives,
    DocumentFormula,
    definitions,
    values_last,
)

#: The largest difference of values of order 1 that counts as none, and digits that show one.
CLOSE, DIGITS = 1e-7, 6

#: Rounds in which definitions are sought: a name can be defined after its use.
ROUNDS = 3

Votes = NDArray[np.bool_]


class Numbers:
    """Values of a document's names for several candidates of one system."""

    def __init__(
        self,
        motions: CandidateMotions | ArbitraryMotion,
        letters: Letters,
        derivatives: Derivatives,
    ) -> None:
        self._letters, self._motions = letters, motions
        self._definitions: dict[str, str] = {}
        self.values: dict[str, Value] = {
            "t": self._motions.time,
            "pi": Jet.of(np.array([[np.pi]])),
        }
        for name, number in self._motions.parameters.items():
            self.values[name] = Jet.of(np.array([[number]]))
        for q, place in self._motions.places.items():
            speed, acceleration = self._motions.speeds[q], self._motions.accelerations[q]
            self.set_rates(q, Jet.of(place, speed, acceleration))
        if letters.column and {*letters.ordered} <= {*self._motions.places}:
            for ending in RATES[:3]:
                rows = [[self.values[q + ending]] for q in letters.ordered]
                self.values[letters.column + ending] = np.array(rows, dtype=object)
        self.parameters = tuple(self._motions.parameters)
        self.reactions = tuple(self._motions.reactions)
        for name, force in {**self._motions.reactions, **self._motions.multipliers}.items():
            self.values[name] = Jet.of(force, np.nan, np.nan)
        for name, coordinate in letters.momenta.items():
            jet = self._motions.momentum(coordinate)
            self.values[name], self.values[f"{name}_dot"] = jet, jet.rate
        for name, kind in letters.quantities.items():
            if kind == "mass_matrix":
                self.values[name] = motions.mass_matrix(letters.ordered)
            elif kind in motions.energies:
                self.values[name] = Jet.of(motions.energies[kind], np.nan, np.nan)
        for name, (function, angles) in letters.abbreviations.items():
            self.values[name] = evaluated(f"{function}({' + '.join(angles)})", self.values)
        for name, (operand, variables) in derivatives.items():
            if (value := self._derivative(operand, variables)) is not None:
                self.values[name] = value

    def set_rates(self, name: str, jet: Jet) -> None:
        """Set the values of a name and of its rates."""
        for ending in RATES[:3]:
            self.values[name + ending] = jet
            jet = jet.rate

    def define(self, formulas: Sequence[DocumentFormula]) -> None:
        """Set the values of names that formulas define, also of coordinates of no candidate."""
        units = unit_vectors(formulas) if self._motions.are_of_positions else {}
        for name, column in units.items():
            entries = [[Jet.of(np.array([[float(one)]]))] for one in column]
            self.values[name] = np.array(entries, dtype=object)
        subjects = {stem(one.subject) for one in formulas} - {*self._letters.accelerated}
        for name in subjects & ({*self._letters.coordinates} - {*self._motions.coordinates}):
            for ending in RATES[:3]:
                self.values.pop(name + ending, None)
        for name in self._motions.free_reactions & {n for f in formulas for n, _ in definitions(f)}:
            self.values.pop(name, None)
        for _ in range(ROUNDS):
            for formula in values_last(formulas):
                for name, text in definitions(formula):
                    value = None if name in self.values else self._value(text)
                    if value is None:
                        continue
                    self.values[name], self._definitions[name] = value, text
                    if isinstance(value, Jet):
                        self.set_rates(name, value)
                    elif isinstance(value, np.ndarray):
                        rates = np.vectorize(lambda one: one.rate, otypes=[object])
                        self.values[f"{name}_dot"] = rates(value)

    def comparisons(self, formula: DocumentFormula) -> Iterator[tuple[str, Votes]]:
        """Yield the sides of a formula, and whether each agrees with the first with a value."""
        if formula.is_update or {*formula.relations} - {*EQUALITIES}:
            return
        if self._is_value(formula) or self.is_solution(formula):
            return
        kind = self._letters.quantities.get(formula.subject)
        exact = formula.relations.index("~") + 1 if "~" in formula.relations else None
        constants = Constants(self.values)
        values = [self._value(side.text, constants) for side in formula.sides[:exact]]
        start = 0 if values[0] is not None else 1
        for side, right in zip(formula.sides[start + 1 : exact], values[start + 1 :], strict=True):
            left = values[start]
            if left is None or right is None:
                continue
            if isinstance(left, Jet) and isinstance(right, np.ndarray) and right.size == 1:
                right = right[0, 0]
            try:
                with np.errstate(invalid="ignore"):  # infinities
                    differences = np.ravel(np.array(left - right, dtype=object))
            except (ValueError, TypeError, AttributeError):  # matrices of other shapes, or a number
                continue
            if start or not self._is_definition(formula, side.text):  # which decides nothing
                for entry in differences:
                    vanishes = self._vanishes(entry.value, kind in UP_TO_A_CONSTANT)
                    if entry.value.size > 1 or vanishes.any():  # not those of initial values
                        yield side.text, vanishes
            if formula.subject and kind is None:
                entries: Iterable[Jet] = (right,) if isinstance(right, Jet) else ()
                if isinstance(right, np.ndarray) and self._motions.are_of_positions:
                    entries = right.flat if RADIUS.match(formula.subject) else ()
                votes = (vote for one in entries for vote in self._position(one.value))
                yield from ((side.text, vote) for vote in votes)

    def is_near(self, *sides: str) -> Votes | None:
        """Whether two sides are equal but for one term."""
        value = partial(self._value, constants=Constants(self.values))
        near = is_near(sides, value, [*self._motions.speeds.values()])
        return None if near is None else np.broadcast_to(near, self._motions.shape[:1]) > 0

    def signatures(self, rows: Sequence[int]) -> list[bytes]:
        """For each of these candidates, numbers that are the same for those of equal motions."""
        motions = self._motions
        potential = motions.energies["potential_energy"]
        with np.errstate(invalid="ignore"):  # infinities
            differences = potential - potential[:, :1]
        tables = [
            *motions.accelerations.values(), motions.energies["kinetic_energy"], differences
        ]  # fmt: skip
        parts = [np.broadcast_to(one, motions.shape)[rows] for one in tables]
        table = np.concatenate(parts, axis=1)
        return [row.tobytes() for row in np.round(table, DIGITS) + 0.0]  # no negative zeros

    def _value(self, text: str, constants: Constants | None = None) -> Value | None:
        """The value of a formula, or None; with `constants`, one without derivatives may do."""
        values = self.values if constants is None or "ddt(" in text else constants
        try:
            return evaluated(text, values)
        except UnknownNameError:
            return None

    def _vanishes(self, value: Array, up_to_a_constant: bool) -> Votes:
        value = np.broadcast_to(value, self._motions.shape)
        with np.errstate(invalid="ignore"):  # infinities
            if up_to_a_constant:
                value = value - value[:, :1]
            return np.asarray(np.all(np.abs(value) <= CLOSE, axis=1))

    def _position(self, value: Array) -> Iterator[Votes]:
        """Whether a quantity is a component of a position, up to its sign."""
        value = np.abs(np.broadcast_to(value, self._motions.shape))
        with np.errstate(invalid="ignore"):  # unknown values
            moving = [np.abs(r) for r in self._motions.positions if r.std() > CLOSE]
            hits = [np.all(np.abs(r - value) <= CLOSE, axis=1) for r in moving]
            if value.std() > CLOSE and np.any(hits):
                yield np.any(hits, axis=0)

    def _is_value(self, formula: DocumentFormula) -> bool:
        """Whether it states a number for coordinates, velocities or parameters, as theta = 0.

        So does a relation of parameters, as b = d/2, the value of an energy at a place, and a
        displacement from a place.
        """
        letters = self._letters
        if formula.is_displacement and formula.subject in letters.coordinates:
            return True
        names = {side.text for side in formula.sides[:-1]}
        moving = {q + ending for q in letters.coordinates for ending in RATES[:2]}
        known = {*moving, *letters.parameters, *letters.quantities}
        is_relation = {*formula.words} - OPERATORS <= {*letters.parameters}
        return (names <= known and formula.is_value) or (bool(formula.subject) and is_relation)

    def is_solution(self, formula: DocumentFormula) -> bool:
        """Whether it states a coordinate as a function of time alone, as x = A*cos(omega*t).

        Or several, as x_1 = -x_2 = A*cos(omega*t).
        """
        *first, last = (side.text for side in formula.sides)
        others = {stem(word) for word in WORD.findall(last)} & {*self._letters.coordinates}
        are_coordinates = {one.removeprefix("-") for one in first} <= {*self._letters.coordinates}
        return bool(first) and are_coordinates and not others and "t" in WORD.findall(last)

    def _is_definition(self, formula: DocumentFormula, text: str) -> bool:
        return any(
            self._definitions.get(name) == one
            for name, one in definitions(formula)
            if text in (one, name)
        )

    def _derivative(self, operand: str, variables: Sequence[str]) -> Jet | None:
        """The derivative of an energy by a coordinate, a velocity or a momentum."""
        kind = self._letters.quantities.get(operand)
        if kind is None or kind in MATRICES.values() or len(variables) != 1:
            return None
        name, times = stem(variables[0]), order(variables[0])
        if kind == "routhian":  # its other derivatives are those of L
            if name in self._letters.momenta and not times:
                return Jet.of(-self._motions.speeds[self._letters.momenta[name]], np.nan, np.nan)
            kind = "lagrangian"
        is_coordinate = name in self._motions.places and times < 2
        if kind in ("hamiltonian", "energy"):
            if name in self._letters.momenta and not times:
                speed = self._motions.speeds[self._letters.momenta[name]]
                return Jet.of(speed, np.nan, np.nan)
            if is_coordinate and not times:
                return Jet.of(-self._motions.gradient("lagrangian", name, 0), np.nan, np.nan)
            return None
        if is_coordinate and kind == "lagrangian" and times:
            return self._motions.momentum(name)
        if is_coordinate:
            return Jet.of(self._motions.gradient(kind, name, times), np.nan, np.nan)
        return None
