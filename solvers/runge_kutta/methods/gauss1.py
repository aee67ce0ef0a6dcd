"""The implicit midpoint rule, Gauss-Legendre with one stage: order 2, symplectic, A-stable.

E. Hairer, Ch. Lubich, G. Wanner, Geometric Numerical Integration, section II.1.3.
"""

from fractions import Fraction

from solvers.runge_kutta.tableau import Tableau

tableau = Tableau("Implicit midpoint", A=((Fraction(1, 2),),), b=(Fraction(1),))
