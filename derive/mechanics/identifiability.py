"""Combinations of parameters that measurements can determine, decided from the equations.

Outputs of a motion determine as many combinations of the unknown parameters and initial states as
their Taylor coefficients in time have independent derivatives (A. Sedoglavic, Journal of Symbolic
Computation 33 (2002) 735-755). Inputs are known, and have random coefficients. The rank is computed
exactly, modulo a prime, at random points, so that it is wrong with a probability below 1e-6 only.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import count
from math import lcm

import numpy as np
import sympy as sp

from derive.formulas.residues import (
    PRIME,
    Evaluation,
    NoRootError,
    RandomResidues,
    Residues,
    ResidueSeries,
    Rows,
    branches,
    echelon,
    inverse,
    null_space,
    solved,
    without,
)
from derive.system.symbols import TIME, prescribed_symbols
from derive.system.system import System
from solvers.io.suggestion import counted

#: Random values of the parameters that decide together.
VALUES = 2
#: Attempts to find a point at which all roots exist, and largest numerator of an exponent.
ATTEMPTS, LARGEST = 200, 30


@dataclass(frozen=True)
class Group:
    """Unknown parameters of which outputs determine fewer combinations than there are parameters.

    Attributes
    ----------
    parameters : tuple of str
        Their names.
    determined : int
        Number of independent combinations that outputs determine.
    combinations : tuple of sympy.Expr
        These, where they are products of powers or sums of multiples; else empty.
    """

    parameters: tuple[str, ...]
    determined: int
    combinations: tuple[sp.Expr, ...]

    def __str__(self) -> str:
        missing = len(self.parameters) - self.determined
        remedy = "one of them a value" if missing == 1 else f"{missing} of them values"
        end = f"; give {remedy}" if self.determined else ""
        return f"{', '.join(self.parameters)}: {self.reason}{end}"

    @property
    def reason(self) -> str:
        """The combinations in words."""
        if not self.determined:
            return "no output depends on it"
        if self.combinations:
            return f"only as {', '.join(map(str, self.combinations))}"
        of_all = ", ".join(self.parameters)
        return f"only as {counted(self.determined, 'function')} of {of_all}"


@dataclass(frozen=True)
class Identifiability:
    """Which unknown parameters the outputs of a motion determine.

    Attributes
    ----------
    unknown : tuple of str
        The unknown parameters.
    groups : tuple of Group
        Those that are not determined, in groups that depend on each other.

    Examples
    --------
    >>> from derive import Derivation, load
    >>> print(Derivation(load("single_pendulum")).identifiable())
    m: no output depends on it
    l, g: only as g/l; give one of them a value
    """

    unknown: tuple[str, ...]
    groups: tuple[Group, ...]
    _free: tuple[tuple[int, ...], ...]  # a basis of changes without effect, modulo the prime

    def __str__(self) -> str:
        known = [name for name in self.unknown if name in self.determined]
        lines = [str(group) for group in self.groups]
        return "\n".join([*([f"{', '.join(known)}: determined"] if known else []), *lines])

    @property
    def determined(self) -> tuple[str, ...]:
        """The unknown parameters that are determined."""
        others = {name for group in self.groups for name in group.parameters}
        return tuple(name for name in self.unknown if name not in others)

    def to_hold(self, order: Sequence[str] = ()) -> tuple[str, ...]:
        """Fewest parameters whose values must be given so that all others are determined.

        Those in `order` come first.
        """
        names = sorted(self.unknown, key=lambda name: [*order, name].index(name))
        rows, held = [list(row) for row in self._free], []
        for name in names:
            k = self.unknown.index(name)
            pivot = next((row for row in rows if row[k]), None)
            if pivot is not None:
                held.append(name)
                rows = [without(row, pivot, k) for row in rows if row is not pivot]
        return tuple(name for name in self.unknown if name in held)


def identifiability(
    system: System,
    mass_matrix: sp.ImmutableDenseMatrix,
    forcing: sp.ImmutableDenseMatrix,
    outputs: Sequence[sp.Expr],
    unknown: Sequence[sp.Symbol],
) -> Identifiability:
    """Which of the `unknown` parameters the `outputs` of M q̈ = f determine, from unknown starts."""
    names = tuple(symbol.name for symbol in unknown)
    points = (_rows_and_values(system, mass_matrix, forcing, outputs, unknown, k) for k in count())
    results = [next(points) for _ in range(VALUES)]
    changes = [null_space(rows, len(unknown)) for rows, _ in results]
    groups = []
    for members in _components(changes[0], len(unknown)):
        own = [
            [[row[k] for k in members] for row in rows if any(row[k] for k in members)]
            for rows in changes
        ]
        symbols, determined = [unknown[k] for k in members], len(members) - len(own[0])
        values = [[numbers[k] for k in members] for _, numbers in results]
        combinations = _combinations(symbols, own, values) if determined else ()
        groups.append(Group(tuple(names[k] for k in members), determined, combinations))
    return Identifiability(names, tuple(groups), tuple(map(tuple, changes[0])))


def _rows_and_values(
    system: System,
    mass_matrix: sp.ImmutableDenseMatrix,
    forcing: sp.ImmutableDenseMatrix,
    outputs: Sequence[sp.Expr],
    unknown: Sequence[sp.Symbol],
    number: int,
) -> tuple[Rows, list[int]]:
    """Conditions on changes of the parameters that leave all outputs as they are; their values."""
    values = RandomResidues(number)
    parameters = {symbol: values.residue(symbol) for symbol in (*system.params, *system.u)}
    conditions: Rows = []
    seeds = iter(range(ATTEMPTS * (number + 1), ATTEMPTS * (number + 2)))
    for choices in ({}, *branches([*mass_matrix, *forcing, *outputs])):
        rows: Rows = []
        for seed in seeds:
            try:
                motion = _MotionSeries(system, parameters, unknown, RandomResidues(seed, choices))
                rows = motion.derivatives(mass_matrix, forcing, outputs)
                break
            except NoRootError:
                continue
        else:
            raise NoRootError(f"the equations of {system.name!r} have no value at random points")
        state = 2 * len(system.q)
        conditions += [row[state:] for row in rows if not any(row[:state])]
    return conditions, [parameters[symbol] for symbol in unknown]


class _MotionSeries:
    """A motion from a random state, as series in time with derivatives by start and parameters."""

    def __init__(
        self,
        system: System,
        parameters: dict[sp.Symbol, int],
        unknown: Sequence[sp.Symbol],
        point: RandomResidues,
    ) -> None:
        self._system, self._point = system, point
        self._columns = [*system.q, *system.qdot, *unknown]
        prescribed = prescribed_symbols(system.inputs)
        self._varying = {*system.u} - prescribed
        self._numbers = parameters | {s: point.residue(s) for s in (*system.q, *system.qdot, TIME)}

    def derivatives(
        self,
        mass_matrix: sp.ImmutableDenseMatrix,
        forcing: sp.ImmutableDenseMatrix,
        outputs: Sequence[sp.Expr],
    ) -> Rows:
        """Derivatives of the Taylor coefficients of the outputs, in echelon form."""
        n, rank, rows = len(self._system.q), -1, Rows()
        accelerations = [np.zeros((1 + len(self._columns), 0), np.int64)] * n
        # a derivative that adds no rank is followed by none that does, unless inputs change
        most = len(self._columns)
        orders = most if self._varying else 0
        while len(rows) < most and (len(rows) > rank or accelerations[0].shape[1] < orders):
            rank = len(rows)
            evaluation = self._evaluation(accelerations)
            series = [evaluation(output).rows for output in outputs]
            rows = echelon([row for part in series for row in part[1:].T.tolist()])
            matrix = [[evaluation(entry) for entry in mass_matrix.row(i)] for i in range(n)]
            solution = solved(matrix, [evaluation(force) for force in forcing])
            accelerations = [part.rows for part in solution]
        return rows

    def _evaluation(self, accelerations: Sequence[Residues]) -> Evaluation:
        """Evaluation of expressions as series that are longer by one term than accelerations."""
        length, known = 1 + accelerations[0].shape[1], dict[sp.Basic, ResidueSeries]()
        for symbol, number in self._numbers.items():
            rows = np.zeros((1 + len(self._columns), length), np.int64)
            rows[0, 0] = number
            if symbol in self._columns:
                rows[1 + self._columns.index(symbol), 0] = 1
            if symbol == TIME:
                rows[0, 1:2] = 1
            if symbol in self._varying:
                rows[0, 1:] = [self._point.residue((symbol, k)) for k in range(1, length)]
            known[symbol] = ResidueSeries(rows)
        pairs = zip(self._system.q, self._system.qdot, accelerations, strict=True)
        for q, velocity, acceleration in pairs:
            for symbol, rates in ((velocity, acceleration), (q, known[velocity].rows)):
                rows = known[symbol].rows
                for k in range(1, length):
                    rows[:, k] = rates[:, k - 1] * inverse(k) % PRIME
        return Evaluation(known, self._point)


def _components(rows: Rows, columns: int) -> list[list[int]]:
    """Indices of entries that are not 0, in groups of which no row of an echelon form has two."""
    groups: list[set[int]] = []
    for row in rows:
        own = {k for k in range(columns) if row[k]}
        for group in [group for group in groups if group & own]:
            own |= group
            groups.remove(group)
        groups.append(own)
    return sorted(map(sorted, groups))


def _combinations(
    symbols: Sequence[sp.Symbol], changes: Sequence[Rows], values: Sequence[Sequence[int]]
) -> tuple[sp.Expr, ...]:
    """Monomials, or sums of multiples, that no change affects; none if there are no such."""
    kinds: tuple[tuple[Callable[[int], int], Callable[[sp.Symbol, int], sp.Expr], type], ...] = (
        (inverse, lambda symbol, k: symbol**k, sp.Mul),
        (lambda value: 1, lambda symbol, k: k * symbol, sp.Add),
    )
    for weight, part, whole in kinds:
        candidates = []
        for rows, numbers in zip(changes, values, strict=True):
            weights = [weight(number) for number in numbers]
            scaled = [[a * w % PRIME for a, w in zip(row, weights, strict=True)] for row in rows]
            # the last symbols stand in the denominators
            reverse = [row[::-1] for row in scaled]
            candidates.append([row[::-1] for row in null_space(reverse, len(symbols))])
        if all(candidate == candidates[0] for candidate in candidates):
            exponents = [_integers(row) for row in candidates[0]]
            if all(exponents):
                return tuple(
                    whole(*(part(s, k) for s, k in zip(symbols, row, strict=True)))
                    for row in exponents
                )
    return ()


def _integers(row: Sequence[int]) -> list[int]:
    """Small integers in the same ratios as residues; empty if there are none."""
    fractions = []
    for residue in row:
        pairs = ((residue * below % PRIME, below) for below in range(1, LARGEST))
        signed = ((above - PRIME * (2 * above > PRIME), below) for above, below in pairs)
        result = next((pair for pair in signed if abs(pair[0]) < LARGEST), None)
        if result is None:
            return []
        fractions.append(Fraction(*result))
    common = lcm(*(fraction.denominator for fraction in fractions))
    return [int(fraction * common) for fraction in fractions]
