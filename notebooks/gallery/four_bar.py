"""
Coupler curves of a four-bar linkage
====================================

The crank turns, the rocker swings, and each point that moves with the coupler draws a closed curve.
Along the coupler the curves change from the circle of the crank to the arc of the rocker; away from
it they are teardrops and figures of eight.
"""

import numpy as np

import generated.four_bar as linkage
from solvers import consistent_start, integrate, panels
from solvers.io.figures import COLOURS

guess = {"psi": 0.5, "chi": 1.5}
start = consistent_start(linkage, {"phi": 1.0, "phi_dot": 8.0}, {}, guess=guess).y
motion = integrate(linkage, (0, 1), start, {}, rtol=1e-10, t_eval=np.linspace(0, 1, 1001))
a, b, c, d, *_ = linkage.DEFAULTS
crank, coupler, rocker = np.exp(1j * motion.y[:3])  # points are x + i y
joints = np.array([0, a * crank[0], d + c * rocker[0], d])

titles = "Points of the coupler", "Points beside it"
families = np.linspace(0, 1, 5), 0.75 + 1j * np.array([-0.8, -0.5, -0.25, 0.25, 0.6])
picture, rows = panels("Coupler curves of a four-bar linkage", columns=2, size=(12, 5))
for panel, title, points in zip(rows, titles, families, strict=True):
    panel.plot(joints.real, joints.imag, "o-", color="0.6", linewidth=4)
    for point, colour in zip(points, COLOURS, strict=False):
        curve = a * crank + point * b * coupler
        panel.plot(curve.real, curve.imag, color=colour)
        panel.plot(curve[0].real, curve[0].imag, "o", color=colour)
    panel.set(title=title, xlabel="x / m", ylabel="y / m", aspect="equal")
