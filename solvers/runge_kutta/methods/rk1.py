"""Euler's method: order 1, 1 stage, the report's RK1. Also known as forward Euler.

L. Euler, Institutionum calculi integralis I (1768), section 650.
"""

from solvers.runge_kutta.tableau import Tableau

tableau = Tableau.explicit("Euler", rows="", b="1")
