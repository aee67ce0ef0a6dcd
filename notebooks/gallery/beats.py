"""
Beats of coupled pendulums
==========================

One pendulum starts, the other takes over its swing through the weak spring between them, and gives
it back.
"""

import numpy as np

import generated.coupled_pendulums as pendulums
from solvers import integrate, panels

t = np.linspace(0, 60, 1201)
start = {"theta1": 0.1, "theta2": 0.0}
motion = integrate(pendulums, (0, 60), start, {"k": 1.0}, t_eval=t)

picture, rows = panels("Two pendulums and a spring", rows=2, size=(9, 5))
for panel, angle, name in zip(rows, motion.y, (r"$\theta_1$", r"$\theta_2$"), strict=False):
    panel.plot(t, angle)
    panel.set(xlabel="t / s", ylabel=f"{name} / rad")
