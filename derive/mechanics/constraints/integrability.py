"""Which constraints of velocities follow from constraints of positions: Frobenius' theorem.

A constraint A(q, t) q̇ + b(q, t) = 0 is the zero of a form A dq + b dt along the motion. Of all
such forms, together with the differentials of constraints of positions, the derived flag

    I' = forms of I whose exterior derivative vanishes where all forms of I do

ends with those that are combinations of differentials df (R. L. Bryant et al., Exterior
Differential Systems, chapter II). Their f, the integrals, keep the value that they have at the
start, as a constraint of positions. Their gradients are combinations of the constraints, with
integrating factors; where these are never 0, motions are kept on f = constant. The other
constraints restrict no positions. They enter the equations of motion by multipliers, since
displacements that they allow do not commute: velocities that are removed from the Lagrangian before
it is differentiated lose the forces of these brackets (J. I. Neimark, N. A. Fufaev, Dynamics of
Nonholonomic Systems, chapter III).
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, reduce
from itertools import chain, combinations, combinations_with_replacement
from typing import Any

import sympy as sp
from sympy.polys.matrices import DomainMatrix

from derive.formulas.functions import derivative
from derive.formulas.trigonometric_field import TrigonometricField
from derive.system.symbols import TIME
from derive.system.system import System

#: Most integrals of which combinations are tried.
MOST = 12


class RegularIntegrals:
    """Integrals that can replace constraints: with integrating factors that are never 0.

    Gradients of integrals are combinations of the constraints, A rows + B known, with the `rows` of
    constraints, the `known` differentials and integrating factors A. They can replace those rows
    whose columns of A have a determinant that is never 0.
    """

    def __init__(
        self,
        functions: TrigonometricField,
        known: Sequence[Sequence[Any]],
        rows: Sequence[Sequence[Any]],
        integrals: Sequence[sp.Expr],
    ) -> None:
        self._functions, self._known, self._integrals = functions, known, integrals[:MOST]
        # where a denominator is 0, there is no constraint
        self._rows = [_polynomials(row) for row in rows]

    def most(self, count: int) -> dict[int, sp.Expr]:
        """As many as possible, at most `count`, by the index of the row that each replaces."""
        best = self._extended((), count)
        return dict(
            zip(self._replaced(best) or (), (self._integrals[k] for k in best), strict=True)
        )

    def _extended(self, chosen: tuple[int, ...], count: int) -> tuple[int, ...]:
        """The longest choice that begins with the chosen ones."""
        best = chosen
        for k in range(chosen[-1] + 1 if chosen else 0, len(self._integrals)):
            if len(best) < count and self._replaced(trial := (*chosen, k)):
                best = max(best, self._extended(trial, count), key=len)
        return best

    def _replaced(self, chosen: tuple[int, ...]) -> tuple[int, ...] | None:
        """The rows that these integrals can replace together."""
        size, field = len(chosen), self._functions.field
        for columns in combinations(range(len(self._rows)), size):
            minor = [[self._factors[k][j] for j in columns] for k in chosen]
            *_, determinant = DomainMatrix(minor, (size, size), field).charpoly()  # up to its sign
            if self._functions.is_never_zero(determinant):
                return columns
        return None

    @cached_property
    def _factors(self) -> list[list[Any]]:
        """A, one row an integral."""
        functions, forms, m = self._functions, [*self._known, *self._rows], len(self._known)
        gradients = [functions.gradient(functions.value(f)) for f in self._integrals]
        columns = [[*column] for column in zip(*forms, *gradients, strict=True)]
        shape = (len(functions.variables), len(forms) + len(gradients))
        solution, pivots = DomainMatrix(columns, shape, functions.field).rref()
        entries, rows = solution.to_list(), {p: i for i, p in enumerate(pivots)}
        return [
            [entries[rows[j]][len(forms) + k] if j in rows else functions.field.zero
             for j in range(m, len(forms))]
            for k in range(len(gradients))
        ]  # fmt: skip


def _polynomials(row: Sequence[Any]) -> list[Any]:
    """A multiple of a row without denominators."""
    common = reduce(lambda a, b: a.lcm(b), (entry.denom for entry in row))
    return [entry * common for entry in row]


#: Degree, and unknown coefficients, of the largest polynomial that is tried as an integral.
HIGHEST_DEGREE, MOST_TERMS = 4, 150
#: Terms of the longest constraints that are decided by formulas.
LONGEST = 300


@dataclass(frozen=True)
class Integrability:
    """The decision on all constraints of velocities of a system.

    Attributes
    ----------
    integrals : tuple of sympy.Expr
        Functions of coordinates and time that the constraints of velocities keep constant:
        polynomials in these and in sines and cosines of angles.
    held : mapping of int to sympy.Expr
        The integrals to whose values at the start motions are kept, by the index of the constraint
        of velocities that each replaces: integrating factors are never 0.
    integrable : int
        The number of combinations of constraints that are constraints of positions, with or without
        a known integral.
    nonholonomic : int
        The number of the others, which restrict velocities alone.
    note : str
        The reason why there is no decision, if there is none: all constraints of velocities then
        count as others.
    """

    integrals: tuple[sp.Expr, ...]
    integrable: int
    nonholonomic: int
    note: str = ""
    held: Mapping[int, sp.Expr] = field(default_factory=dict)

    def __str__(self) -> str:
        constant = ", ".join(map(sp.sstr, self.integrals))
        free = self.integrable - len(self.held)
        lines = {
            f"{self.integrable} integrable: positions remain restricted": self.integrable,
            f"constant along a motion: {constant}": constant,
            f"{free} without an integral that can be kept at its value at the start: positions "
            "leave it by the error of the method": free,
            f"{self.nonholonomic} not integrable: no positions are restricted, and multipliers "
            "enforce the constraints; they must not be used to remove velocities from the "
            "Lagrangian, whose derivatives would lack forces": self.nonholonomic,
            f"not decided, taken as not integrable: {self.note}": self.note,
        }
        return "; ".join(line for line, applies in lines.items() if applies)


def integrability(
    system: System, holonomic: Sequence[sp.Expr], rates: Sequence[sp.Expr]
) -> Integrability:
    """Whether constraints of velocities are constraints of positions.

    Parameters
    ----------
    system : System
        The system of the constraints.
    holonomic : sequence of sympy.Expr
        Constraints of positions.
    rates : sequence of sympy.Expr
        Constraints of velocities.

    Returns
    -------
    Integrability
        An exact decision at generic states; without one if a formula is not rational in
        coordinates, parameters, sines and cosines.
    """
    if not rates:
        return Integrability((), 0, 0)
    variables = (*system.q, *system.u, TIME)
    try:
        forms = [_form(system, rate) for rate in rates]
        functions = TrigonometricField([*holonomic, *chain(*forms)], variables)
        gradients = [functions.gradient(functions.value(phi)) for phi in holonomic]
        rows = [[functions.value(entry) for entry in form] for form in forms]
    except (NotImplementedError, sp.CoercionFailed) as error:
        return Integrability((), 0, len(rates), str(error))
    known, rank, derived = _ranks_at_a_point(functions, [*gradients, *rows], len(gradients))
    if derived == known:  # at one point, hence at generic ones
        return Integrability((), 0, rank - known)
    if sum(len(entry.numer) + len(entry.denom) for row in rows for entry in row if entry) > LONGEST:
        return Integrability((), 0, rank - known, "the constraints are too long")
    every = _Forms(functions, [*gradients, *rows])
    closed = every.integrable
    count = closed.rank - functions.rank(gradients)
    candidates = closed.integrals(gradients, count)
    held = RegularIntegrals(functions, gradients, rows, candidates).most(count)
    integrals = _independent(functions, gradients, [*held.values(), *candidates])
    return Integrability(integrals, count, every.rank - closed.rank, held=held)


def _independent(
    functions: TrigonometricField, known: Sequence[Sequence[Any]], integrals: Sequence[sp.Expr]
) -> tuple[sp.Expr, ...]:
    """Integrals of which none is a function of those before it and the known differentials."""
    gradients, result = [*known], list[sp.Expr]()
    rank = functions.rank(gradients)
    for formula in integrals:
        gradient = functions.gradient(functions.value(formula))
        if functions.rank([*gradients, gradient]) == rank + len(result) + 1:
            gradients.append(gradient)
            result.append(formula)
    return tuple(result)


def _form(system: System, rate: sp.Expr) -> list[sp.Expr]:
    """Coefficients of the differentials of coordinates, inputs and time."""
    at_rest = dict.fromkeys(system.qdot, sp.S.Zero)
    slopes = [derivative(rate, v).xreplace(at_rest) for v in system.qdot]
    return [*slopes, *(sp.S.Zero for _ in system.u), rate.xreplace(at_rest)]


def _ranks_at_a_point(
    functions: TrigonometricField, forms: Sequence[Sequence[Any]], known: int
) -> tuple[int, int, int]:
    """Ranks of the first `known` forms, of all, and of their derived ones, at a point."""
    n, at = range(len(functions.variables)), functions.at_a_point
    values = [[at(entry) for entry in form] for form in forms]
    gradients = [[[*map(at, functions.gradient(entry))] for entry in form] for form in forms]
    matrix = DomainMatrix(values, (len(forms), len(n)), sp.QQ)
    pairs = [*combinations(matrix.nullspace().to_list(), 2)]
    brackets = [
        [sum(((d[b][a] - d[a][b]) * X[a] * Y[b] for a in n for b in n), sp.QQ.zero)
         for X, Y in pairs]
        for d in gradients
    ]  # fmt: skip
    first = DomainMatrix(values[:known], (known, len(n)), sp.QQ).rank() if known else 0
    curvature = DomainMatrix(brackets, (len(forms), len(pairs)), sp.QQ).rank()
    return first, matrix.rank(), matrix.rank() - curvature


class _Forms:
    """Independent linear forms of the differentials of all variables."""

    def __init__(self, functions: TrigonometricField, rows: Sequence[Sequence[Any]]) -> None:
        self._functions, self._field = functions, functions.field
        shape = (len(rows), len(functions.variables))
        matrix, pivots = DomainMatrix([*map(list, rows)], shape, self._field).rref()
        self._pivots = pivots
        self._rows = [list(row) for row in matrix.to_list()[: len(pivots)]]
        self._free = [k for k in range(shape[1]) if k not in pivots]

    @property
    def rank(self) -> int:
        """The number of independent forms."""
        return len(self._pivots)

    def _along(self, k: int, gradient: Sequence[Any]) -> Any:
        """The derivative along the displacement of the variable k that all forms allow."""
        others = zip(self._rows, self._pivots, strict=True)
        return sum((-row[k] * gradient[p] for row, p in others), gradient[k])

    @cached_property
    def integrable(self) -> "_Forms":
        """The combinations of the forms that are combinations of differentials."""
        if not self._rows:
            return self
        gradients = [[self._functions.gradient(entry) for entry in row] for row in self._rows]
        pairs = [*combinations(self._free, 2)]
        brackets = [
            [self._along(j, row[k]) - self._along(k, row[j]) for j, k in pairs] for row in gradients
        ]
        if not any(map(any, brackets)):
            return self
        matrix = DomainMatrix(brackets, (self.rank, len(pairs)), self._field)
        kept = matrix.transpose().nullspace().to_list()
        columns = range(len(self._functions.variables))
        rows = [
            [sum((c * row[k] for c, row in zip(one, self._rows, strict=True)), self._field.zero)
             for k in columns]
            for one in kept
        ]  # fmt: skip
        return _Forms(self._functions, rows).integrable

    @property
    def _letters(self) -> list[sp.Expr]:
        """Variables, sines and cosines in the forms."""
        functions, entries = self._functions, [*chain(*self._rows)]
        is_used = {
            v: any(row[k] for row in self._rows) or any(functions.derivative(e, v) for e in entries)
            for k, v in enumerate(functions.variables)
        }
        used = {v for v, yes in is_used.items() if yes}
        waves = (wave for wave in functions.waves if wave.free_symbols & used)
        return [*(v for v in functions.variables if v in used), *waves]

    def integrals(self, known: list[list[Any]], count: int) -> list[sp.Expr]:
        """Functions with differentials among the forms, `count` of which are independent.

        Fewer if they are not found. Independence is that of each other and of the known ones.
        """
        functions, result = self._functions, list[sp.Expr]()
        for degree in range(1, HIGHEST_DEGREE + 1):
            if len(_independent(functions, known, result)) == count:
                break
            result += self._polynomials(degree)
        return result

    def _polynomials(self, degree: int) -> Iterator[sp.Expr]:
        """Polynomials of a degree with differentials among the forms."""
        functions, letters = self._functions, self._letters
        terms = [
            sp.Mul(*factors)
            for n in range(degree, 0, -1)
            for factors in combinations_with_replacement(letters, n)
            # sin² + cos² = 1
            if not any(factors.count(w) > 1 for w in functions.waves if isinstance(w, sp.cos))
        ]
        if len(terms) > MOST_TERMS:
            return
        rows = self._equations([functions.gradient(functions.value(term)) for term in terms])
        shape = (len(rows), len(terms))
        for vector in (
            DomainMatrix(dict(enumerate(rows)), shape, functions.numbers).nullspace().to_list()
        ):
            pairs = zip(map(functions.numbers.to_sympy, vector), terms, strict=True)
            total = sp.Add(*(c.xreplace(functions.tangents) * term for c, term in pairs))
            numerator = sp.factor_terms(sp.numer(sp.together(total)))
            yield numerator.as_independent(*functions.variables, as_Add=False)[1]

    def _equations(self, gradients: Sequence[Sequence[Any]]) -> list[dict[int, Any]]:
        """Linear equations of the constant factors with which a sum of gradients is a form."""
        functions, numbers = self._functions, self._functions.numbers
        equations: dict[tuple[int, ...], dict[int, Any]] = {}
        split = len(functions.moving)
        for k in self._free:
            slopes = [self._along(k, gradient) for gradient in gradients]
            common = reduce(lambda a, b: a.lcm(b), (slope.denom for slope in slopes))
            for column, slope in enumerate(slopes):
                for powers, number in (slope.numer * common.exquo(slope.denom)).terms():
                    row = equations.setdefault((k, *powers[:split]), {})
                    value = sp.Mul(number, *map(sp.Pow, functions.constants, powers[split:]))
                    row[column] = row.get(column, numbers.zero) + numbers.from_sympy(value)
        return [{j: x for j, x in row.items() if x} for row in equations.values()]
