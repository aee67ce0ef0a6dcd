"""Gauss-Legendre collocation: order 6, 3 stages, symplectic, A-stable.

E. Hairer, Ch. Lubich, G. Wanner, Geometric Numerical Integration, section II.1.3. Known as the
method of Kuntzmann and Butcher.
"""

from fractions import Fraction

from solvers.runge_kutta.surd import Surd
from solvers.runge_kutta.tableau import Tableau

outer, inner, r = Fraction(5, 36), Fraction(2, 9), Surd.root(15)

tableau = Tableau(
    "Gauss-Legendre, 3 stages",
    A=(
        (outer + 0 * r, inner - r / 15, outer - r / 30),
        (outer + r / 24, inner + 0 * r, outer - r / 24),
        (outer + r / 30, inner + r / 15, outer + 0 * r),
    ),
    b=(2 * outer + 0 * r, 2 * inner + 0 * r, 2 * outer + 0 * r),
)
