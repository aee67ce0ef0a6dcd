"""A textbook's equations of Andrews' squeezer, in Python.

They are index-reduced: constraints are differentiated twice, and a linear system of 13 unknowns is
solved for accelerations and multipliers. E. Hairer, G. Wanner, Solving Ordinary Differential
Equations II, VII.7.
"""

from collections.abc import Sequence
from math import cos, hypot, sin

import numpy as np

from benchmarks.motions import Array

# lengths, masses and moments of inertia in SI units
D, DA, E, EA, RR, RA, SS, SA, SB, SC, SD = (
    *(0.028, 0.0115, 0.02, 0.01421, 0.007, 0.00092),
    *(0.035, 0.01874, 0.01043, 0.018, 0.02),
)
TA, TB, U, UA, UB, ZF, ZT, FA = 0.02308, 0.00916, 0.04, 0.01228, 0.00449, 0.02, 0.04, 0.01421
XA, YA, XB, YB, XC, YC = -0.06934, -0.00227, -0.03635, 0.03273, 0.014, 0.072
M1, M2, M3, M4, M5, M6, M7 = 0.04325, 0.00365, 0.02373, 0.00706, 0.0705, 0.00706, 0.05498
I1, I2, I3, I4, I5, I6, I7 = 2.194e-6, 4.41e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5
C0, L0, TORQUE = 4530.0, 0.07785, 0.033


def textbook(t: float, y: Sequence[float]) -> Array:
    """The derivative of angles and velocities."""
    beta, theta, gamma, phi, delta, omega, epsilon = (float(x) for x in y[:7])
    v = [float(x) for x in y[7:]]
    st, ct, sp, cp, so, co = sin(theta), cos(theta), sin(phi), cos(phi), sin(omega), cos(omega)
    sb, cb, sg, cg = sin(beta), cos(beta), sin(gamma), cos(gamma)
    sbt, cbt, sd, cd = sin(beta + theta), cos(beta + theta), sin(delta), cos(delta)
    spd, cpd, se, ce = sin(phi + delta), cos(phi + delta), sin(epsilon), cos(epsilon)
    soe, coe = sin(omega + epsilon), cos(omega + epsilon)
    bt, pd, oe = v[0] + v[1], v[3] + v[4], v[5] + v[6]

    a = np.zeros((13, 13))
    a[0, 0] = M1 * RA**2 + M2 * (RR**2 - 2 * DA * RR * ct + DA**2) + I1 + I2
    a[0, 1] = a[1, 0] = M2 * (DA**2 - DA * RR * ct) + I2
    a[1, 1] = M2 * DA**2 + I2
    a[2, 2] = M3 * (SA**2 + SB**2) + I3
    a[3, 3] = M4 * (E - EA) ** 2 + I4
    a[3, 4] = a[4, 3] = M4 * ((E - EA) ** 2 + ZT * (E - EA) * sp) + I4
    a[4, 4] = M4 * (ZT**2 + 2 * ZT * (E - EA) * sp + (E - EA) ** 2) + M5 * (TA**2 + TB**2) + I4 + I5
    a[5, 5] = M6 * (ZF - FA) ** 2 + I6
    a[5, 6] = a[6, 5] = M6 * ((ZF - FA) ** 2 - U * (ZF - FA) * so) + I6
    a[6, 6] = M6 * ((ZF - FA) ** 2 - 2 * U * (ZF - FA) * so + U**2) + M7 * (UA**2 + UB**2) + I6 + I7
    rows = (
        *((0, -RR * sb + D * sbt), (1, D * sbt), (2, -SS * cg)),
        *((0, RR * cb - D * cbt), (1, -D * cbt), (2, -SS * sg)),
        *((0, -RR * sb + D * sbt), (1, D * sbt), (3, -E * cpd), (4, -E * cpd + ZT * sd)),
        *((0, RR * cb - D * cbt), (1, -D * cbt), (3, -E * spd), (4, -E * spd - ZT * cd)),
        *((0, -RR * sb + D * sbt), (1, D * sbt), (5, ZF * soe), (6, ZF * soe - U * ce)),
        *((0, RR * cb - D * cbt), (1, -D * cbt), (5, -ZF * coe), (6, -ZF * coe - U * se)),
    )
    row = 6
    for column, value in rows:
        row += column == 0
        a[row, column] = a[column, row] = value

    x, z = SD * cg + SC * sg + XB - XC, SD * sg - SC * cg + YB - YC
    length = hypot(x, z)
    force = -C0 * (length - L0) / length
    sb2, sbt2, pd2, oe2 = v[0] ** 2, bt**2, pd**2, oe**2
    across = RR * cb * sb2 - D * cbt * sbt2  # of the common point, and upwards
    upwards = RR * sb * sb2 - D * sbt * sbt2
    b = [
        TORQUE - M2 * DA * RR * v[1] * (v[1] + 2 * v[0]) * st,
        M2 * DA * RR * v[0] ** 2 * st,
        force * (x * (SC * cg - SD * sg) + z * (SD * cg + SC * sg)),
        M4 * ZT * (E - EA) * v[4] ** 2 * cp,
        -M4 * ZT * (E - EA) * v[3] * (v[3] + 2 * v[4]) * cp,
        -M6 * U * (ZF - FA) * v[6] ** 2 * co,
        M6 * U * (ZF - FA) * v[5] * (v[5] + 2 * v[6]) * co,
        across - SS * sg * v[2] ** 2,
        upwards + SS * cg * v[2] ** 2,
        across - E * spd * pd2 - ZT * cd * v[4] ** 2,
        upwards + E * cpd * pd2 - ZT * sd * v[4] ** 2,
        across - ZF * coe * oe2 - U * se * v[6] ** 2,
        upwards - ZF * soe * oe2 + U * ce * v[6] ** 2,
    ]
    return np.concatenate((v, np.linalg.solve(a, b)[:7]))
