"""
A bicycle that balances by itself
=================================

Between 4.3 and 6.0 m/s nobody needs to steer: all real parts of eigenvalues are negative or 0.
At 4.6 m/s a push from the side decays, at 3 m/s the same push ends in a fall.
"""

import numpy as np

from solvers import integrate, linearise, load, panels
from solvers.equations.consistent_start import consistent_start

bicycle = load("bicycle")


def rolling(speed):
    return {"x_dot": speed, "chi_dot": speed / 0.3, "omega_dot": speed / 0.35}


speeds = np.linspace(0, 10, 201)
eigenvalues = [linearise(bicycle, rolling(v), {}).eigenvalues for v in speeds]
size = (9, 4)
picture, (left, right) = panels("Whipple's bicycle, hands off", columns=2, size=size)
left.plot(speeds, np.real(eigenvalues), "C0.", markersize=2)
left.axhline(0, color="grey", linewidth=0.5)
left.set(xlabel="speed / (m/s)", ylabel="real parts of eigenvalues / (1/s)", ylim=(-10, 10))

for speed, end in ((4.6, 6), (3.0, 1.6)):
    pushed = rolling(speed) | {"phi_dot": 0.3, "theta": 0.0}
    start = consistent_start(bicycle, pushed, {}).y
    motion = integrate(bicycle, (0, end), start, {}, t_eval=np.linspace(0, end, 400))
    for name, line in (("phi", "-"), ("delta", "--")):
        label = f"{'lean' if name == 'phi' else 'steer'} at {speed} m/s"
        right.plot(motion.t, np.degrees(motion.y[bicycle.STATE.index(name)]), line, label=label)
right.set(xlabel="t / s", ylabel="angle / degrees", ylim=(-40, 40))
right.legend()
