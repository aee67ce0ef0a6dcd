"""Leapfrog: order 2, 2 stages; the last is the next step's first, symplectic.

E. Hairer, Ch. Lubich, G. Wanner, Acta Numerica 12 (2003) 399-450. Known as the Störmer-Verlet
method, velocity Verlet, and Strang splitting. For forces of positions only.
"""

from solvers.runge_kutta.tableau import Splitting

tableau = Splitting.symmetric("Leapfrog", kicks="1/2", drifts="1")
