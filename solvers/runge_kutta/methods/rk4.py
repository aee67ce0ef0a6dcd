"""The classical Runge-Kutta method: order 4, 4 stages, the report's equations (20) to (25).

W. Kutta, Zeitschrift fuer Mathematik und Physik 46 (1901) 435-453. Known as RK4.
"""

from solvers.runge_kutta.tableau import Tableau

tableau = Tableau.explicit("Classical fourth order", rows="1/2; 0 1/2; 0 0 1", b="1/6 1/3 1/3 1/6")
