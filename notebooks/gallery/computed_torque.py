"""
Computed torque
===============

The hand of a robot's arm follows a curve. Inverse dynamics state the torques that its motors need
for that, so that errors decay as those of a damped spring. Feedback alone lags behind, and a load
of 0.3 kg in the hand, of which the model knows nothing, takes the hand off the curve, too.
"""

import numpy as np

import generated.two_link_arm as arm
from solvers import Held, integrate, panels
from solvers.io.figures import COLOURS

middle, width, speed = np.array([0.6, 1.2]), np.array([0.5, 0.6]), np.array([2.0, 4.0])
loaded = {"m2": 1.3, "c2": 0.1846, "I2": 0.0152}  # with 0.3 kg in the hand


def path(t):
    """Angles, velocities and accelerations of the joints."""
    wave, slope = width * np.sin(speed * t), width * speed * np.cos(speed * t)
    return middle + wave, slope, -(speed**2) * wave


def correction(t, y):
    """The acceleration by which the arm returns to its path."""
    q, qdot, _ = path(t)
    return 400 * (q - y[:2]) + 40 * (qdot - y[2:])


def feedback(t, y):
    """Torques without a model but the inertia of each link about its joint."""
    return correction(t, y) * [0.35, 0.04]


def computed_torque(t, y):
    """Torques of the acceleration of the path, and of that which returns to it."""
    return arm.inverse_dynamics(t, y, path(t)[2] + correction(t, y), arm.DEFAULTS)


cases = {
    "feedback alone": (feedback, {}),
    "computed torque, with a load": (computed_torque, loaded),
    "computed torque": (computed_torque, {}),
}
times = np.linspace(0, 4, 801)
wanted = np.array([np.concatenate(path(t)[:2]) for t in times]).T
start = wanted[:, 0] + (0.2, 0, 0, 0)
errors = {}
picture, (curves, distances) = panels("A robot's arm on a curve", columns=2, size=(12, 5))
for (name, (controller, params)), colour in zip(cases.items(), COLOURS, strict=False):
    torques = Held(0.002, controller)
    motion = integrate(arm, (0, 4), start, params, inputs=torques, t_eval=times)
    hand = arm.outputs_many(times, motion.y, arm.DEFAULTS)
    errors[name] = np.hypot(*(hand - arm.outputs_many(times, wanted, arm.DEFAULTS)))
    curves.plot(*hand, color=colour, label=name)
    distances.semilogy(times, 1000 * errors[name], color=colour)
curves.plot(*arm.outputs_many(times, wanted, arm.DEFAULTS), "k:", label="curve")
curves.set(xlabel="x / m", ylabel="y / m", aspect="equal", title="Path of the hand")
curves.legend(frameon=False, fontsize="small")
distances.set(xlabel="t / s", ylabel="distance from the curve / mm", title="Error")
