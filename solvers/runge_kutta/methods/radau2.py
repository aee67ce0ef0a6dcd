"""Radau IIA: order 3, 2 stages, stiffly accurate, L-stable.

E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, table IV.5.5.
"""

from fractions import Fraction

from solvers.runge_kutta.tableau import Tableau

twelfth = Fraction(1, 12)

tableau = Tableau(
    "Radau IIA, 2 stages",
    A=((5 * twelfth, -twelfth), (9 * twelfth, 3 * twelfth)),
    b=(9 * twelfth, 3 * twelfth),
)
