"""Euler's method, the first-order rule: the report's RK1.

L. Euler, Institutionum calculi integralis I (1768), section 650.
"""

from solvers.runge_kutta.tableau import Tableau

tableau = Tableau.explicit(
    "Euler",
    rows="",
    b="1",
)
