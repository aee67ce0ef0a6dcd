"""Radau IIA: orders 5 and 3, 3 stages, stiffly accurate, L-stable.

E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, table IV.5.6. Known as RADAU5;
SciPy's Radau is the same method.
"""

from fractions import Fraction

from solvers.runge_kutta.surd import Surd
from solvers.runge_kutta.tableau import Tableau

r = Surd.root(6)
last = ((16 - r) / 36, (16 + r) / 36, Fraction(1, 9) + 0 * r)

tableau = Tableau(
    "Radau IIA, 3 stages",
    A=(
        ((88 - 7 * r) / 360, (296 - 169 * r) / 1800, (-2 + 3 * r) / 225),
        ((296 + 169 * r) / 1800, (88 + 7 * r) / 360, (-2 - 3 * r) / 225),
        last,
    ),
    b=last,
)
