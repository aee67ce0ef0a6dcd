"""
Speed against accuracy
======================

Seconds and right-hand sides over the error at the end of the report's motion: a point is a run.
"""

import numpy as np

import generated.double_pendulum as dp
from solvers import integrate, panels
from solvers.references.taylor import taylor

start = (np.pi / 2, np.pi, 0.0, 0.0)
truth = taylor(dp, dp.DEFAULTS, start, [0, 5], digits=30)[-1]

picture, (panel,) = panels("Cost of accuracy: the report's motion, 5 s", size=(8, 5))
for method in ("bs32", "dp54", "dop853", "verner98"):
    runs = [
        integrate(dp, (0, 5), start, dp.DEFAULTS, method=method, rtol=10.0**-k, atol=10.0**-k)
        for k in range(3, 13)
    ]
    errors = [np.abs(run.y[:, -1] - truth).max() for run in runs]
    panel.loglog([run.nfev for run in runs], errors, "o-", label=method)
panel.set(xlabel="right-hand sides", ylabel="error at the end / rad, rad/s")
panel.legend(frameon=False)
