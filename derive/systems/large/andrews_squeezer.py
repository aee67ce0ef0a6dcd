r"""Andrews' squeezer: seven bodies in the plane, driven by a torque, pulled by a spring.

    C~~~D---B        1 turns about O, 3 about B, 5 and 7 about A; ends of 2, 3, 4, 6 meet in +
         \3/
    O-1-2-+-4-5-A    E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, VII.7
          +-6-7-A
"""
from sympy import I, Rational, exp, sqrt, symbols

from derive import Coordinate, Parameter, Plate, RigidBody, Rod, Spring, System

*q, c0, l0, torque = symbols("beta Theta Gamma Phi delta Omega epsilon c0 l0 torque", real=True)
turns = (q[0], q[0] + q[1], q[2], q[3] + q[4], q[4], q[5] + q[6], q[6])
A, B, C, e1, e2, e3, e4, e5, e6, e7 = (z / 10**5 for z in (-6934 - 227 * I, -3635 + 3273 * I,
    1400 + 7200 * I, *(exp(I * angle) for angle in turns)))  # points are x + I y
K1, K5, K7 = 700 * e1, A + 4000 * e5, A - 4000 * I * e7
a, b, c, d, k1, k5, k7, *p = (z.as_real_imag() for z in (A, B, C, B + (2000 - 1800 * I) * e3,
    K1, K5, K7, K1 - 2800 * e2, B - 3500 * I * e3, K5 - 2000 * I * e4, K7 + 2000 * e6))
bodies = [RigidBody(Rational(m, 10**6), z.as_real_imag(), Rational(i, 10**10), angle)
    for m, i, angle, z in zip((43250, 3650, 23730, 7060, 70500, 7060, 54980),
    (21940, 4410, 52550, 5667, 116900, 5667, 191200), turns, (92 * e1, K1 - 1150 * e2, B + (1043 -
    1874 * I) * e3, K5 - 579 * I * e4, A + (2308 + 916 * I) * e5, K7 + 579 * e6, A - (449 + 1228 *
    I) * e7))]  # masses in mg, moments of inertia in 1e-10 kg m^2
system = System("andrews_squeezer", "Andrews' squeezer: seven bodies and a spring",
    [Coordinate(s, "rad", f"angle {k} of 7") for k, s in enumerate(q, 1)],
    [Parameter(c0, "N/m", 4530.0, "stiffness"), Parameter(l0, "m", 0.07785, "free length"),
     Parameter(torque, "N m", 0.033, "of the drive")], bodies,
    c0 * (sqrt((d[0] - c[0])**2 + (d[1] - c[1])**2) - l0)**2 / 2, forces=[torque, *[0] * 6],
    coincide=[(p[0], end) for end in p[1:]], links=[Spring(c, d), Rod((0, 0), k1), Rod(k1, p[0]),
    Plate(b, d, p[1]), Rod(k5, p[2]), Plate(a, k5, 4), Plate(a, k7, 6), Rod(k7, p[3])])

PUBLISHED = r'''
source = "E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, VII.7"
note = "The mass matrix of the source, as a kinetic energy; it uses the sums m4 to m7 of 4 to 7."
kinetic_energy = """(m1*ra**2 + m2*(rr**2 - 2*da*rr*cos(Theta) + da**2) + i1 + i2)*beta_dot**2/2 \
+ (m2*(da**2 - da*rr*cos(Theta)) + i2)*beta_dot*Theta_dot + (m2*da**2 + i2)*Theta_dot**2/2 \
+ (m3*(sa**2 + sb**2) + i3)*Gamma_dot**2/2 + (m4*(e - ea)**2 + i4)*Phi_dot**2/2 \
+ (m4*((e - ea)**2 + zt*(e - ea)*sin(Phi)) + i4)*Phi_dot*delta_dot \
+ (m4*(zt**2 + 2*zt*(e - ea)*sin(Phi) + (e - ea)**2) + m5*(ta**2 + tb**2) + i4 + i5)\
*delta_dot**2/2 \
+ (m6*(zf - fa)**2 + i6)*Omega_dot**2/2 \
+ (m6*((zf - fa)**2 - u*(zf - fa)*sin(Omega)) + i6)*Omega_dot*epsilon_dot \
+ (m6*((zf - fa)**2 - 2*u*(zf - fa)*sin(Omega) + u**2) + m7*(ua**2 + ub**2) + i6 + i7)\
*epsilon_dot**2/2"""

[names]
m1 = "0.04325"
m2 = "0.00365"
m3 = "0.02373"
m4 = "0.00706"
m5 = "0.07050"
m6 = "0.00706"
m7 = "0.05498"
i1 = "2.194e-6"
i2 = "4.410e-7"
i3 = "5.255e-6"
i4 = "5.667e-7"
i5 = "1.169e-5"
i6 = "5.667e-7"
i7 = "1.912e-5"
ra = "0.00092"
rr = "0.007"
da = "0.0115"
sa = "0.01874"
sb = "0.01043"
e = "0.02"
ea = "0.01421"
zt = "0.04"
ta = "0.02308"
tb = "0.00916"
zf = "0.02"
fa = "0.01421"
u = "0.04"
ua = "0.01228"
ub = "0.00449"
'''
