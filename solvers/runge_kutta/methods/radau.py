"""Radau IIA with variable order: orders 13 and 7, 7 stages; or orders 9 and 5 or 5 and 3.

E. Hairer, G. Wanner, Stiff differential equations solved by Radau methods, Journal of Computational
and Applied Mathematics 111 (1999) 93-111, with nodes in decimals. Known as RADAU. Controlled steps
are those of radau7, radau5 or radau3; fixed steps are those of radau7.
"""

from dataclasses import replace

from solvers.runge_kutta.methods import radau3, radau5, radau7

lower = radau5.tableau, radau3.tableau
tableau = replace(radau7.tableau, title="Radau IIA, variable order", lower=lower)
