"""Gauss-Legendre collocation: order 8, 4 stages, symplectic, A-stable.

E. Hairer, Ch. Lubich, G. Wanner, Geometric Numerical Integration, section II.1.3, with nodes in
decimals. The stages are iterated at once, each in a vector lane, as in P. J. van der Houwen and
B. P. Sommeijer, Journal of Computational and Applied Mathematics 29 (1990) 111-127, and
M. Antoñana, J. Makazaga and A. Murua, arXiv 2511.03655.
"""

from solvers.runge_kutta.collocation import collocation, gauss_nodes
from solvers.runge_kutta.tableau import Tableau

tableau = Tableau("Gauss-Legendre, 4 stages", *collocation(gauss_nodes(4)), iteration="fixed-point")
