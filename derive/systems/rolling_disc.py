r"""A thin disc or hoop that rolls on a horizontal plane without slipping.

      / \ R      psi: heading; phi: lean; chi: turn about the axle
     ( o )       k = 1/4 of a uniform disc, 1/2 of a hoop
    __\_/__      K. T. McDonald, arXiv:physics/0008227
"""
from sympy import symbols

from derive import Coordinate, Parameter, RigidBody, System, Wheel, rolling_on_plane, rotations

x, y, psi, phi, chi = q = symbols("x y psi phi chi", real=True)
g, (m, R, k) = symbols("g", real=True), symbols("m R k", positive=True)
down, disc = rotations("zx", (psi, phi)).turned((0, 0, -R)), rotations("zxy", (psi, phi, chi))
centre, across = (x - down[0], y - down[1], -down[2]), k * m * R**2
system = System(
    name="rolling_disc", title="Disc that rolls on a plane without slipping, in space",
    coordinates=[Coordinate(x, "m", "point of contact"), Coordinate(y, "m", "the same, across"),
                 Coordinate(psi, "rad", "heading"), Coordinate(phi, "rad", "lean to the right"),
                 Coordinate(chi, "rad", "turn about the axle")],
    parameters=[Parameter(m, "kg", 1.0, "mass"), Parameter(R, "m", 0.3, "radius"),
                Parameter(k, "1", 0.25, "moment of inertia about a diameter / (m R**2)"),
                Parameter(g, "m/s^2", 9.81, "gravitational acceleration")],
    masses=[RigidBody(m, centre, (across, 2 * across, across), disc)],
    constraints=rolling_on_plane("ground", q, centre, R, disc, "y"),
    links=[Wheel(0, R, plane=(disc.turned((1, 0, 0)), disc.turned((0, 0, 1))))])

PUBLISHED = r'''
source = "K. T. McDonald, The Rolling Motion of a Disk on a Horizontal Plane, arXiv:physics/0008227"
note = "Written with the lean from the vertical; n is the angular velocity about the axle."
euler_lagrange = ["(2*k + 1)*n_dot + phi_dot*psi_dot*cos(phi) = 0",
 "psi_ddot*cos(phi) - 2*psi_dot*phi_dot*sin(phi) + 2*n*phi_dot = 0",
 """(k + 1)*phi_ddot + k*psi_dot**2*sin(phi)*cos(phi) - (2*k + 1)*psi_dot*n*cos(phi)
 - g*sin(phi)/R = 0"""]

[names]
n = "chi_dot + psi_dot*sin(phi)"
'''
