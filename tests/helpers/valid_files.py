"""Valid files of every kind, and names that may stand in them."""

HILL = """
title = "Particle on a hill"
potential = "-m*(pi/3 + 9.81 + 1/7)*x**2/2"

[coordinates]
x = { unit = "m", meaning = "position" }

[parameters]
m = { value = 1, unit = "kg" }

[[masses]]
mass = "m"
position = ["x", "0"]
"""

BEAD = """
title = "Bead on a parabola that is shaken"
potential = "m*g*height"
dissipation = "c*x_dot**2/2"

[coordinates]
x = { unit = "m", meaning = "horizontal place of the bead" }

[parameters]
m = { value = 1, unit = "kg" }
k = { value = "1/2", unit = "1/m" }
c = { value = 0.1, unit = "N s/m" }
a = { value = 0.2, unit = "m", positive = false }
Omega = { value = 3, unit = "rad/s" }
g = { value = 9.81, unit = "m/s^2" }

[definitions]
height = "k*x**2 + a*cos(Omega*t)"

[[masses]]
mass = "m"
position = ["x", "height"]
"""
PENDULUM = ("theta", "theta_dot", "theta_ddot", "p_theta", "m", "l", "g", "phi")
HAND = """
system = "single_pendulum"
source = "a page"
lagrangian = "m*l**2*phi_dot**2/2 + m*g*l*cos(phi)"
hamiltonian = "p_phi**2/(2*m*l**2) - m*g*l*cos(phi)"
euler_lagrange = ["l*phi_ddot + g*sin(phi) = 0"]
momenta = { theta = "m*l**2*phi_dot" }
accelerations = { theta = "-g*sin(phi)/l" }
names = { phi = "theta" }
"""
ANGLES = ("theta1", "theta2", "theta1_dot", "theta2_dot", "m1", "m2", "l1", "l2", "g", "energy")
SCENE = """
system = "double_pendulum"
title = "A scene"
duration = "1 s"
accuracy = 1e-4
samples = 20
outputs = ["theta1", "energy"]
pictures = ["theta1 over t"]
method = "verner98"
parameters = { m2 = "300 g", l1 = 1.5 }
initial = { theta1 = "90 deg", theta2 = "pi - 1", theta2_dot = 0.1 }
beside = [{ method = "rk4", step = "10 ms" }]
"""
SWEEP = """
system = "double_pendulum"
duration = 1
rtol = 1e-6
atol = 1e-9
max_steps = 10000
title = "A sweep"
parameters = { m2 = "500 g" }
initial = { theta2 = 0 }
[axes]
theta1 = { from = "-90 deg", to = 1, count = 3 }
theta1_dot = { from = 0.5, to = 2, count = 3 }
[maps.highest]
kind = "extremes"
of = ["theta2"]
[maps.turn]
kind = "first"
of = { theta1 = ["-180 deg", "180 deg"] }
barrier = [{ theta1 = "180 deg" }]
[maps.cut]
kind = "section"
of = ["theta2"]
count = 2
where = "theta1"
value = 0
direction = "up"
[maps.course]
kind = "samples"
of = ["theta1"]
count = 4
"""
STARTS = "theta1,theta2,theta2_dot\n0.1,0.2,1\n0.5,-1,1.5\n1e0,2,2\n"
