"""
Kapitza's pendulum
==================

A pendulum whose pivot is shaken fast enough stands upright. Shaken more slowly, it falls.
"""

import generated.driven_pendulum as pendulum
from solvers import integrate, panels

picture, (panel,) = panels("Upright, with the pivot shaken at 100 and at 30 rad/s", size=(9, 4))
for frequency in (100.0, 30.0):
    params = {"Omega": frequency, "c": 0.2}
    motion = integrate(pendulum, (0, 10), {"theta": 2.9}, params, rtol=1e-10)
    panel.plot(motion.t, motion.y[0], label=f"{frequency:g} rad/s")
panel.set(xlabel="t / s", ylabel=r"$\theta$ / rad")
panel.legend(frameon=False, loc="lower right")
