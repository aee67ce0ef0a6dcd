"""Gauss-Legendre collocation: order 4, 2 stages, symplectic, A-stable.

E. Hairer, Ch. Lubich, G. Wanner, Geometric Numerical Integration, section II.1.3. Known as the
method of Hammer and Hollingsworth.
"""

from fractions import Fraction

from solvers.runge_kutta.surd import Surd
from solvers.runge_kutta.tableau import Tableau

half, quarter, r = Fraction(1, 2), Fraction(1, 4), Surd.root(3) / 6

tableau = Tableau(
    "Gauss-Legendre, 2 stages",
    A=((quarter + 0 * r, quarter - r), (quarter + r, quarter + 0 * r)),
    b=(half + 0 * r, half + 0 * r),
)
