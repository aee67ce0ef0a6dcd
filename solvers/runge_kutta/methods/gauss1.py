"""The implicit midpoint rule: order 2, 1 stage, symplectic, A-stable. Gauss-Legendre's first.

E. Hairer, Ch. Lubich, G. Wanner, Geometric Numerical Integration, section II.1.3.
"""

from fractions import Fraction

from solvers.runge_kutta.tableau import Tableau

tableau = Tableau("Implicit midpoint", A=((Fraction(1, 2),),), b=(Fraction(1),))
