"""Bogacki and Shampine's pair of orders 3 and 2, 4 stages; the last is the next step's first.

P. Bogacki, L. F. Shampine, A 3(2) pair of Runge-Kutta formulas, Applied Mathematics Letters 2
(1989) 321-325. Known as RK23 and ode23.
"""

from solvers.runge_kutta.tableau import Tableau

tableau = Tableau.explicit(
    "Bogacki-Shampine 3(2)", rows="1/2; 0 3/4; 2/9 1/3 4/9", b_hat="7/24 1/4 1/3 1/8"
)
