"""Kutta's method: order 3, 3 stages.

W. Kutta, Beitrag zur naeherungsweisen Integration totaler Differentialgleichungen, Zeitschrift
fuer Mathematik und Physik 46 (1901) 435-453.
"""

from solvers.runge_kutta.tableau import Tableau

tableau = Tableau.explicit("Kutta's third order", rows="1/2; -1 2", b="1/6 2/3 1/6")
