"""Kutta's 3/8 rule: order 4, 4 stages.

W. Kutta, Zeitschrift fuer Mathematik und Physik 46 (1901) 435-453.
"""

from solvers.runge_kutta.tableau import Tableau

tableau = Tableau.explicit("Three-eighths rule", rows="1/3; -1/3 1; 1 -1 1", b="1/8 3/8 3/8 1/8")
