"""Solutions of equations that are not linear in the accelerations."""

from itertools import islice

import sympy as sp

from derive.formulas.numeric import mp
from derive.verification.engine import State
from derive.verification.model import Model

#: States at which solutions are computed, and the largest relative value that counts as zero.
STATES, TINY = 3, 1e-15


def has_other_solutions(model: Model, value: sp.Expr) -> bool:
    """Whether an equation has real solutions other than the motion, and vanishing accelerations.

    At a state, the equation is restricted to a line through the accelerations of the motion. Where
    it is a product with a power of an acceleration, its other solutions are zeros of this one.
    """
    return any(_on_line(model, value, state) for state in islice(model.motions.states, STATES))


def _on_line(model: Model, value: sp.Expr, state: State) -> bool:
    accelerations, s = model.derivation.system.qddot, sp.Dummy("s", real=True)
    line = {a: state[a] + s * (1 + sp.Rational(k, 7)) for k, a in enumerate(accelerations)}
    restricted = value.xreplace({**state, **line})
    try:
        polynomial = sp.Poly(sp.numer(sp.together(restricted)), s)
        roots = polynomial.nroots(n=30, maxsteps=500)
    except (sp.PolynomialError, mp.NoConvergence):
        return True
    others = [root for root in roots if abs(sp.im(root)) < TINY and abs(root) > TINY]
    return any(
        all(abs(a.xreplace({s: sp.re(root)})) > TINY for a in line.values()) for root in others
    )
