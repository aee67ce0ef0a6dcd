"""
Foucault's pendulum
===================

Seen from the Earth, the plane of the swing turns. Here the Earth rotates once in ten minutes.
"""

from math import pi

import generated.foucault_pendulum as pendulum
from solvers import integrate, panels

params = {"Omega": 2 * pi / 600, "latitude": pi / 4}
motion = integrate(pendulum, (0, 200), {"x": 0.5, "y": 0.0}, params, rtol=1e-10)

picture, (panel,) = panels("Path of the bob, from above", size=(6, 6))
panel.plot(motion.y[0], motion.y[1], linewidth=0.5)
panel.set(xlabel="x / m", ylabel="y / m", aspect="equal")
