"""Radau IIA: orders 13 and 7, 7 stages, stiffly accurate, L-stable.

E. Hairer, G. Wanner, Stiff differential equations solved by Radau methods, Journal of Computational
and Applied Mathematics 111 (1999) 93-111, with nodes in decimals. One of the methods of RADAU.
"""

from solvers.runge_kutta.collocation import collocation, radau_nodes
from solvers.runge_kutta.tableau import Tableau

tableau = Tableau("Radau IIA, 7 stages", *collocation(radau_nodes(7)))
