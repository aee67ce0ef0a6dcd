"""
The report's double pendulum
============================

One motion over five seconds, integrated to an error of 1e-9.
"""

import generated.double_pendulum as dp
from solvers import integrate
from solvers.io.figures import panels

motion = integrate(dp, (0, 5), (1.5, 3.0, 0.0, 0.0), dp.DEFAULTS, rtol=1e-10)
figure, (panel,) = panels("Double pendulum")
panel.plot(motion.t, motion.y[0], motion.t, motion.y[1])
panel.set(xlabel="t / s", ylabel="angle / rad")
