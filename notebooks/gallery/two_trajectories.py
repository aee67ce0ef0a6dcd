"""
Two starts, 1e-9 rad apart
==========================

Their distance grows exponentially until it is as large as the motion itself.
"""

import numpy as np

import generated.double_pendulum as dp
from solvers import ensemble, panels

t = np.linspace(0, 32, 641)
starts = np.array([[1.57, 1.57 + 1e-9], [3.14, 3.14], [0, 0], [0, 0]])
options = {"method": "verner98", "rtol": 1e-13, "atol": 1e-13, "t_eval": t}
motions = ensemble(dp, (0, 32), starts, dp.DEFAULTS, **options)
distance = np.linalg.norm(motions.samples[:, 0] - motions.samples[:, 1], axis=0)

picture, (angle, growth) = panels("Two double pendulums", columns=2, size=(12, 4))
angle.plot(t, motions.samples[1].T)
angle.set(xlabel="t / s", ylabel=r"$\theta_2$ / rad")
growth.semilogy(t, distance)
growth.set(xlabel="t / s", ylabel="distance / rad, rad/s")
