"""Solutions of equations that are not linear in the accelerations."""

from itertools import islice
from typing import TYPE_CHECKING

import sympy as sp

from derive.formulas.generic_values import changes_of_sign
from derive.formulas.numeric import mp
from derive.verification.judging.engine import State
from derive.verification.judging.reference_system import ReferenceSystem, depends_on

if TYPE_CHECKING:
    from collections.abc import Iterator

#: States at which solutions are computed, and the largest relative value that counts as zero.
STATES, TINY = 3, 1e-15


#: Odd functions that have every value once, and others that vanish at zero alone or have every
#: value once.
ODD = (sp.sinh, sp.tanh, sp.atan)
VANISHING, INJECTIVE = (sp.Abs, *ODD), (sp.exp, sp.log, *ODD)


def without_outer_function(model: ReferenceSystem, value: sp.Expr) -> sp.Expr | None:
    """The number g of a function f(g) that vanishes where g does, and only there, or None.

    Such are powers, absolute values, products of multiples, ``exp(g) - 1`` and ``log(1 + g)``.
    """
    accelerations = model.derivation.system.qddot
    inner = _inside(model, value)
    if inner is None or not depends_on(inner, accelerations):
        return None
    further = without_outer_function(model, inner)
    return inner if further is None else further


def _inside(model: ReferenceSystem, value: sp.Expr) -> sp.Expr | None:
    accelerations = model.derivation.system.qddot
    if value.is_Pow and value.exp.is_Rational and value.exp > 0:
        return value.base
    if isinstance(value, VANISHING):
        return value.args[0]
    if isinstance(value, sp.log):
        return value.args[0] - 1
    if value.is_Mul:
        rest, dependent = value.as_independent(*accelerations, as_Add=False)
        first, *others = sp.Mul.make_args(dependent)
        bases = [one.base if one.is_Pow and one.exp > 0 else one for one in (first, *others)]
        if all(model.context.are_multiples(bases[0], one, accelerations) for one in bases[1:]):
            inner = bases[0] if others else _inside(model, first)
            return None if inner is None else rest * inner
    if value.is_Add and len(value.args) == 2:
        (a, f), (b, g) = (term.as_coeff_Mul() for term in value.args)
        if isinstance(f, INJECTIVE) and f.func == g.func and a == -b:
            return f.args[0] - g.args[0]
        if isinstance(f, ODD) and f.func == g.func and a == b:
            return f.args[0] + g.args[0]
        (a, f), (b, g) = sorted(((a, f), (b, g)), key=lambda pair: pair[1].is_number)
        if isinstance(f, sp.exp) and g.is_number and (ratio := -b * g / a).is_positive:
            return f.args[0] - sp.log(ratio)
    return None


def has_other_solutions(model: ReferenceSystem, value: sp.Expr) -> bool | None:
    """Whether an equation has real solutions other than the motion, and vanishing accelerations.

    At a state, the equation is restricted to a line through the accelerations of the motion. Where
    it is a product with a power of an acceleration, its other solutions are zeros of this one. None
    if the equation is no polynomial on the line, and no other solution is known.
    """
    places = islice(model.motions.states, STATES)
    result = [_on_line(model, value, state) for state in places]
    return True if any(result) else None if None in result else False


def _on_line(model: ReferenceSystem, value: sp.Expr, state: State) -> bool | None:
    accelerations, s = model.derivation.system.qddot, sp.Dummy("s", real=True)
    line = {a: state[a] + s * (1 + sp.Rational(k, 7)) for k, a in enumerate(accelerations)}
    restricted = value.xreplace({**state, **line})
    roots: Iterator[sp.Expr]
    try:
        polynomial = sp.Poly(sp.numer(sp.together(restricted)), s)
        roots, unknown = iter(polynomial.nroots(n=30, maxsteps=500)), False
    except (sp.PolynomialError, mp.NoConvergence):
        roots, unknown = changes_of_sign(restricted, s), None
    others = (sp.re(root) for root in roots if abs(sp.im(root)) < TINY and abs(root) > TINY)
    lines = ([a.xreplace({s: root}) for a in line.values()] for root in others)
    return True if any(all(abs(a) > TINY for a in one) for one in lines) else unknown
