"""Energies that follow from a Hamiltonian that a document states, and potentials of forces."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress

import sympy as sp
from sympy.integrals.manualintegrate import manualintegrate

from derive.formulas.expression import Value, parse
from derive.formulas.syntax import ExpressionError
from derive.system.symbols import acceleration, velocity
from derive.verification.documents.letters.letters import Letters
from derive.verification.documents.statements import DocumentFormula, definitions

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
    for number, formula in enumerate(formulas):
        kinds = {name: letters.quantities.get(name) for name, _ in definitions(formula)}
        texts = [text for name, text in definitions(formula) if kinds[name] == "hamiltonian"]
        for text in texts:
            with suppress(ExpressionError, NotImplementedError, ValueError, TypeError):
                H = parse(text, scope)
                inverse = sp.ImmutableDenseMatrix(sp.hessian(H, columns))
                if inverse.free_symbols & {*columns} or inverse.det() == 0:
                    continue
                if max(map(sp.count_ops, inverse)) > MAX_OPERATIONS:
                    continue
                v = sp.Matrix([rates[q] for p, q in letters.momenta.items() if p in momenta])
                T = (v.T * inverse.inv().applyfunc(sp.cancel) * v)[0, 0] / 2
                V = H.xreplace(dict.fromkeys(columns, sp.S.Zero))
                yield T, V, frozenset({number})


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
    for one, slope in zip(q, gradient, strict=True):
        rest = sp.expand(slope - V.diff(one))
        if rest.free_symbols & rates or sp.count_ops(rest) > MAX_OPERATIONS:
            return None
        # positive constants, of which none is a case of its own as 0 in sin(a*x)
        positive = {s: sp.Dummy(s.name, positive=True) for s in rest.free_symbols - {one}}
        constants = {dummy: s for s, dummy in positive.items()}
        V += manualintegrate(rest.xreplace(positive), one).xreplace(constants)
    exact = not V.has(sp.Integral) and all(
        sp.expand(V.diff(one) - slope) == 0 for one, slope in zip(q, gradient, strict=True)
    )
    return V if exact else None
