"""Ralston's method: order 2, 2 stages, of all such rules the one with the least error bound.

A. Ralston, Runge-Kutta methods with minimum error bounds, Mathematics of Computation 16 (1962)
431-437.
"""

from solvers.runge_kutta.tableau import Tableau

tableau = Tableau.explicit("Ralston", rows="2/3", b="1/4 3/4")
