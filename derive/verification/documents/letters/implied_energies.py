"""Energies that follow from a Hamiltonian or matrices of a document, and potentials of forces."""

import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from functools import lru_cache
from itertools import combinations

import sympy as sp
from sympy.integrals.manualintegrate import manualintegrate

from derive.formulas.expression import Value, parse
from derive.formulas.syntax import ExpressionError
from derive.formulas.zero import vanishes
from derive.system.symbols import acceleration, velocity
from derive.verification.documents.letters.letters import Letters, composed
from derive.verification.documents.statements import ENTRY, DocumentFormula, definitions

#: Kinetic and potential energy, and the numbers of the formulas that state them.
Energies = tuple[sp.Expr, sp.Expr, frozenset[int]]
#: Most coordinates, and operations of an entry of the mass matrix or of a force.
MAX_COORDINATES, MAX_OPERATIONS = 3, 150


def energies_of_hamiltonians(
    letters: Letters, formulas: Sequence[DocumentFormula], names: Mapping[str, Value]
) -> Iterator[Energies]:
    """Yield the energies of which a Hamiltonian of the document is the sum, by its momenta."""
    rates = {q: velocity(names[q]) for q in letters.coordinates}
    momenta = {p: sp.Symbol(f"{p}_momentum") for p, q in letters.momenta.items() if q in rates}
    scope = {**names, **momenta}
    if not 0 < len(momenta) <= MAX_COORDINATES:
        return
    columns = [*momenta.values()]
    v = sp.Matrix([rates[q] for p, q in letters.momenta.items() if p in momenta])
    for H, numbers in _hamiltonians(letters, formulas, scope, momenta):
        with suppress(NotImplementedError, ValueError, TypeError):
            inverse = sp.ImmutableDenseMatrix(sp.hessian(H, columns))
            determinant = inverse.det(method="berkowitz")
            if inverse.free_symbols & {*columns} or determinant == 0:
                continue
            if max(map(sp.count_ops, inverse)) > MAX_OPERATIONS:
                continue
            at_rest = dict.fromkeys(columns, sp.S.Zero)
            drift = sp.Matrix([H.diff(p) for p in columns]).xreplace(at_rest)
            # elimination simplifies every step
            mass = (inverse.adjugate() / determinant).applyfunc(sp.cancel)
            T = (v.T * mass * (v / 2 - drift))[0, 0]
            yield T, H.xreplace(at_rest) - (drift.T * mass * drift)[0, 0] / 2, numbers


def _hamiltonians(
    letters: Letters,
    formulas: Sequence[DocumentFormula],
    scope: Mapping[str, Value],
    momenta: Mapping[str, sp.Symbol],
) -> Iterator[tuple[sp.Expr, frozenset[int]]]:
    """Yield Hamiltonians that are stated, and the one that the canonical equations determine."""
    rates: dict[str, tuple[sp.Expr, int]] = {}
    written = set[str]()
    for number, formula in enumerate(formulas):
        for name, text in definitions(formula):
            is_rate = name.endswith("_dot")
            if is_rate or letters.quantities.get(name) == "hamiltonian":
                with suppress(ExpressionError, NotImplementedError, ValueError, TypeError):
                    value = parse(text, scope)
                    if not isinstance(value, sp.Expr):
                        continue
                    if is_rate:
                        rates[name] = value, number
                    else:
                        written |= {*formula.words} & {*letters.parameters}
                        yield value, frozenset({number})
    needed = [f"{one}_dot" for p in momenta for one in (p, letters.momenta[p])]
    if not {*needed} <= {*rates}:
        return
    if written - {word for name in needed for word in formulas[rates[name][1]].words}:
        return  # equations in units in which a parameter of H is 1
    q = [scope[letters.momenta[p]] for p in momenta]
    slopes = [rates[f"{letters.momenta[p]}_dot"][0] for p in momenta]
    T = sp.Add(*(p * slope for p, slope in zip(momenta.values(), slopes, strict=True))) / 2
    forces = [rates[f"{p}_dot"][0] for p in momenta]
    gradient = [sp.expand(-force - T.diff(x)) for x, force in zip(q, forces, strict=True)]
    if sp.Tuple(*gradient).free_symbols & {*momenta.values()}:
        return
    V = potential_of(gradient, q)
    if V is not None and all(
        sp.expand(T.diff(p) - slope) == 0 for p, slope in zip(momenta.values(), slopes, strict=True)
    ):
        # an equation with no other force than those of T follows from the others
        stating = {rates[f"{one}_dot"][1] for one in map(letters.momenta.get, momenta)}
        pairs = zip(momenta, gradient, strict=True)
        yield T + V, frozenset(stating | {rates[f"{p}_dot"][1] for p, one in pairs if one != 0})


def energies_of_matrices(
    letters: Letters,
    formulas: Sequence[DocumentFormula],
    names: Mapping[str, Value],
    potentials: Sequence[tuple[sp.Expr, int]],
) -> Iterator[Energies]:
    """Yield the energies of a stated mass matrix and of stated potentials, or of a column G.

    The matrix is that in M*q_ddot, and G is the gradient of a potential.
    """
    symbols = [names.get(q) for q in letters.ordered]
    q = [one for one in symbols if isinstance(one, sp.Symbol)]
    if not letters.column or len(q) != len(symbols):
        return
    v = sp.Matrix([velocity(one) for one in q])
    accelerated = re.compile(rf"\b(\w+)\*{letters.column}_ddot\b")
    texts = [side.text for one in formulas for side in one.sides]
    for name in dict.fromkeys(match for text in texts for match in accelerated.findall(text)):
        M, stating = _written_out(name, (len(q), len(q)), formulas, names)
        if M is None or not M.is_symmetric() or M.free_symbols & {*v}:
            continue
        T = (v.T * M * v)[0, 0] / 2
        for V, number in potentials:
            yield T, V, stating | {number}
        columns = (name for name, kind in letters.quantities.items() if kind == "gravity")
        for column in dict.fromkeys((*columns, "G_column", "g_column")):
            G, others = _written_out(column, (len(q), 1), formulas, names)
            if G is not None and (V := potential_of(list(G), q)) is not None:
                yield T, V, stating | others


def _written_out(
    name: str,
    shape: tuple[int, int],
    formulas: Sequence[DocumentFormula],
    names: Mapping[str, Value],
) -> tuple[sp.ImmutableDenseMatrix | None, frozenset[int]]:
    """A matrix that a document states, or all of its entries, and the numbers of the formulas."""
    value: object = names.get(name)
    letter = name.removesuffix("_column")
    stated = frozenset(k for k, one in enumerate(formulas) if one.subject == name)
    if not isinstance(value, sp.MatrixBase):
        value = dict(composed((name,), names, shape[0])).get(name)
        entries = ((k, ENTRY.match(one.subject)) for k, one in enumerate(formulas))
        stated = frozenset(k for k, entry in entries if entry and entry[1] == letter)
    if not isinstance(value, sp.MatrixBase) or value.shape != shape:
        return None, frozenset()
    return sp.ImmutableDenseMatrix(value), stated


def inertial(kinetic: sp.Expr, q: Sequence[sp.Symbol], index: int) -> sp.Expr:
    """The terms of Lagrange's equation of a coordinate without a potential."""
    p = kinetic.diff(velocity(q[index]))
    pairs = ((one, velocity(one)) for one in q)
    rate = sp.Add(*(p.diff(one) * v + p.diff(v) * acceleration(one) for one, v in pairs))
    return rate - kinetic.diff(q[index])


def potential_of(gradient: Sequence[sp.Expr], q: Sequence[sp.Symbol]) -> sp.Expr | None:
    """A function with a gradient; None if there is none, or it is not found quickly."""
    rates = {s for one in q for s in (velocity(one), acceleration(one))}
    V = sp.S.Zero
    # of quotients with common factors, integrals take many times as long
    gradient = [
        slope if slope.is_polynomial(*q) or not slope.is_rational_function(*q) else sp.cancel(slope)
        for slope in gradient
    ]
    if any(slope.free_symbols & rates for slope in gradient):
        return None
    pairs = combinations(zip(q, gradient, strict=True), 2)
    if not all(_is_zero(f.diff(y) - g.diff(x)) for (x, f), (y, g) in pairs):
        return None
    for one, slope in zip(q, gradient, strict=True):
        rest = slope - V.diff(one)
        if _is_zero(rest):
            continue
        part = _of_power(rest, one)
        if part is None:
            rest = sp.expand(rest)
            if sp.count_ops(rest) > MAX_OPERATIONS:
                return None
            part = _integral(rest, one)
        V += part
    rows = zip(q, gradient, strict=True)
    exact = not V.has(sp.Integral) and all(_is_zero(V.diff(one) - slope) for one, slope in rows)
    return V if exact else None


def _is_zero(expression: sp.Expr) -> bool:
    """Whether an expression vanishes, as far as that is decided."""
    with suppress(NotImplementedError, ZeroDivisionError):
        return vanishes(expression)
    return bool(sp.expand(expression) == 0)


def _of_power(integrand: sp.Expr, one: sp.Symbol) -> sp.Expr | None:
    """The integral of a power times the derivative of its base, as of gravity; None of others."""
    for power in integrand.atoms(sp.Pow):
        base, exponent = power.args
        if base.has(one) and not exponent.has(one):
            factor = sp.cancel(integrand / (base.diff(one) * power))
            if not factor.has(one):
                is_inverse = exponent == -1
                raised = sp.log(base) if is_inverse else base ** (exponent + 1) / (exponent + 1)
                return factor * raised
    return None


@lru_cache(maxsize=1000)  # several equations of a document have the same force
def _integral(integrand: sp.Expr, one: sp.Symbol) -> sp.Expr:
    """The integral by a symbol, which contains `Integral` where it is not found."""
    # positive constants, of which none is a case of its own as 0 in sin(a*x)
    positive = {s: sp.Dummy(s.name, positive=True) for s in integrand.free_symbols - {one}}
    constants = {dummy: s for s, dummy in positive.items()}
    return manualintegrate(integrand.xreplace(positive), one).xreplace(constants)
