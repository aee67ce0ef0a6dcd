"""The explicit midpoint rule: order 2, 2 stages.

C. Runge, Ueber die numerische Aufloesung von Differentialgleichungen, Mathematische Annalen 46
(1895) 167-178. Also known as the modified Euler method.
"""

from solvers.runge_kutta.tableau import Tableau

tableau = Tableau.explicit("Explicit midpoint", rows="1/2", b="0 1")
