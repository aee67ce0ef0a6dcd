"""Positions as sums of increments that masses share: the kinematic tree of a system.

In a chain r_k = r_{k-1} + d_k, and the increment d_k depends on few coordinates. Accelerations and
forces along such branches take a number of operations that grows with the number of coordinates,
not with its cube (R. Featherstone, Rigid Body Dynamics Algorithms, 2008, chapters 5 and 7). Where
sines and cosines are those of sums of angles, such as θ1 + θ2, sums take the places of angles.
"""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TypeAlias

import sympy as sp

from derive.formulas.budget import is_expandable
from derive.formulas.functions import derivative
from derive.mechanics.energies.reduction import reduced

Vector: TypeAlias = tuple[sp.Expr, ...]
#: A mass and its position, or a moment of inertia and the angle of a body in the plane.
Motion: TypeAlias = tuple[sp.Expr, Vector]
#: The indices of the variables that an increment depends on, and its components.
Increment: TypeAlias = tuple[tuple[int, ...], Vector]

#: Fewest changed entries of an elimination that are worth a tree: two variables beyond a third
#: one, in the plane, take as many with it.
FEWEST = 8
#: Terms of the largest component of a position that is expanded.
MOST_TERMS = 1000


@dataclass(frozen=True)
class TreeBranch:
    """The increment from one point to another, and the inertia of the masses at its end."""

    parent: int | None  # the branch at whose end it begins; None at a fixed point
    variables: tuple[int, ...]
    increment: Vector  # functions of the variables and parameters
    inertia: sp.Expr


@dataclass(frozen=True)
class Elimination:
    """A variable whose acceleration follows from those of others, and of the end of a branch."""

    variable: int
    branch: int | None
    others: tuple[int, ...]


#: Either a branch whose inertia is added to that of its parent, or a variable.
Step: TypeAlias = int | Elimination


@dataclass(frozen=True)
class KinematicTree:
    """The branches of a system, parents first, and its variables φ = `sums` q.

    Attributes
    ----------
    branches : tuple of Branch
    coordinates, variables : tuple of sympy.Symbol
        The symbols of q and of φ.
    sums : sympy.ImmutableDenseMatrix
        Integers, n × n, regular; the identity if no sums of angles occur.
    """

    branches: tuple[TreeBranch, ...]
    coordinates: tuple[sp.Symbol, ...]
    variables: tuple[sp.Symbol, ...]
    sums: sp.ImmutableDenseMatrix

    @cached_property
    def differences(self) -> sp.ImmutableDenseMatrix:
        """The matrix D of q = D φ."""
        return self.sums.inv()

    @cached_property
    def steps(self) -> tuple[Step, ...]:
        """The order of elimination, from the ends of the tree to its root."""
        return tuple(_steps(self.branches))

    @property
    def updates(self) -> int:
        """Entries that the elimination changes."""
        eliminations = (step for step in self.steps if isinstance(step, Elimination))
        return sum((len(one.others) + self._size(one.branch)) ** 2 for one in eliminations)

    def _size(self, branch: int | None) -> int:
        return 0 if branch is None else len(self.branches[branch].increment)

    @cached_property
    def inertia_beyond(self) -> list[sp.Expr]:
        """The inertia at the end of each branch and beyond."""
        total = [branch.inertia for branch in self.branches]
        for k in reversed(range(len(total))):
            parent = self.branches[k].parent
            if parent is not None:
                total[parent] += total[k]
        return total

    def tangent(self, k: int, variable: int) -> Vector:
        """The derivative of the increment of branch k with respect to a variable."""
        return tuple(derivative(d, self.variables[variable]) for d in self.branches[k].increment)

    def dot(self, k: int, i: int, j: int, *, above: int | None = None) -> sp.Expr:
        """The product of tangents of branch k, or of k and a branch `above` it."""
        pairs = zip(self.tangent(k, i), self.tangent(k if above is None else above, j), strict=True)
        return reduced(sp.Add(*(a * b for a, b in pairs)))

    @cached_property
    def inertia(self) -> sp.ImmutableDenseMatrix:
        """The mass matrix Σ m JᵀJ of the variables, as a function of the coordinates."""
        n = len(self.variables)
        terms: list[list[list[sp.Expr]]] = [[[] for _ in range(n)] for _ in range(n)]
        for k, branch in enumerate(self.branches):
            # the inertia beyond a branch moves with it and with all branches above
            inertia, above = self.inertia_beyond[k], branch.parent
            for i in branch.variables:
                for j in branch.variables:
                    terms[i][j].append(inertia * self.dot(k, i, j))
            while above is not None:
                for i in branch.variables:
                    for j in self.branches[above].variables:
                        product = inertia * self.dot(k, i, j, above=above)
                        terms[i][j].append(product)
                        terms[j][i].append(product)
                above = self.branches[above].parent
        sums = dict(zip(self.variables, self.sums * sp.Matrix(self.coordinates), strict=True))
        matrix = sp.ImmutableDenseMatrix(n, n, lambda i, j: sp.Add(*terms[i][j]))
        return matrix.xreplace(sums)

    def mass_matrix(self, inertia: sp.ImmutableDenseMatrix) -> sp.ImmutableDenseMatrix:
        """The mass matrix of the coordinates, from that of the variables."""
        if self.variables == self.coordinates:
            return inertia
        return self.sums.T * inertia * self.sums


def kinematic_tree(
    coordinates: Sequence[sp.Symbol], motions: Sequence[Motion]
) -> KinematicTree | None:
    """The tree of positions that depend on coordinates alone, if it shortens the equations."""
    q, without = tuple(coordinates), _dense_updates(coordinates, motions)
    if without < FEWEST:
        return None
    trees = [_tree(q, q, sp.ImmutableDenseMatrix.eye(len(q)), motions)]
    sums = _sums(q, motions)
    if not sums.is_Identity:
        # names that no symbol of a system has
        names = (str(one) for one in sums * sp.Matrix(q))
        variables = tuple(sp.Symbol(name, real=True) for name in names)
        trees.append(_tree(q, variables, sums, motions))
    best = min((tree for tree in trees if tree), key=lambda tree: tree.updates, default=None)
    # entries of angles that occur in sums are longer than others
    limit = without / (2 if best and best.variables == q else 1)
    return best if best and best.updates < limit else None


def _dense_updates(q: Sequence[sp.Symbol], motions: Sequence[Motion]) -> int:
    """Entries that the elimination of the mass matrix changes, without a tree."""
    moving = [{k for k, s in enumerate(q) if sp.Tuple(*r).has(s)} for _, r in motions]
    coupled: list[set[int]] = [set().union(*(m for m in moving if k in m)) for k in range(len(q))]
    updates = 0
    for k in reversed(range(len(q))):
        others = {i for i in coupled[k] if i < k}
        updates += len(others) ** 2
        for i in others:
            coupled[i] |= others
    return updates


def _sums(q: Sequence[sp.Symbol], motions: Sequence[Motion]) -> sp.ImmutableDenseMatrix:
    """Rows of weights: for each coordinate the sum that ends with it, of which most waves are."""
    arguments = [r for _, position in motions if len(position) == 1 for r in position]
    for _, position in motions:
        waves = {wave for r in position for wave in r.atoms(sp.sin, sp.cos)}
        arguments += [wave.args[0] for wave in waves]
    counts = Counter(row for row in (_weights(q, one) for one in arguments) if row)
    rows = {k: tuple(int(i == k) for i in range(len(q))) for k in range(len(q))}
    for row in sorted(counts, key=lambda row: (counts[row], row)):  # the last one is kept
        rows[max(k for k, weight in enumerate(row) if weight)] = row
    return sp.ImmutableDenseMatrix([rows[k] for k in range(len(q))])


def _weights(q: Sequence[sp.Symbol], argument: sp.Expr) -> tuple[int, ...] | None:
    """The integers of a linear combination of coordinates, up to a constant and its sign."""
    terms = argument.as_coefficients_dict()
    weights = [terms.pop(s, sp.S.Zero) for s in q]
    if not any(weights) or not all(weight.is_Integer for weight in weights):
        return None
    if any(term.has(*q) for term in terms):
        return None
    sign = next(sp.sign(weight) for weight in reversed(weights) if weight)
    return tuple(int(weight * sign) for weight in weights)


def _tree(
    q: tuple[sp.Symbol, ...],
    variables: tuple[sp.Symbol, ...],
    sums: sp.ImmutableDenseMatrix,
    motions: Sequence[Motion],
) -> KinematicTree | None:
    """Common beginnings of positions as common branches; None if positions are too long."""
    known = dict(zip(q, sums.inv() * sp.Matrix(variables), strict=True))
    if not all(is_expandable(r, largest=MOST_TERMS) for _, position in motions for r in position):
        return None
    parts = [
        (inertia, _increments([sp.expand(r.xreplace(known)) for r in position], variables))
        for inertia, position in motions
    ]
    # those of many masses are near the root
    counts = Counter(moving for _, increments in parts for moving, _ in increments)
    places: dict[tuple[int | None, Increment], int] = {}
    branches: list[TreeBranch] = []
    masses: list[list[sp.Expr]] = []
    for inertia, increments in parts:
        parent: int | None = None
        for increment in sorted(increments, key=lambda one: (-counts[one[0]], one[0])):
            place = (parent, increment)
            if place not in places:
                places[place] = len(branches)
                branches.append(TreeBranch(parent, *increment, sp.S.Zero))
                masses.append([])
            parent = places[place]
        if parent is not None:
            masses[parent].append(inertia)
    loaded = (
        TreeBranch(branch.parent, branch.variables, branch.increment, sp.Add(*own))
        for branch, own in zip(branches, masses, strict=True)
    )
    return KinematicTree(tuple(loaded), q, variables, sums)


def _increments(position: Sequence[sp.Expr], variables: Sequence[sp.Symbol]) -> list[Increment]:
    """The terms of a position, by the variables that they depend on; constants do not move."""
    parts: dict[tuple[int, ...], list[list[sp.Expr]]] = {}
    for axis, component in enumerate(position):
        for term in sp.Add.make_args(component):
            moving = tuple(k for k, s in enumerate(variables) if s in term.free_symbols)
            if moving:
                own = parts.setdefault(moving, [[] for _ in position])
                own[axis].append(term)
    return [(moving, tuple(sp.Add(*terms) for terms in own)) for moving, own in parts.items()]


def _steps(branches: Sequence[TreeBranch]) -> Iterator[Step]:
    """Branches from the ends, and each variable when at most one point depends on it."""
    remaining = {i for branch in branches for i in branch.variables}
    waiting = {i: {k for k, one in enumerate(branches) if i in one.variables} for i in remaining}
    ends: dict[int, set[int]] = {i: set() for i in remaining}  # that a variable is coupled with
    others: dict[int, set[int]] = {i: set() for i in remaining}
    parents = {branch.parent for branch in branches}
    # branches that start and end without others couple variables alone
    alone = [k for k, one in enumerate(branches) if one.parent is None and k not in parents]
    joined = [k for k in reversed(range(len(branches))) if k not in alone]
    for k in [*alone, *joined, None]:
        if k is not None:
            yield k
            branch = branches[k]
            coupled = {*branch.variables, *(i for i in remaining if k in ends[i])}
            for i in coupled:
                others[i] |= coupled - {i}
                ends[i].discard(k)
                ends[i] |= set() if branch.parent is None else {branch.parent}
            for i in branch.variables:
                waiting[i].discard(k)
        for i in sorted(remaining, reverse=True):
            if not waiting[i] and len(ends[i]) <= (1 if k is not None else 0):
                remaining.discard(i)
                partners = others[i] & remaining
                yield Elimination(i, next(iter(ends[i]), None), tuple(sorted(partners)))
                for j in partners:
                    others[j] |= partners - {j}
                    ends[j] |= ends[i]
