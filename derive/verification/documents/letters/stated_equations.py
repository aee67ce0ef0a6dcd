"""The system of the equations of motion that a document states, with reactions and any forces.

These are equations that are linear in accelerations and in letters of reactions, such as tensions
and normal forces: as many as there are of both determine them, and others are judged by these.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import permutations

import numpy as np
import sympy as sp

from derive.formulas.expression import parse
from derive.formulas.syntax import ExpressionError
from derive.system.symbols import acceleration, velocity
from derive.verification.documents.letters.candidates import (
    BY_EQUATIONS,
    BY_POTENTIAL,
    SystemCandidate,
)
from derive.verification.documents.letters.document_system import is_length, valid_name
from derive.verification.documents.letters.energies import (
    letter_symbols,
    stated_system,
    stated_values,
)
from derive.verification.documents.letters.implied_energies import inertial, potential_of
from derive.verification.documents.letters.letters import MATRICES, Letters
from derive.verification.documents.letters.stated_positions import stated_candidates
from derive.verification.documents.statements import DocumentFormula

#: Letters of reactions.
REACTION = re.compile(r"(?:[TNSRPH]|F_[TNSRtnsrf]\w*|tension|normal)(?:_\w+)?\Z")
#: Letters of friction, which is a reaction, too, as long as nothing slips.
FRICTION = ("F", "f")
#: Most unknown accelerations and reactions, and operations of an equation.
MAX_UNKNOWN, MAX_OPERATIONS = 6, 120
#: Most operations of what equations determine; those of one system, even for six unknowns, have
#: fewer, and with those of several systems every comparison takes seconds.
MAX_SOLVED = 600
#: Most equations that are solved by determinants.
MOST_BY_CRAMER = 4
#: Most coordinates whose equations are sought in an order with a symmetric mass matrix.
MAX_ORDERED = 4


def is_reaction(name: str) -> bool:
    """Whether a letter is usual for a tension, a normal force or friction."""
    return bool(REACTION.match(name)) or name.partition("_")[0] in FRICTION


@dataclass(frozen=True)
class _Equation:
    """A formula that vanishes, with its coefficients of unknowns, and its number."""

    value: sp.Expr
    number: int
    coefficients: tuple[sp.Expr, ...]


class StatedEquations:
    """The equations of a document in its own letters, and what they determine."""

    def __init__(self, letters: Letters, formulas: Sequence[DocumentFormula]) -> None:
        self._letters, self._formulas = letters, formulas
        self._symbols = letter_symbols(letters)
        defined = {one.subject for one in formulas} - {*letters.accelerated}
        self._coordinates = [q for q in letters.coordinates if q not in defined]
        self._q = [self._symbols[name] for name in self._coordinates]
        words = dict.fromkeys(word for one in formulas for word in one.words)
        known = {*letters.quantities, *letters.coordinates}
        energies = {*letters.quantities.values()} - {*MATRICES.values()}
        self._has_energies = bool(energies or letters.momenta)
        self._reactions = {
            name: self._symbols.get(name, sp.Symbol(valid_name(name), real=True))
            for name in words
            if name in letters.multipliers
            or (REACTION.match(name) and name not in known and not name.endswith("_column"))
        }
        in_energies = {w for one in formulas if one.subject in letters.quantities
                       for w in one.words}  # fmt: skip
        loads = {*letters.of_kind("force")} - in_energies - {*self._reactions}
        self._loads = [self._symbols[name] for name in sorted(loads & {*self._symbols})]
        left_out = {*letters.coordinates} - {*self._coordinates}
        symbols = {name: one for name, one in self._symbols.items() if name not in left_out}
        _, self._names = stated_values(letters, formulas, {**symbols, **self._reactions})
        others, rows = {*self._others()}, [*self._equations([*self._reactions.values()])]
        self._reactions = {
            name: one
            for k, (name, one) in enumerate(self._reactions.items())
            if one not in others and any(row.coefficients[k] for row in rows)
        }
        # coordinates of which no equation has an acceleration
        rows = [*self._equations([*map(acceleration, self._q)])]
        used = [k for k in range(len(self._q)) if any(one.coefficients[k] for one in rows)]
        self._coordinates = [self._coordinates[k] for k in used]
        self._q = [self._q[k] for k in used]

    def candidates(self) -> Iterator[SystemCandidate]:
        """Yield the systems of the first equations that suffice, and of those without one each."""
        if self._letters.constraints or not self._q:
            return
        for reactions in self._choices_of_reactions():
            unknown = (*map(acceleration, self._q), *reactions.values())
            rows = [*self._equations(unknown)]
            chosen = _independent(rows, len(unknown))
            if chosen is None or len(unknown) > MAX_UNKNOWN:
                continue
            seen, has_system = set[frozenset[int]](), False
            for left_out in (-1, *(one.number for one in chosen)):
                part = _independent([one for one in rows if one.number != left_out], len(unknown))
                numbers = frozenset(one.number for one in part or ())
                if part and numbers not in seen:
                    seen.add(numbers)
                    if candidate := self._candidate(part, reactions, numbers):
                        has_system = True
                        yield candidate
            if has_system:
                return

    def _others(self) -> Iterator[sp.Symbol]:
        """Letters of reactions that equations are not linear in, lengths times another, periods."""
        letters = [*self._reactions.values()]
        for formula in self._formulas:
            if formula.subject in self._reactions and "pi" in formula.words:
                yield self._reactions[formula.subject]
            with suppress(ExpressionError, NotImplementedError, TypeError, ValueError):
                first, *others = (parse(side.text, self._names) for side in formula.sides)
                for name, one in self._reactions.items():
                    slope = sp.Tuple(*((first - other).diff(one) for other in others))
                    partners = [other for other in letters if is_length(name) or other is one]
                    if slope.has(*partners):
                        yield one

    def _choices_of_reactions(self) -> Iterator[Mapping[str, sp.Symbol]]:
        """All letters of reactions, those but multipliers, or none."""
        multipliers = {*self._letters.multipliers}
        yield self._reactions
        yield {r: one for r, one in self._reactions.items() if r not in multipliers}
        yield {}

    def _equations(self, unknown: Sequence[sp.Symbol]) -> Iterator[_Equation]:
        """The equations between neighbouring sides that are linear in unknowns."""
        for number, value in self._differences:
            coefficients = tuple(value.diff(symbol) for symbol in unknown)
            if any(coefficients) and not sp.Tuple(*coefficients).has(*unknown):
                yield _Equation(value, number, coefficients)

    @cached_property
    def _differences(self) -> list[tuple[int, sp.Expr]]:
        """Differences of neighbouring sides, with the numbers of their formulas."""
        result = []
        for number, formula in enumerate(self._formulas):
            for k, relation in enumerate(formula.relations):
                if relation not in ("=", ":="):
                    break
                with suppress(ExpressionError, NotImplementedError, TypeError, ValueError):
                    one, other = (parse(s.text, self._names) for s in formula.sides[k : k + 2])
                    value = one - other
                    is_scalar = not isinstance(value, sp.MatrixBase)
                    if is_scalar and sp.count_ops(value) <= MAX_OPERATIONS:
                        result.append((number, value))
            if formula.is_conserved:
                result += ((number, rate) for rate in self._rates(formula))
        return result

    def _rates(self, formula: DocumentFormula) -> Iterator[sp.Expr]:
        """Yield the rate of what a formula states to be constant, such as of r**2*theta_dot."""
        for side in formula.sides[::-1]:
            with suppress(ExpressionError, NotImplementedError, TypeError, ValueError):
                rate = parse(f"ddt({side.text})", self._names)
                if not isinstance(rate, sp.MatrixBase) and rate.has(*map(acceleration, self._q)):
                    yield rate
                    return

    def _candidate(
        self, rows: Sequence[_Equation], reactions: Mapping[str, sp.Symbol], numbers: frozenset[int]
    ) -> SystemCandidate | None:
        """The system that equations determine; None if it is not found."""
        unknown = (*map(acceleration, self._q), *reactions.values())
        still = dict.fromkeys(unknown, sp.S.Zero)
        matrix = sp.Matrix([one.coefficients for one in rows])
        rest = sp.Matrix([-one.value.xreplace(still) for one in rows])
        solved = _solved(matrix, rest)
        if solved is None or sp.count_ops(solved) > MAX_SOLVED:
            return None
        n, name = len(self._q), BY_EQUATIONS
        inertia, forces, V = sp.ImmutableDenseMatrix(sp.eye(n)), list(solved[:n]), None
        applied = list[sp.Expr]()
        rates = [*map(velocity, self._q)]
        symmetric = None if reactions else _symmetric(matrix, rest)
        if symmetric and not symmetric[0].has(*rates):  # as that of a rate of an energy has
            inertia, forces = symmetric
            v = sp.Matrix(rates)
            T = sp.expand((v.T * inertia * v)[0, 0] / 2)
            forces = [f + inertial(T, self._q, i).xreplace(still) for i, f in enumerate(forces)]
            forces = [*map(sp.expand, forces)]
            applied = [sp.Add(*(one * force.diff(one) for one in self._loads)) for force in forces]
            rests = [sp.expand(a - force) for a, force in zip(applied, forces, strict=True)]
            V = potential_of(rests, self._q)
        if V is not None:
            name, forces = BY_POTENTIAL, applied
        elif self._has_energies:  # which are not those of these equations
            return None
        used = sp.Tuple(inertia, *solved, V or 0).free_symbols
        every = {self._symbols[name] for name in self._letters.coordinates}
        if used & {s for one in every - {*self._q} for s in (one, velocity(one))}:
            return None
        title = "The system of the stated equations"
        values = dict(zip(reactions, solved[n:], strict=True))
        potential, others = V or sp.S.Zero, [*values.values()]
        system = stated_system(
            name, title, self._letters, self._q, inertia, potential, forces, others
        )
        if system is None:
            return None
        one = next(stated_candidates(system, self._letters))
        return replace(one, stating=numbers, reactions=values)


def _solved(matrix: sp.Matrix, rest: sp.Matrix) -> sp.Matrix | None:
    """The solution of linear equations; of few ones without pivots, which can vanish at rest."""
    point = _point(sp.Tuple(matrix, rest))
    if matrix.rows <= MOST_BY_CRAMER:
        determinant = matrix.det(method="berkowitz")
        if _is_zero(determinant, point):
            return None
        return (matrix.adjugate() * rest).applyfunc(partial(_quotient, divisor=determinant))
    try:
        return matrix.LUsolve(rest, iszerofunc=lambda one: _is_zero(one, point))
    except (ValueError, sp.matrices.exceptions.NonInvertibleMatrixError):
        return None


def _quotient(value: sp.Expr, divisor: sp.Expr) -> sp.Expr:
    """A quotient, without a sine that is a factor of both: a tension has it at rest."""
    sines = divisor.atoms(sp.sin)
    if len(sines) != 1 or sp.expand(divisor.subs(sine := sines.pop(), 0)) != 0:
        return value / divisor
    square = 1 - sp.cos(sine.args[0]) ** 2
    with suppress(sp.PolynomialError):  # of quotients
        above, below = (sp.rem(sp.expand(one), sine**2 - square, sine) for one in (value, divisor))
        odd, even = (above.coeff(sine, power) for power in (1, 0))
        quotient, rest = sp.div(even, square, sp.cos(sine.args[0]))
        if rest == 0 and below.coeff(sine, 0) == 0:
            return sp.cancel((odd + sine * quotient) / below.coeff(sine, 1))
    return value / divisor


def _independent(rows: Sequence[_Equation], count: int) -> list[_Equation] | None:
    """The first equations that determine so many unknowns; None if there are too few."""
    point = _point(sp.Tuple(*(c for one in rows for c in one.coefficients)))
    kept, table = list[_Equation](), list[list[float]]()
    for one in rows:
        try:
            numbers = [float(c.xreplace(point)) for c in one.coefficients]
        except TypeError:  # complex, or of unknown functions
            continue
        if np.linalg.matrix_rank(np.array([*table, numbers])) > len(table):
            kept, table = [*kept, one], [*table, numbers]
        if len(kept) == count:
            return kept
    return None


def _symmetric(
    matrix: sp.Matrix, rest: sp.Matrix
) -> tuple[sp.ImmutableDenseMatrix, list[sp.Expr]] | None:
    """A symmetric matrix of the same equations in another order, with other signs; else None."""
    n = matrix.rows
    for order in permutations(range(n)) if n <= MAX_ORDERED else ():
        if not all(matrix[i, k] for k, i in enumerate(order)):
            continue
        signs = [-1 if matrix[i, k].could_extract_minus_sign() else 1 for k, i in enumerate(order)]
        inertia = sp.diag(*signs) * matrix.extract(order, range(n))
        if sp.expand(inertia - inertia.T) == sp.zeros(n):
            forces = [s * rest[i] for s, i in zip(signs, order, strict=True)]
            return sp.ImmutableDenseMatrix(inertia), forces
    return None


def _point(expression: sp.Basic) -> dict[sp.Symbol, sp.Expr]:
    symbols = sorted(expression.free_symbols, key=str)
    return {one: sp.Float(0.37 + 0.31 * k - 0.011 * k * k) for k, one in enumerate(symbols)}


def _is_zero(value: sp.Expr, point: Mapping[sp.Symbol, sp.Expr]) -> bool:
    number = value.xreplace(dict(point)).evalf()
    return bool(number.is_number and abs(number) < 1e-10)
