r"""K. Furuta's pendulum, on the end of an arm that a motor turns about the vertical.

    | tau          B. S. Cazzolato, Z. Prime, J. Control Sci. Eng. (2011) 528341
    +-- L --+
  alpha      \ l
              o m, theta across the arm
"""
from sympy import symbols

from derive import Coordinate, Input, Parameter, RigidBody, Rod, System, rotations

alpha, theta, tau, g = symbols("alpha theta tau g", real=True)
m, L, l, I, J = symbols("m L l I J", positive=True)
arm, axes = rotations("z", [alpha]), rotations("zx", (alpha, theta))
system = System(
    name="furuta_pendulum", title="Furuta's pendulum: a rod on the end of a driven arm",
    coordinates=[Coordinate(alpha, "rad", "angle of the arm"),
                 Coordinate(theta, "rad", "angle of the rod from the downward vertical")],
    parameters=[Parameter(m, "kg", 0.1, "rod's mass"), Parameter(L, "m", 0.3, "arm's length"),
                Parameter(l, "m", 0.2, "rod's centre"), Parameter(g, "m/s^2", 9.81, "gravity"),
                Parameter(I, "kg m^2", 4e-3, "arm"), Parameter(J, "kg m^2", 1e-3, "the rod's")],
    inputs=[Input(tau, "N m", "torque of the motor")], forces=[tau, 0], gravity=(0, 0, -g),
    masses=[RigidBody(1, (0, 0, 0), (0, I, I), arm),
            RigidBody(m, axes.turned((L, 0, -l)), (J, J, 0), axes)],
    links=[Rod((0, 0, 0), arm.turned((L, 0, 0))), Rod(arm.turned((L, 0, 0)), 1)])

PUBLISHED = r'''
source = "B. S. Cazzolato, Z. Prime, J. Control Sci. Eng. (2011) 528341"
note = "The source has friction, too."
euler_lagrange = ["""alpha_ddot*(I + m*L**2 + (J + m*l**2)*sin(theta)**2)
 + theta_ddot*m*L*l*cos(theta)
 - m*L*l*sin(theta)*theta_dot**2 + alpha_dot*theta_dot*sin(2*theta)*(J + m*l**2) = tau""",
"""alpha_ddot*m*L*l*cos(theta) + theta_ddot*(J + m*l**2)
 - alpha_dot**2*sin(2*theta)*(J + m*l**2)/2 + g*m*l*sin(theta) = 0"""]
'''
