"""
Nutations of a heavy top
========================

The end of the axis of a fast top, on a sphere, seen from above. As the axis precesses, it nods
between two circles: in waves if it starts with a small rate of precession, with cusps if it starts
from rest, with loops if it is pushed backwards. The dot is the start.
"""

import numpy as np

import generated.heavy_top as top
from solvers import integrate, panels
from solvers.io.figures import COLOURS

t, height = np.linspace(0, 4.6, 3001), np.radians(62)


def seen(phi, theta):
    """Points of the unit sphere, right and up; those with theta < height are in front of it."""
    x, y, z = np.sin(theta) * np.sin(phi), -np.sin(theta) * np.cos(phi), np.cos(theta)
    return x, z * np.cos(height) + y * np.sin(height)


picture, rows = panels("Path of the axis of a heavy top, one turn", columns=3, size=(12, 4.6))
turn = np.linspace(0, 2 * np.pi, 401)
for panel, rate, kind in zip(rows, (0.7, 0.0, -2.0), ("waves", "cusps", "loops"), strict=True):
    start = {"phi": 0.0, "psi": 0.0, "theta": 0.7, "phi_dot": rate, "psi_dot": 180.0}
    motion = integrate(top, (0, t[-1]), start, {}, rtol=1e-10, t_eval=t)
    once = motion.y[0] < 2 * np.pi
    phi, theta = motion.y[0, once], motion.y[2, once]
    panel.fill(np.cos(turn), np.sin(turn), color="0.94")
    for circle in (theta.min(), theta.max()):
        panel.plot(*seen(turn, circle), "0.6", linewidth=0.8)
    panel.plot(*seen(phi, theta), COLOURS[0])
    panel.plot(*seen(phi[0], theta[0]), "o", color=COLOURS[1])
    panel.set(title=f"{kind}: precession starts with {rate:g} rad/s", aspect="equal")
    panel.axis("off")
