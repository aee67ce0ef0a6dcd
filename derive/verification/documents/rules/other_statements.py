"""Statements that are not wrong though they differ from a system: relations, values, loads."""

import ast
import re
from collections.abc import Callable, Sequence, Set
from contextlib import suppress
from copy import copy
from dataclasses import replace
from functools import cached_property

import sympy as sp

from derive.formulas.expression import parse
from derive.formulas.syntax import ExpressionError, summands, syntax_tree
from derive.mechanics.derivation import Derivation
from derive.system.symbols import TIME
from derive.verification.documents.formula_translation import order, stem
from derive.verification.documents.letters.candidates import BY_EQUATIONS, BY_POTENTIAL
from derive.verification.documents.letters.document_system import is_length
from derive.verification.documents.letters.letters import QUANTITIES, energy_of_part
from derive.verification.documents.letters.stated_equations import is_reaction
from derive.verification.documents.rules.frequencies import Frequencies
from derive.verification.documents.rules.known_values import DocumentNamespace
from derive.verification.documents.rules.roles import Roles
from derive.verification.documents.rules.side_comparison import SideComparison
from derive.verification.documents.rules.side_verdict import SideVerdict, plain
from derive.verification.documents.rules.small_motions import SmallMotions
from derive.verification.documents.statements import (
    WORD,
    DocumentFormula,
    without_unknown_terms,
)
from derive.verification.judging.reference_system import depends_on, time_derivative

#: Words of sentences about formulas that leave out terms, and about motions that have none.
SIMPLIFIED = re.compile(
    r"simplif|neglect|ignor|vereinfach|vernachl|despreci|négli|忽略|無視"
    r"|without|at rest|zero (?:\w+ )?(?:velocity|momentum|speed)",
    re.IGNORECASE,
)
#: Kinds of parameters of which no applied force consists.
CONSTANTS = ("mass", "length", "gravity", "stiffness", "inertia")
#: Names of generalized forces, which nothing else in a document may state.
GENERALIZED_FORCE = re.compile(r"Q(?:_\w+)?")
#: The largest residual at a root, the largest rate there that is none, and most steps to it.
TINY, CLOSE, MAX_STEPS = 1e-12, 1e-8, 30
#: A letter to a power.
POWER = re.compile(r"\b(\w+)\*\*")


class OtherStatements:
    """Finds statements that differ from those of a system, but are about something else."""

    def __init__(self, namespace: DocumentNamespace, frequencies: Frequencies) -> None:
        self._namespace, self._frequencies = namespace, frequencies

    def verdict(self, formula: DocumentFormula, result: SideVerdict) -> SideVerdict | None:
        """The verdict on a formula for which `result` is not correct; None if it is no other."""
        if self.relates_parameters(formula) or self._is_other_number(formula):
            return plain("definition", formula, "")
        names = self._namespace.all_names
        operands = (self._namespace.derivatives.get(one, (one,))[0] for one in formula.words)
        if letters := sorted(self._ambiguous.intersection(operands)):
            return plain("context", formula, f"{', '.join(letters)} has two meanings")
        is_parameter = names.get(formula.subject) in self._namespace.derivation.system.params
        if is_parameter and len(formula.sides) > 2 and formula.sides[-1].text == "0":
            return plain("context", formula, "it states a constraint")
        if GENERALIZED_FORCE.fullmatch(formula.subject):
            return plain("context", formula, "it states a generalized force")
        if self._is_foreign(formula):
            return plain("context", formula, "it has no parameter of the system")
        if parts := self._other_parts(formula):
            return plain("verified", formula, f"without {', '.join(parts)}")
        if (orbit := self._orbit(formula)) is not None:
            return orbit
        if self._is_first_integral(formula):
            return plain("context", formula, "it can hold for some constants of the motion")
        if variable := self._other_variable(formula):
            return plain("context", formula, f"it is the momentum of {variable}")
        if self._is_between_bodies(formula):
            note = f"{formula.sides[-1].text} can be a force between bodies"
            return plain("context", formula, note)
        if (other := self._with_an_energy(formula)) is not None:
            return other
        if self._is_of_equations(formula):
            return plain("context", formula, "it is constant, as an energy of the equations is")
        if self._is_place(formula) or self._is_turning_point(formula):
            return plain("context", formula, "it states a value")
        if (frequency := self._frequencies.of_mode(formula)) is not None:
            return frequency
        if _lacks_terms(formula, result) and SIMPLIFIED.search(formula.occurrence.prose):
            return plain("context", formula, "it lacks terms that it can neglect")
        return None

    def _is_foreign(self, formula: DocumentFormula) -> bool:
        """Whether an equation of motion has numbers by name, and no parameter of the system."""
        values = [self._namespace.names.get(word) for word in formula.words]
        known = [one for one in values if isinstance(one, sp.Expr)]
        params = {*self._namespace.derivation.system.params}
        is_equation = any(order(word) == 2 for word in formula.words)
        has_numbers = any(one.is_number for one in known)
        return is_equation and has_numbers and sp.Tuple(*known).free_symbols.isdisjoint(params)

    def _other_parts(self, formula: DocumentFormula) -> list[str]:
        """The names of partial potential energies, with which a stated one is the whole."""
        if self._namespace.letters.quantities.get(formula.subject) != "potential_energy":
            return []
        names, defining = self._namespace.names, self._namespace.defining
        parts = [one for one in defining if energy_of_part(one) == "potential_energy"]
        with suppress(ExpressionError, TypeError):
            value = self._namespace.value(formula.sides[-1].text)
            rest = self._namespace.derivation.potential_energy - value
            missing = rest - sp.Add(*(names[one] for one in parts))
            if parts and self._namespace.model.context.is_zero(missing):
                return parts
        return []

    def _is_first_integral(self, formula: DocumentFormula) -> bool:
        """Whether an equation of velocities can hold along some motions.

        It follows from no definition: its first side has coordinates and their rates alone.
        """
        system, names = self._namespace.derivation.system, self._namespace.all_names
        first = formula.sides[0]
        values = [names[word] for word in WORD.findall(first.text) if word in names]
        own = [one for one in values if isinstance(one, sp.Expr)]
        if first.text.isidentifier() or not {*own} <= {*system.q, *system.qdot, *system.params}:
            return False
        with suppress(ExpressionError, NotImplementedError, TypeError, ValueError):
            left, *rest = (self._namespace.value(one.text) for one in formula.sides)
            is_moving = bool({*own} & {*system.qdot}) and len(rest) == 1
            return is_moving and not depends_on(left - rest[0], system.qddot)
        return False

    def _orbit(self, formula: DocumentFormula) -> SideVerdict | None:
        """The verdict on a coordinate by other coordinates and constants of the motion, if it is.

        Such an equation holds along motions with some initial values alone, as that of an ellipse
        with angles from its apsis.
        """
        system, names = self._namespace.derivation.system, self._namespace.all_names
        coordinate = names.get(formula.subject)
        if coordinate not in system.q or len(formula.sides) != 2:
            return None
        with suppress(ExpressionError, NotImplementedError, TypeError, ValueError):
            text = formula.sides[1].text
            value = self._namespace.value(text)
            constants = [
                one for word in WORD.findall(text)
                if isinstance(one := names[word], sp.Expr) and depends_on(one, system.qdot)
            ]  # fmt: skip
            if not constants or depends_on(value, system.qddot) or not all(
                self._namespace.model.agreement(time_derivative(system, one)) is not None
                for one in constants
            ):  # fmt: skip
                return None
            if self._is_along_motions(coordinate, value):
                return plain("verified", formula, "it holds for some initial values")
            return plain("context", formula, "it can hold for some initial values")
        return None

    def _is_along_motions(self, coordinate: sp.Symbol, value: sp.Expr) -> bool:
        """Whether motions keep an equation of coordinates where it holds, one way or the other."""
        model, system = self._namespace.model, self._namespace.derivation.system
        others = [one for one in system.q if value.has(one) and one != coordinate]
        if not others or not model.has_inverse:
            return False
        moving = dict(zip(system.qddot, model.derivation.accelerations, strict=True))
        derivatives = [coordinate - value]
        for _ in range(2):
            rate = time_derivative(system, derivatives[-1])
            derivatives.append(sp.sympify(rate).xreplace(moving))
        derivatives.append(derivatives[0].diff(others[0]))
        letter, found = sp.Dummy(), []
        for state in model.context.states:
            numbers = {s: x for s, x in state.items() if s != others[0]} | {others[0]: letter}
            values = [one.xreplace(numbers) for one in derivatives]
            compute = sp.lambdify([letter], values, "math")
            roots = [_root(compute, sign * float(state[others[0]])) for sign in (1, -1)]
            if rates := [one for one in roots if one is not None]:
                found.append(min(rates) < CLOSE)
        return bool(found) and all(found)

    def _other_variable(self, formula: DocumentFormula) -> str:
        """The coordinate by whose rate a side of a momentum of another one is a derivative."""
        own = self._namespace.letters.momenta.get(formula.subject)
        for word in formula.words if own else ():
            _, variables = self._namespace.derivatives.get(word, ("", ()))
            if len(variables) == 1 and order(variables[0]) == 1 and stem(variables[0]) != own:
                return stem(variables[0])
        return ""

    def _is_between_bodies(self, formula: DocumentFormula) -> bool:
        """Whether an equation gives a value to a force by the inertia of some bodies alone.

        Nothing else contains the force, and without the masses that the equation lacks it holds.
        """
        derivation, last = self._namespace.derivation, formula.sides[-1].text
        forces = sp.Tuple(*derivation.system.forces).free_symbols
        is_single = sum(last in one.words for one in self._namespace.formulas) == 1
        if not is_single or self._namespace.names.get(last) not in forces:
            return False
        with suppress(ExpressionError, TypeError):
            left, right = (self._namespace.value(side.text) for side in formula.sides)
            others = {*derivation.system.params} - sp.Tuple(left, right).free_symbols
            absent = dict.fromkeys(others, sp.S.Zero)
            rows = [row.xreplace(absent) for row in derivation.euler_lagrange]
            is_zero = self._namespace.model.context.is_zero
            return any(is_zero(row + sign * (left - right)) for row in rows for sign in (1, -1))
        return False

    @cached_property
    def _ambiguous(self) -> set[str]:
        """Lengths that are parameters and that formulas define by coordinates, as r = sqrt(x*a)."""
        system, names = self._namespace.derivation.system, self._namespace.all_names
        result = set[str]()
        for formula in self._namespace.formulas:
            if names.get(formula.subject) in system.params and is_length(formula.subject):
                with suppress(ExpressionError, TypeError):
                    value = self._namespace.value(formula.sides[-1].text)
                    moving = value.free_symbols - {*system.params}
                    if moving and moving <= {*system.q} and not system.conditions:
                        result.add(formula.subject)
        return result

    def states_value(self, formula: DocumentFormula) -> bool:
        """Whether a formula states the value of a coordinate, of its rate or of a parameter.

        That of a name which the document defines by these is one at a place: θ = 0 beside ωt.
        """
        if formula.is_special_case:
            return True
        names, last = self._namespace.all_names, formula.sides[-1].text
        system = self._namespace.derivation.system
        moving = {TIME, *system.q, *system.qdot}
        try:
            value = self._namespace.value(last)
        except ExpressionError:
            return False
        if formula.subject.endswith("_prime") and not depends_on(value, moving):
            return True  # V'' = m*g*a at a place
        sides = formula.sides[:-1]
        entries = [one.text for side in sides for one in side.entries or (side,)]
        rates = [names[one] for one in entries if names.get(one) in system.qddot]
        if not isinstance(value, sp.MatrixBase) and any(
            self._namespace.model.agreement(one - value) is not None for one in rates
        ):
            return False  # an equation of motion
        return not value.free_symbols and all(
            isinstance(names.get(one), sp.Symbol)
            or (one in self._namespace.letters.quantities and names.get(one) != value)
            or (one in self._namespace.defining and depends_on(names[one], moving))
            for one in entries
        )

    def relates_parameters(self, formula: DocumentFormula) -> bool:
        """Whether a formula defines a parameter by others, as b = d/2 does: any value is right.

        So is the number of a formula of parameters, as in m*l = 0.025, and a formula of parameters
        alone, as r_1*n_2 = r_2*n_1.
        """
        names, known = self._namespace.all_names, {*self._namespace.derivation.system.params}
        letters = self._namespace.letters
        values = (names.get(word) for word in formula.words if word not in letters.parameters)
        is_relation = formula.is_value or names.get(formula.subject) in known
        is_relation |= all(names.get(word) in known for word in formula.words)
        return is_relation and all(
            callable(one) or (isinstance(one, sp.Expr) and one.free_symbols <= known)
            for one in values
        )

    def _is_other_number(self, formula: DocumentFormula) -> bool:
        """Whether a formula gives a letter that is a number another one, as in another case."""
        values = [self._namespace.all_names.get(word) for word in formula.words]
        return all(isinstance(one, sp.Expr) and one.is_number is True for one in values)

    def _with_an_energy(self, formula: DocumentFormula) -> SideVerdict | None:
        """The verdict on a formula that contains an energy, which can have another constant."""
        quantities = self._namespace.letters.quantities
        named = {name: text for name, (_, text) in self._namespace.defining.items()}
        kinds = {word: quantities.get(named.get(word, word)) for word in formula.words}
        energies = {word for word, kind in kinds.items() if kind in ("energy", "hamiltonian")}
        if formula.subject in quantities or not energies - {formula.subject}:
            return None
        if len(formula.sides) == 2 and formula.sides[1].text in energies:
            left, right = (self._namespace.value(one.text) for one in formula.sides)
            is_constant = self._namespace.model.constancy(left - right) is not None
            return plain("verified", formula, "it differs by a constant") if is_constant else None
        # that of a potential with another value at the origin, where many documents take 0
        potential = self._namespace.derivation.potential_energy
        offset = potential.subs(dict.fromkeys(self._namespace.derivation.system.q, sp.S.Zero))
        if not offset.is_finite or offset == 0:
            return None
        return plain("context", formula, "it contains an energy, which can have another constant")

    def _is_of_equations(self, formula: DocumentFormula) -> bool:
        """Whether it states a constant energy of equations, which give none but for a factor."""
        system = self._namespace.derivation.system
        kind = self._namespace.letters.quantities.get(formula.subject)
        if system.name not in (BY_EQUATIONS, BY_POTENTIAL) or kind not in ("energy", "hamiltonian"):
            return False
        with suppress(ExpressionError, NotImplementedError, TypeError, ValueError):
            rate = time_derivative(system, self._namespace.value(formula.sides[-1].text))
            return self._namespace.model.agreement(rate) is not None
        return False

    def _is_place(self, formula: DocumentFormula) -> bool:
        """Whether a formula can state a place, as cos θ = g/(ω² a): it has no other quantities.

        Coordinates with constraints have such relations everywhere.
        """
        system, names = self._namespace.derivation.system, self._namespace.all_names
        known = {*system.q, *system.params}
        values = [
            (value in known or (value in system.qdot and not order(word)), value)
            for word in formula.words  # a constant rate can have a letter
            if isinstance(value := names.get(word), sp.Expr)
        ]
        is_relation = not all(side.text.isidentifier() for side in formula.sides)
        has_place = all(k for k, _ in values) and any(v in system.q for _, v in values)
        return is_relation and has_place and not system.conditions

    @staticmethod
    def _is_turning_point(formula: DocumentFormula) -> bool:
        """Whether a formula states where the energy is that of the potential: E - V = 0."""
        kinds = {one: energy_of_part(one) or QUANTITIES.get(one) for one in formula.words}
        energies = {one for one, kind in kinds.items() if kind in ("energy", "hamiltonian")}
        others = {kind for kind in kinds.values() if kind not in ("energy", "hamiltonian")}
        is_relation = bool(energies) and formula.subject not in energies
        return is_relation and others == {"potential_energy"}


class AppliedLoads:
    """Letters of an equation of motion that stand for applied forces and moments."""

    def __init__(
        self, namespace: DocumentNamespace, linear: SmallMotions, comparison: SideComparison
    ) -> None:
        self._namespace, self._model, self._linear = namespace, namespace.model, linear
        self._comparison = comparison

    def own(self, formula: DocumentFormula) -> list[str]:
        """The last side, if it is a load to which such an equation alone gives a value."""
        last = formula.sides[-1].text
        defining = self._namespace.defining.get(last, (None, ""))[0]
        is_load = defining is not None and defining.sides[-1].text == last
        is_equation = 2 in map(order, formula.words) or formula.sides[0].text.startswith("ddt(")
        return [last] * (is_load and is_equation)

    def complete(self, formula: DocumentFormula, loads: Sequence[str]) -> bool:
        """Whether a formula is an equation of motion but for terms with these letters."""
        system, letters = self._namespace.derivation.system, self._namespace.letters
        if {*loads} & {*letters.multipliers} or any(map(order, loads)):
            return False  # all reactions would be correct, and no rate is a force
        powers = {word for side in formula.sides for word in POWER.findall(side.text)}
        if powers & {*loads}:
            return False  # as Omega**2 of a turning frame
        if {*map(stem, loads)} & letters.elsewhere or self._are_constants(formula, loads):
            return False
        energies = (one for one in self._namespace.formulas if one.subject in letters.quantities)
        if any({*loads} & {*one.words} for one in energies):  # of which they are no loads
            return False
        known = without_unknown_terms(formula, loads)
        if known is None or len(known.sides) != 2 or len(known.words) == len(formula.words):
            return False
        with suppress(ExpressionError, NotImplementedError, TypeError, ValueError):
            left, right = (self._namespace.value(one.text) for one in known.sides)
            symbols = sp.Tuple(left, right).free_symbols
            if self._are_inertia(formula, loads):
                return False
            if not symbols & {*system.qddot} or self._has_foreign_parameters(symbols):
                return False
            result = self._comparison.compared(known, *known.sides, left, right)
            if result.verdict.verdict == "verified":
                return True
            # these letters can stand for the forces of other formulas, as f sin(θ) for F_x
            own = {self._namespace.names.get(word) for word in formula.words}
            forces = sp.Tuple(*system.forces).free_symbols & {*system.params} - own
            if forces:
                absent = dict.fromkeys(forces, sp.S.Zero)
                rest = [force.xreplace(absent) for force in system.forces]
                free = replace(self._model, derivation=Derivation(replace(system, forces=rest)))
                return free.agreement(left - right) is not None
        return False

    def _are_inertia(self, formula: DocumentFormula, loads: Sequence[str]) -> bool:
        """Whether letters are factors of accelerations, which those of matrices are not."""
        letters = {one: sp.Symbol(one) for one in loads}
        names = {**self._namespace.all_names, **letters}
        rates = self._namespace.derivation.system.qddot
        with suppress(ExpressionError, TypeError, ValueError):
            values = [parse(one.text, names) for one in formula.sides]
            slopes = [one.diff(rate) for one in values for rate in rates]
            return not sp.Tuple(*slopes).free_symbols.isdisjoint(letters.values())
        return False

    def _are_constants(self, formula: DocumentFormula, loads: Sequence[str]) -> bool:
        """Whether letters of a term are those of masses, lengths or stiffnesses, and of no loads.

        One with a coordinate as its index can be a load: the moment M_theta.
        """
        letters = self._namespace.letters
        own = {one for kind in ("force", "damping") for one in letters.of_kind(kind)}
        own |= {one for one in loads if one.partition("_")[2] in letters.coordinates}
        constants = {one for kind in CONSTANTS for one in letters.of_kind(kind)} - own
        terms = (
            {*loads} & {*WORD.findall(ast.unparse(term))}
            for side in formula.sides
            for term, _ in summands(syntax_tree(side.text))
        )
        return any(words and words <= constants for words in terms)

    def _has_foreign_parameters(self, symbols: Set[sp.Symbol]) -> bool:
        """Whether a formula has parameters that no equation with its accelerations has."""
        derivation = self._namespace.derivation
        moving = symbols & {*derivation.system.qddot}
        equations = [one for one in derivation.euler_lagrange if one.has(*moving)]
        own = symbols & {*derivation.system.params}
        return not own <= sp.Tuple(*equations).free_symbols

    def beside(self, formula: DocumentFormula, loads: Sequence[str]) -> SideVerdict | None:
        """The verdict on an equation of motion in which a term beside loads is wrong.

        For a term that is missing, the loads can stand. A load to which an equation gives a value
        can be a force between bodies, if the inertia is another one. Reactions stand in several
        equations.
        """
        multipliers, formulas = self._namespace.letters.multipliers, self._namespace.formulas
        has_reactions = any(
            one in multipliers
            or (is_reaction(one) and sum(one in other.words for other in formulas) > 1)
            for one in loads
        )
        if len(formula.sides) != 2 or has_reactions:
            return None
        if without_unknown_terms(formula, loads) is None:
            return None
        namespace = copy(self._namespace)
        namespace.correct(dict.fromkeys(loads, sp.S.Zero))
        roles = Roles(namespace, self._linear)
        with suppress(ExpressionError, NotImplementedError, TypeError, ValueError):
            left, right = (namespace.value(one.text) for one in formula.sides)
            if depends_on(left - right, self._namespace.derivation.system.qddot):
                result = SideComparison(namespace, self._linear, roles).compared(
                    formula, *formula.sides, left, right
                )
                changes = [f"{one.wrong} {one.correct}" for one in result.verdict.corrections]
                is_one = len(changes) == 1 and result.verdict.corrections[0].wrong != ""
                words = WORD.findall(changes[0]) if is_one else loads
                has_value = all(one in self._namespace.all_names for one in loads)
                if {*words}.isdisjoint(loads) and not (has_value and 2 in map(order, words)):
                    return result
        return None


def _lacks_terms(formula: DocumentFormula, result: SideVerdict) -> bool:
    """Whether no term of an equation of motion is wrong, so that it lacks others."""
    is_equation = any(order(word) == 2 for word in formula.words)
    return is_equation and not any(one.wrong for one in result.verdict.corrections)


def _root(compute: Callable[[float], Sequence[float]], start: float) -> float | None:
    """The largest of two rates of a function at its root by Newton's method; None without one.

    Of a place, `compute` yields the function, both rates, and the slope.
    """
    place = start
    with suppress(ArithmeticError, ValueError, TypeError):
        for _ in range(MAX_STEPS):
            value, *rates, slope = compute(place)
            if abs(value) < TINY:
                return max(map(abs, rates))
            place -= value / slope
    return None
