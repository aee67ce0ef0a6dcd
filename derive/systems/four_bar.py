r"""A linkage of four bars: a crank turns, a coupler moves a rocker; the ground is the fourth one.

          b  __.-o B      F. Freudenstein, Approximate Synthesis of Four-Bar Linkages,
    A o--´´ ψ     \       Trans. ASME 77 (1955) 853
   a / φ           \ c χ
    +------- d -----+     angles from the ground
"""
from sympy import cos, sin, symbols

from derive import Coordinate, Parameter, RigidBody, Rod, System, pin

phi, psi, chi, g = symbols("phi psi chi g", real=True)
a, b, c, d, m1, m2, m3 = symbols("a b c d m1 m2 m3", positive=True)
A, D, B = (a * cos(phi), a * sin(phi)), (d, 0), (d + c * cos(chi), c * sin(chi))
end = (A[0] + b * cos(psi), A[1] + b * sin(psi))
bars = (("crank", a, 0.3, m1, phi, ((0, 0), A)), ("coupler", b, 0.8, m2, psi, (A, end)),
        ("rocker", c, 0.6, m3, chi, (D, B)))
system = System("four_bar", "Four-bar linkage: crank, coupler and rocker are uniform bars",
    [Coordinate(q, "rad", f"angle of the {bar} from the ground") for bar, *_, q, _ in bars],
    [*(Parameter(l, "m", size, f"length of the {bar}") for bar, l, size, *_ in bars),
     Parameter(d, "m", 0.9, "length of the ground"), Parameter(g, "m/s^2", 9.81, "gravity"),
     *(Parameter(m, "kg", size, f"mass of the {bar}") for bar, _, size, m, *_ in bars)],
    [RigidBody(m, ((p[0] + r[0]) / 2, (p[1] + r[1]) / 2), m * l**2 / 12, q)
     for _, l, _, m, q, (p, r) in bars],
    constraints=pin("B", end, B), links=[Rod(*ends) for *_, ends in bars])

PUBLISHED = r'''
source = "F. Freudenstein, Trans. ASME 77 (1955) 853; S. Cardona Foix et al., Mech. Sci. 8 (2017)"
note = "Freudenstein's equation; Eksergian's equation, by hand, with J, the inertia at the crank."
euler_lagrange = ["K1*cos(chi) - K2*cos(phi) + K3 = cos(phi - chi)",
 """J*phi_ddot + J_dot*phi_dot/2 + g*a*cos(phi)*(m1/2 + m2)
 + g*a*sin(phi - chi)*cos(psi)/sin(chi - psi)*m2/2
 + g*a*sin(phi - psi)*cos(chi)/sin(chi - psi)*m3/2 = 0"""]

[names]
K1 = "d/a"
K2 = "d/c"
K3 = "(a**2 - b**2 + c**2 + d**2)/(2*a*c)"
J = """(m1/3 + m2)*a**2 + m2*a**2*cos(phi - psi)*sin(phi - chi)/sin(chi - psi)
 + a**2*(m2*sin(phi - chi)**2 + m3*sin(phi - psi)**2)/(3*sin(chi - psi)**2)"""
'''
