"""The values that a formula should have, where several are correct."""

from collections.abc import Iterator
from dataclasses import dataclass

import sympy as sp
from sympy.simplify.fu import TR5, TR6

from derive.formulas.budget import is_expandable
from derive.system.symbols import TIME
from derive.verification.judging.derived import QUANTITIES, foreign_symbols
from derive.verification.judging.reference_system import ReferenceSystem, depends_on, variables

#: Quantities with an arbitrary constant.
UP_TO_A_CONSTANT = ("potential_energy", "energy", "hamiltonian", "lagrangian")


@dataclass(frozen=True)
class Goal:
    """The quantity of a formula: its values, and the symbols that it cannot contain."""

    value: sp.Expr
    along_motions: bool  # accelerations are those of the motion
    foreign: frozenset[sp.Symbol]
    is_equation: bool = False  # then the value is 0 along motions only


def goals(model: ReferenceSystem, kind: str, name: str, value: sp.Expr) -> Iterator[Goal]:
    """Yield the derived values, and those with the constant or the factor of the formula."""
    system = model.derivation.system
    if kind == "euler_lagrange":
        yield Goal(sp.S.Zero, True, frozenset(system.p), is_equation=True)
        return
    foreign = foreign_symbols(model, kind, name)
    derived = QUANTITIES[kind](model, name)
    if kind == "value":
        state = {*system.qdot, *system.qddot, *system.p}
        foreign = frozenset(state - derived.free_symbols)
    yield Goal(derived, kind == "accelerations", foreign)
    if not is_expandable(value):
        return
    if kind in UP_TO_A_CONSTANT:
        pairs = zip(_constants(value, model), _constants(derived, model), strict=True)
        # of a Lagrangian, a constant is rather a wrong term than one that is meant
        shifts = [own - other for own, other in pairs if not (kind == "lagrangian" and own)]
        for shift in dict.fromkeys(filter(None, shifts)):
            yield Goal(derived + shift, False, foreign)
    if kind == "lagrangian":
        factor = sp.cancel(value.diff(system.qdot[0], 2) / model.derivation.mass_matrix[0, 0])
        # a wrong number is more likely than a factor of all terms
        if not factor.is_Rational and not depends_on(factor, (*system.q, *system.qdot, TIME)):
            yield Goal(factor * derived, False, foreign)


def _constants(value: sp.Expr, model: ReferenceSystem) -> Iterator[sp.Expr]:
    """The sums of the terms that depend on parameters alone.

    They are those of the value as it stands, and with squares of cosines alone or of sines alone.
    """
    state = variables(model.derivation.system)
    halves = {wave: wave.args[0] / 2 for wave in value.atoms(sp.cos)}
    squares = {
        wave: 2 * sp.cos(half) ** 2 - 1
        for wave, half in halves.items()
        if half.as_coeff_Mul()[0] == 1
    }
    simple = value.xreplace(squares)  # without cos(2*q)
    for form in (value, TR5(simple), TR6(simple)):
        terms = sp.Add.make_args(sp.expand(form)) if is_expandable(form) else ()
        yield sp.Add(*(term for term in terms if not depends_on(term, state)))
