"""Dormand and Prince's pair of orders 5 and 4, 7 stages; the last is the next step's first.

J. R. Dormand, P. J. Prince, A family of embedded Runge-Kutta formulae, Journal of Computational
and Applied Mathematics 6 (1980) 19-26. Known as DOPRI5, RK45 and ode45.
"""

from solvers.runge_kutta.tableau import Tableau

tableau = Tableau.explicit(
    "Dormand-Prince 5(4)",
    rows="""
        1/5;
        3/40 9/40;
        44/45 -56/15 32/9;
        19372/6561 -25360/2187 64448/6561 -212/729;
        9017/3168 -355/33 46732/5247 49/176 -5103/18656;
        35/384 0 500/1113 125/192 -2187/6784 11/84
    """,
    b_hat="5179/57600 0 7571/16695 393/640 -92097/339200 187/2100 1/40",
)
