"""Heun's method, the explicit trapezoidal rule: order 2, 2 stages.

K. Heun, Zeitschrift fuer Mathematik und Physik 45 (1900) 23-38. Also known as the improved Euler
method. Some authors give Heun's name to a rule of order 3.
"""

from solvers.runge_kutta.tableau import Tableau

tableau = Tableau.explicit("Heun", rows="1", b="1/2 1/2")
