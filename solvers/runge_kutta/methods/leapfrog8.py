"""A composition of leapfrog steps: order 8, 18 stages; the last is the next step's first.

W. Kahan and R.-C. Li, Mathematics of Computation 66 (1997) 1089-1099, s17odr8a, in decimals. For
forces of positions only.
"""

from solvers.runge_kutta.tableau import Splitting

factors = """0.13020248308889008087881763 0.56116298177510838456196441 -0.38947496264484728640807860
    0.15884190655515560089621075 -0.39590389413323757733623154 0.18453964097831570709183254
    0.25837438768632204729397911 0.29501172360931029887096624 -0.60550853383003451169892108"""
tableau = Splitting.composition("Kahan-Li, order 8", factors)
