r"""Lagrange's top: a symmetric body that spins about a fixed point below its centre of mass.

       |   / ψ      L. D. Landau, E. M. Lifshitz, Mechanics, § 35, problem 1
       |θ o m
       | /          φ about the vertical, ψ about the axis
       |/ l
   ----+----
"""
from sympy import symbols

from derive import Coordinate, Parameter, RigidBody, Rod, System, Wheel, rotations

phi, theta, psi, g = symbols("phi theta psi g", real=True)
m, l, A, C = symbols("m l A C", positive=True)
axes = rotations("zxz", (phi, theta, psi))
system = System(
    name="heavy_top", title="Heavy top: a symmetric body about a fixed point, in space",
    coordinates=[Coordinate(phi, "rad", "precession"), Coordinate(psi, "rad", "spin"),
                 Coordinate(theta, "rad", "angle of the axis from the upward vertical")],
    parameters=[Parameter(m, "kg", 1.0, "mass"), Parameter(l, "m", 0.3, "height of its centre"),
                Parameter(A, "kg m^2", 0.02, "moment of inertia across the axis, at the centre"),
                Parameter(C, "kg m^2", 0.01, "moment of inertia about the axis"),
                Parameter(g, "m/s^2", 9.81, "gravitational acceleration")],
    masses=[RigidBody(m, axes.turned((0, 0, l)), (A, A, C), axes)], links=[
        Rod((0, 0, 0), 0), Wheel(0, l / 3, plane=(axes.turned((1, 0, 0)), axes.turned((0, 1, 0))))])

PUBLISHED = r'''
source = "L. D. Landau, E. M. Lifshitz, Mechanics, § 35, problem 1"
lagrangian = """(A + m*l**2)*(theta_dot**2 + phi_dot**2*sin(theta)**2)/2
 + C*(psi_dot + phi_dot*cos(theta))**2/2 - m*g*l*cos(theta)"""
energy = """C*(psi_dot + phi_dot*cos(theta))**2/2
 + (A + m*l**2)*(theta_dot**2 + phi_dot**2*sin(theta)**2)/2 + m*g*l*cos(theta)"""

[momenta]
psi = "C*(psi_dot + phi_dot*cos(theta))"
phi = "((A + m*l**2)*sin(theta)**2 + C*cos(theta)**2)*phi_dot + C*psi_dot*cos(theta)"
'''
