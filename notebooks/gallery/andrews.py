"""
Andrews' squeezer
=================

Seven bodies with one degree of freedom: a torque turns the crank, blue, and all others follow. Four
bodies meet in the black point; the dashed line is a spring. At the start crank and coupler are
aligned.
"""

import numpy as np

from solvers import consistent_start, integrate, load, panels
from solvers.io.figures import COLOURS

squeezer, t = load("andrews_squeezer"), np.linspace(0, 0.03, 601)
guess = dict(zip(squeezer.COORDINATES, (0, 0, 0.46, 0.22, 0.49, -0.22, 1.23), strict=True))
start = consistent_start(squeezer, {"Theta": 0.0}, {}, guess=guess).y
motion = integrate(squeezer, (0, 0.03), start, {}, rtol=1e-10, t_eval=t)
points = 100 * squeezer.points_many(t, motion.y, squeezer.DEFAULTS)  # in cm

picture, rows = panels("Andrews' squeezer", rows=2, columns=3, size=(12, 7.5))
for panel, k in zip(rows, (0, 160, 220, 280), strict=False):
    for (kind, ends), colour in zip(squeezer.LINKS, ("0.5", *COLOURS), strict=True):
        x, y = points[[*ends], :, k].T
        if kind == "plate":
            panel.fill(x, y, color=colour, alpha=0.5)
        else:
            panel.plot(x, y, "--" if kind == "spring" else "-", color=colour, linewidth=2)
    panel.plot(*points[4, :, k], "ko")
    panel.set(xlim=(-8, 2), ylim=(-3, 8), xlabel="x / cm", ylabel="y / cm", aspect="equal")
    panel.set_title(f"{1000 * t[k]:g} ms")
crank, others = rows[4:]
crank.plot(1000 * t, motion.y[0])
crank.set(xlabel="t / ms", ylabel=r"crank, $\beta$ / rad")
for name, angle in zip(squeezer.COORDINATES[2:], motion.y[2:7], strict=True):
    others.plot(1000 * t, angle, label=rf"$\{name}$")
others.set(xlabel="t / ms", ylabel="other angles / rad", ylim=(-0.6, 1.9))
others.legend(frameon=False, ncols=3, loc="upper left")
