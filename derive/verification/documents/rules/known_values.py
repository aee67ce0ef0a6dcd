"""The names of a document as values of its system: letters, energies, definitions, derivatives."""

import re
import warnings
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import suppress
from copy import copy
from dataclasses import replace
from itertools import product, takewhile
from typing import Any, Self

import sympy as sp

from derive.formulas.expression import Value, parse
from derive.formulas.generic_values import is_small
from derive.formulas.syntax import ExpressionError
from derive.mechanics.derivation import Derivation, RedundancyWarning
from derive.mechanics.routhian import Routhian
from derive.system.parts import Parameter
from derive.system.symbols import TIME, acceleration, velocity
from derive.system.system import System
from derive.verification.documents.formula_translation import RATES, stem
from derive.verification.documents.letters.candidates import STATED
from derive.verification.documents.letters.document_system import (
    SystemLetters,
    energies_of,
    valid_name,
)
from derive.verification.documents.letters.letters import Letters, composed
from derive.verification.documents.letters.stated_positions import (
    AXES,
    COLUMN,
    RADIUS,
    has_angle,
    unit_vectors,
)
from derive.verification.documents.statements import (
    WORD,
    DocumentFormula,
    definitions,
    values_last,
)
from derive.verification.judging.reference_system import (
    ReferenceSystem,
    depends_on,
    own_names,
    time_derivative,
)
from derive.verification.judging.system_names import usual_names, with_multipliers

#: Generalized forces, such as Q_theta.
FORCE = re.compile(r"[QF]_(\w+)\Z")
#: Letters of the columns of forces in equations of motion with matrices.
FORCES_OF_MOTION = ("C", "G", "g", "c", "h")
#: Rounds in which definitions are sought: a name can be defined after its use.
ROUNDS = 4


class DocumentNamespace:
    """The model of a document, and which formulas define its names."""

    def __init__(
        self,
        system_letters: SystemLetters,
        letters: Letters,
        formulas: Sequence[DocumentFormula],
        derivatives: Mapping[str, tuple[str, tuple[str, ...]]],
        meanings: Mapping[str, str],
    ) -> None:
        constants = {
            name: sp.Symbol(valid_name(name), real=True)
            for name, text in meanings.items()
            if text == name
        }
        self._system = _with_constants(system_letters.system, constants.values())
        with warnings.catch_warnings():  # documents state constraints again
            warnings.simplefilter("ignore", RedundancyWarning)
            self.derivation = Derivation(self._system)
        self.letters, self.derivatives, self.formulas = letters, derivatives, formulas
        #: Names with their values.
        self.names: dict[str, Any] = dict(_functions(self._system, self.derivation))
        #: Formulas that define a name, with the text that does.
        self.defining: dict[str, tuple[DocumentFormula, str]] = {}
        self._add_letters(system_letters)
        own = system_letters.multipliers or next(usual_names(self._system))
        self.names |= own
        self._add_energies()
        self._add_routhians(formulas)
        self._add_derivatives()
        self._add_usual_names()
        self._add_total_energies(formulas)
        defined = {formula.subject for formula in formulas}
        for name, text in meanings.items():
            operand, _ = derivatives.get(name, ("", ()))
            if name not in own and operand not in defined - {""}:
                self._add(name, constants[name] if name in constants else self.value(text))
        # beside other systems, they can be those of a frame that turns
        units = unit_vectors(formulas) if self._system.name == STATED else {}
        for name, value in units.items():
            self._set(name, value)
        self._has_unit_vectors = bool(units)
        radii = (one.subject for one in formulas if RADIUS.match(one.subject))
        #: The names of position vectors, such as r_P; components of a single one have no index.
        self._radii = [*dict.fromkeys(radii)]
        #: Names of matrices and columns whose entries are defined one by one, and of columns of
        #: small displacements.
        self.composed, self.displacements = set[str](), set[str]()
        for _ in range(ROUNDS):
            known = len(self.names)
            for formula in values_last(formulas):
                self._define(formula)
            self._add_columns(formulas)
            self._add_derivatives()
            if len(self.names) == known:
                break
        #: Parameters with the numbers that the document sets them to, and the formulas that do.
        self.special_values = self._special_values(formulas)
        equations = [f"{one.sides[0].text} = {one.sides[-1].text}" for one in formulas]
        self.has_multipliers = bool(system_letters.multipliers)
        if self.has_multipliers:
            self.model = ReferenceSystem(self.derivation, self.names)
            return
        others = {name: value for name, value in self.names.items() if name not in own}
        self.model = with_multipliers(ReferenceSystem(self.derivation, others), equations)
        self.names = dict(self.model.names)

    @property
    def all_names(self) -> dict[str, Any]:
        """All names that formulas can use."""
        return {**own_names(self._system), **self.names}

    @property
    def rows(self) -> list[int]:
        """The coordinates of the system in the order of the document's columns."""
        ordered = map(self.names.get, self.letters.ordered)
        return [self._system.q.index(one) for one in ordered if one in self._system.q]

    def value(self, text: str) -> Value:
        """The value of a formula; an `ExpressionError` if it has none."""
        return parse(text, self.all_names)

    def correct(self, values: Mapping[str, Value]) -> None:
        """Give names the values that they must have, whatever the document defines them to be.

        What the document defines by them has other values, too.
        """
        self.names = dict(self.names)
        for name, value in values.items():
            self._set(name, value)
        changed = {*values}
        for _ in range(ROUNDS):
            others = [
                name for name, (_, text) in self.defining.items()
                if name not in changed and not changed.isdisjoint(WORD.findall(text))
            ]  # fmt: skip
            for name in others:
                with suppress(ExpressionError):
                    self._set(name, self.value(self.defining[name][1]))
            changed |= {*others}
        self.model = self.model.of(self.derivation, self.names)

    def with_forces(self, forces: Sequence[sp.Expr], letters: Mapping[str, sp.Symbol]) -> Self:
        """A copy with further applied forces, and their letters."""
        result, system = copy(self), _with_constants(self._system, letters.values())
        total = [own + one for own, one in zip(system.forces, forces, strict=True)]
        result._system = replace(system, forces=tuple(total))
        result.derivation = Derivation(result._system)
        result.names = {**self.names, **letters}
        result.model = self.model.of(result.derivation, result.names)
        return result

    def _special_values(
        self, formulas: Sequence[DocumentFormula]
    ) -> dict[sp.Symbol, tuple[sp.Expr, DocumentFormula]]:
        """Parameters in statements such as m = l = 1 or I = 0."""
        result: dict[sp.Symbol, tuple[sp.Expr, DocumentFormula]] = {}
        for formula in formulas:
            last = formula.sides[-1].text
            names = [self.names.get(side.text) for side in formula.sides[:-1]]
            is_value = {*formula.relations} == {"="} and last.isdigit()
            if is_value and all(name in self._system.params for name in names):
                result = {**dict.fromkeys(names, (sp.Integer(last), formula)), **result}
        return result

    def _add_letters(self, system_letters: SystemLetters) -> None:
        system = self._system
        for name, symbol in system_letters.symbols.items():
            self.names[name] = symbol
            if symbol in system.q:
                self.names[f"{name}_dot"] = velocity(symbol)
                self.names[f"{name}_ddot"] = acceleration(symbol)
        for name, coordinate in self.letters.momenta.items():
            if (
                coordinate in system_letters.symbols
                and system_letters.symbols[coordinate] in system.q
            ):
                index = system.q.index(system_letters.symbols[coordinate])
                self.names[name] = system.p[index]
                rate = time_derivative(system, self.derivation.momenta[index])
                self.names[f"{name}_dot"] = rate

    def _add_usual_names(self) -> None:
        """Names that documents use without a definition: sines such as s_12, and forces."""
        system = self._system
        for name, (function, coordinates) in self.letters.abbreviations.items():
            angles = [self.names.get(q) for q in coordinates]
            if None not in angles:
                self.names[name] = getattr(sp, function)(sp.Add(*angles))
        letters = [name for name in self.letters.parameters if name not in self.names]
        for name in letters:
            if match := FORCE.match(name):
                coordinate = self.names.get(match[1])
                if coordinate in system.q:
                    self.names[name] = system.applied[system.q.index(coordinate)]

    def _add_columns(self, formulas: Sequence[DocumentFormula]) -> None:
        """Matrices and columns by their entries, and columns of small displacements."""
        words = dict.fromkeys(word for formula in formulas for word in formula.words)
        entries = {one.subject for one in formulas}  # of columns that no formula contains
        columns = (f"{one}_column" for one in FORCES_OF_MOTION if f"{one}_1" in entries)
        words |= dict.fromkeys(columns)
        order = [self._system.q[row] for row in self.rows]
        for name, value in composed(words, self.all_names, len(order)):
            self.composed.add(name)
            self._add(name, value)
        column = self.letters.column
        if column and column not in self.all_names and len(order) == len(self.letters.ordered):
            self._add(column, sp.ImmutableDenseMatrix(order))
        stated = {part for one in formulas for part in (one.subject, one.subject[:1])}
        texts = (side.text for one in formulas for side in one.sides)
        if column and "C" not in stated and any(f"C*{column}_dot" in text for text in texts):
            self._add("C", self.derivation.coriolis_matrix.extract(self.rows, self.rows))
        for name in words:
            one = stem(name)
            if one.endswith("_column") and name == f"{one}_ddot" and one not in self.names:
                self.displacements.add(one)
                self._add(one, sp.ImmutableDenseMatrix(order))

    def _add_energies(self) -> None:
        d = self.derivation
        T, V = energies_of(d)
        values = {
            "lagrangian": d.lagrangian,
            "kinetic_energy": T,
            "potential_energy": V,
            "hamiltonian": d.energy,
            "energy": d.energy,
        }
        values |= self._matrices
        stated = {one.subject for one in self.formulas}
        for name, kind in self.letters.quantities.items():
            if kind in values and (kind != "mass_matrix" or name in stated):  # not its entries
                self.names[name] = values[kind]
        # a potential energy can leave terms of velocities to the Lagrangian
        for name, kind in self.letters.quantities.items():
            if kind == "potential_energy" and not self._has_rates(name):
                self.names[name] = V.xreplace(dict.fromkeys(self._system.qdot, sp.S.Zero))

    def _has_rates(self, name: str) -> bool:
        """Whether a formula states a name by velocities, or by names that others state by them."""
        rates = {
            one.subject for one in self.formulas if any(word != stem(word) for word in one.words)
        }
        own = {word for one in self.formulas if one.subject == name for word in one.words}
        return any(word != stem(word) for word in own) or bool(own & rates - {name})

    def _add_routhians(self, formulas: Sequence[DocumentFormula]) -> None:
        """Routhians of the coordinates whose momenta their formulas contain, with their sign."""
        p = self._system.p
        for name, kind in self.letters.quantities.items():
            if kind == "routhian":
                own = [one for one in formulas if one.subject == name]
                momenta = {self.names.get(word) for one in own for word in one.words}
                indices = tuple(k for k, symbol in enumerate(p) if symbol in momenta)
                function = Routhian(self.derivation, indices).function
                self.names[name] = -function if self._has_value(own, -function) else function

    def _add_total_energies(self, formulas: Sequence[DocumentFormula]) -> None:
        """T + V for energies with which more formulas hold than with Jacobi's integral."""
        d = self.derivation
        total = sp.Add(*energies_of(d))
        momenta = dict(zip(self._system.p, d.momenta, strict=True))
        energies = [n for n, kind in self.letters.quantities.items() if kind == "energy"]
        for name in energies if not is_small(total - d.energy) else ():
            own = [one for one in formulas if name in one.words]
            counts = [self._holding(own, {name: x}, momenta) for x in (d.energy, total)]
            if counts[1] > counts[0]:
                self.names[name] = total

    def _holding(
        self,
        formulas: Sequence[DocumentFormula],
        names: Mapping[str, Any],
        momenta: Mapping[sp.Symbol, sp.Expr],
    ) -> int:
        """The number of formulas whose first two sides are equal with other values of names."""
        namespace, count = {**self.all_names, **names}, 0
        for one in formulas:
            with suppress(ExpressionError, TypeError, ValueError):
                left, right = (parse(side.text, namespace) for side in one.sides[:2])
                count += is_small((left - right).xreplace(dict(momenta)))
        return count

    def _has_value(self, formulas: Sequence[DocumentFormula], value: sp.Expr) -> bool:
        """Whether a side of formulas has this value, with the momenta of any motion."""
        momenta = dict(zip(self._system.p, self.derivation.momenta, strict=True))
        for side in (side for one in formulas for side in one.sides[1:]):
            with suppress(ExpressionError):
                if is_small((self.value(side.text) - value).xreplace(momenta)):
                    return True
        return False

    @property
    def _matrices(self) -> dict[str, Value]:
        """The mass matrix with its rows in the order of the names."""
        return {"mass_matrix": self.derivation.mass_matrix.extract(self.rows, self.rows)}

    def _add_derivatives(self) -> None:
        for name, (operand, variables) in self.derivatives.items():
            if name not in self.names:
                value = self._derivative(operand, variables)
                if value is not None:
                    self.names[name] = value

    def _derivative(self, operand: str, variables: Sequence[str]) -> Value | None:
        namespace = self.all_names
        if operand not in namespace or any(one not in namespace for one in variables):
            return None
        value, constants = self._operand(operand)
        kind, is_along = self.letters.quantities.get(operand), False
        for one in variables:
            variable = namespace[one]
            # the derivative of u = 1/r by an angle is that along the motion
            is_along |= kind is None and self._moves_without(value, variable)
            if isinstance(variable, sp.MatrixBase) and not isinstance(value, sp.MatrixBase):
                if not all(entry.is_Symbol for entry in variable):
                    return None
                value = sp.ImmutableDenseMatrix([value.diff(entry) for entry in variable])
            elif kind in ("hamiltonian", "energy") and variable in self._system.p:
                value = self._system.qdot[self._system.p.index(variable)]
            elif kind == "hamiltonian" and variable in self._system.q:
                value = -self.derivation.lagrangian.diff(variable)
            elif is_along and not depends_on(value, self._system.qddot):
                value = time_derivative(self._system, value) / velocity(variable)
            elif isinstance(variable, sp.Symbol) and not is_along:
                value = value.diff(variable)
            else:
                return None
        return value.xreplace(constants)

    def _moves_without(self, value: Value, variable: Value) -> bool:
        """Whether a value depends on coordinates, but not on one of them."""
        is_coordinate = variable in self._system.q and not isinstance(value, sp.MatrixBase)
        return is_coordinate and not value.has(variable) and depends_on(value, self._system.q)

    def _operand(self, name: str) -> tuple[Value, dict[sp.Dummy, sp.Expr]]:
        """The value of a name with dummies for conserved momenta in its definition, and these.

        In an effective potential they are constants: its derivative is not that of T + V.
        """
        _, text = self.defining.get(name, (None, ""))
        words = {word for word in WORD.findall(text) if word in self.defining}
        words = {word for word in words if self._is_conserved(word)}
        if not words:
            return self.all_names[name], {}
        dummies = {word: sp.Dummy(word) for word in words}
        value = parse(text, {**self.all_names, **dummies})
        return value, {dummy: self.names[word] for word, dummy in dummies.items()}

    def _is_conserved(self, name: str) -> bool:
        """Whether a name stands for the momentum of a coordinate that L does not depend on.

        It can be one by mass, such as h = r² φ̇.
        """
        value, d = self.names.get(name), self.derivation
        if not isinstance(value, sp.Expr) or not depends_on(value, self._system.qdot):
            return False
        moving = (*self._system.q, *self._system.qdot)
        return any(
            not d.lagrangian.diff(q)
            and not force
            and not depends_on(sp.cancel(value / momentum), moving)
            for q, momentum, force in zip(
                self._system.q, d.momenta, self._system.applied, strict=True
            )
        )

    def _define(self, formula: DocumentFormula) -> None:
        for name, text in definitions(formula):
            if name in self.all_names or not name.isidentifier() or name == "t":
                continue
            try:
                value = self.value(text)
            except ExpressionError:
                continue
            if name == formula.subject and self._is_reaction(formula, value):
                continue
            self.defining[name] = formula, text
            self._add(name, value)
            point = COLUMN.match(name.removesuffix("_column"))
            if point and isinstance(value, sp.MatrixBase) and value.cols == 1:
                endings = [f"_{point[1]}"] if point[1] else []
                endings += [""] * ([name] == self._radii)
                for (axis, entry), ending in product(zip(AXES, value, strict=False), endings):
                    if (component := axis + ending) not in self.all_names:
                        self._add(component, entry)
                if self._has_unit_vectors and name in self._radii and has_angle(value):
                    self._add_vector_rates(name)

    def _add_vector_rates(self, name: str) -> None:
        """Add the velocity and the acceleration of a position vector, such as v_P of r_P."""
        endings = [name.removeprefix("vec")[1:]]
        if [name] == self._radii:
            endings.append("_column")
        for letter, ending in product("va", endings):
            rate = self.names.get(name + RATES[1 + (letter == "a")])
            if rate is not None and letter + ending not in self.all_names:
                self._add(letter + ending, rate)

    def _is_reaction(self, formula: DocumentFormula, value: Value) -> bool:
        """Whether a formula solves an equation before it for its subject.

        This is a reaction, such as a tension: by its value that equation would hold, and not the
        others where one of them is wrong. Without accelerations, the equation has a term with it
        and velocities alone; what has velocities can be an abbreviation elsewhere.
        """
        name, system = formula.subject, self._system
        if not depends_on(value, (*system.qdot, *system.qddot)):
            return False
        has_accelerations = depends_on(value, system.qddot)
        before = takewhile(lambda one: one is not formula, self.formulas)
        equations = [one for one in before if name in one.words and one.subject != name]
        if has_accelerations:
            known = (self.names.get(word) for one in equations for word in one.words)
            return any(isinstance(one, sp.Basic) and depends_on(one, system.qddot) for one in known)
        return any(self._has_term(one, name) for one in equations if not one.subject)

    def _has_term(self, formula: DocumentFormula, name: str) -> bool:
        """Whether an equation with velocities has a name times a constant as a term."""
        letter = sp.Symbol(name)
        with suppress(ExpressionError, TypeError, ValueError):
            first, last = (parse(one.text, {**self.all_names, name: letter})
                           for one in (formula.sides[0], formula.sides[-1]))  # fmt: skip
            factor = (first - last).diff(letter)
            is_constant = factor != 0 and not depends_on(factor, (letter, *self._system.q))
            has_rates = depends_on(first - last, self._system.qdot)
            return is_constant and has_rates and not depends_on(first - last, self._system.qddot)
        return False

    def _add(self, name: str, value: Value) -> None:
        """Add a name, and its rates unless they are known."""
        self.names[name] = value
        for rate, derivative in self._rates(name, value):
            self.names.setdefault(rate, derivative)

    def _set(self, name: str, value: Value) -> None:
        """Give a name another value, and its rates, too."""
        self.names |= {**dict(self._rates(name, value)), name: value}

    def _rates(self, name: str, value: Value) -> Iterator[tuple[str, Value]]:
        for ending in RATES[1:3]:
            rate = _rate(self._system, value)
            if rate is None:
                break
            value = rate
            if name + ending not in self.derivatives:  # by a velocity, as dL_dx_dot is
                yield name + ending, value


def _with_constants(system: System, symbols: Collection[sp.Symbol]) -> System:
    """The system with further parameters, on which nothing in it depends."""
    constants = (Parameter(symbol, "1", 1.0, "a constant") for symbol in symbols)
    return replace(system, parameters=(*system.parameters, *constants)) if symbols else system


def _rate(system: Any, value: Value) -> Value | None:
    """The time derivative; None if it depends on accelerations or momenta."""
    if depends_on(value, (*system.qddot, *system.p)):
        return None
    if isinstance(value, sp.MatrixBase):
        return value.applyfunc(lambda entry: time_derivative(system, entry))
    return time_derivative(system, value)


def _functions(system: Any, derivation: Derivation) -> Iterator[tuple[str, Any]]:
    """Operators of formulas."""
    momenta = dict(zip(system.p, derivation.momenta, strict=True))

    def ddt(value: Value) -> Value:
        value = value.xreplace(momenta)
        if depends_on(value, system.qddot):
            raise ValueError("a third derivative")
        rate = _rate(system, value)
        assert rate is not None
        return rate

    def norm(value: Value) -> Value:
        if isinstance(value, sp.MatrixBase):
            return sp.sqrt(sp.Add(*(entry**2 for entry in value)))
        return sp.Abs(value)

    def cross(one: Any, other: Any) -> Value:
        if one.shape == other.shape == (2, 1):  # across their plane
            return one[0] * other[1] - one[1] * other[0]
        return one.cross(other)

    yield "ddt", ddt
    yield "diff", lambda value, symbol: value.diff(symbol)
    yield "inverse", lambda matrix: matrix.inv()
    yield "transpose", lambda matrix: matrix.T
    yield "square", lambda column: (column.T * column)[0, 0]
    yield "norm", norm
    yield "cross", cross
    yield "det", lambda matrix: matrix.det()
    yield "asin", sp.asin
    yield "acos", sp.acos
    yield "atan", sp.atan
    yield "t", TIME
