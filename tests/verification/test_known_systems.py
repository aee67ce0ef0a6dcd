"""Known systems of programs against equations of motion written by hand, from textbooks."""

import pytest
import sympy as sp

from derive import Derivation
from derive.formulas.expression import FUNCTIONS, parse
from derive.system.symbols import TIME
from derive.verification.documents.letters.known_systems.templates import named

#: For each system, its accelerations in the order of its coordinates.
ACCELERATIONS = {
    "oscillator": ["-k*x/m"],
    "two_oscillators": ["(k2*(x2 - x1) - k1*x1)/m1", "(k2*(x1 - x2) - k3*x2)/m2"],
    "central_force": ["r*theta_dot**2 - G*M/r**2", "-2*r_dot*theta_dot/r"],
    "field_of_a_centre": ["r*theta_dot**2 - k/(m*r**2)", "-2*r_dot*theta_dot/r"],
    "atwood": ["(m1 - m2)*g/(m1 + m2)"],
    "physical_pendulum": ["-m*g*l*sin(theta)/I"],
    "uniform_rod": ["-3*g/(2*l)*sin(theta)"],
    "half_rod": ["-3*g/(4*l)*sin(theta)"],
    "charged_mass_2": ["q*B/m*y_dot", "-q*B/m*x_dot"],
    "bead_on_parabola": ["-(4*k**2*x*x_dot**2 + 2*g*k*x)/(1 + 4*k**2*x**2)"],
    "falling_unit_mass": ["-k/r**2"],
    "scaled_pendulum": ["-omega0**2*sin(theta)"],
    "forced_pendulum_sine": ["-g/l*sin(theta) + A*sin(Omega*t)/(m*l**2)"],
    "accelerated_pendulum_sine": ["-g/l*sin(theta) + A*sin(Omega*t)"],
    "small_accelerated_pendulum_cosine": ["-g/l*theta + A*cos(Omega*t)"],
    "scaled_forced_pendulum_cosine": ["-omega0**2*sin(theta) + A*cos(Omega*t)"],
    "shaken_pendulum_cosine_up": ["-(g - a*Omega**2*cos(Omega*t))/l*sin(theta)"],
    "shaken_pendulum_sine_down": ["-(g + a*Omega**2*sin(Omega*t))/l*sin(theta)"],
    "hanging_mass": ["-k*x/m - g"],
    "torsion_oscillator": ["-k*theta/I"],
    "damped_oscillator": ["-2*zeta*omega0*x_dot - omega0**2*x"],
    "van_der_pol": ["mu*(1 - x**2)*x_dot - x"],
    "driven_oscillator_cosine": ["(A*cos(Omega*t) - k*x)/m"],
    "duffing_sine": ["gamma*sin(Omega*t) - delta*x_dot - alpha*x - beta*x**3"],
    "damped_oscillator_by_rates": ["-2*gamma*x_dot - omega0**2*x"],
    "driven_oscillator_by_rates": ["A*cos(Omega*t)/m - 2*gamma*x_dot - omega0**2*x"],
    "duffing_unit_wells_sine": ["gamma*sin(Omega*t) - delta*x_dot + x - beta*x**3"],
    "duffing_by_frequency_cosine": [
        "gamma*cos(Omega*t) - delta*x_dot - omega0**2*x - beta*x**3",
    ],
    "pendulum_by_arc": ["-g*sin(x/l)"],
    "projectile_with_linear_drag_by_mass_2": ["-c*x_dot", "-g - c*y_dot"],
    "duffing_two_wells_cosine": ["gamma*cos(Omega*t) - delta*x_dot + alpha*x - beta*x**3"],
    "quarter_car": [
        "(k2*(x2 - x1) + c2*(x2_dot - x1_dot) - k1*(x1 - w))/m1",
        "-(k2*(x2 - x1) + c2*(x2_dot - x1_dot))/m2",
    ],
    "two_damped_oscillators": [
        "(-k1*x1 + k2*(x2 - x1) + c2*(x2_dot - x1_dot))/m1",
        "(k2*(x1 - x2) + c2*(x1_dot - x2_dot))/m2",
    ],
    "three_oscillators": ["k*(x2 - 2*x1)/m1", "k*(x1 - 2*x2 + x3)/m2", "k*(x2 - 2*x3)/m3"],
    # L. R. Wilberforce; the coupling of R. E. Berg, T. S. Marshall, Am. J. Phys. 59 (1991) 32
    "wilberforce": ["-(k*x + epsilon*theta/2)/m", "-(delta*theta + epsilon*x/2)/I"],
    "resonant_wilberforce": [
        "-omega0**2*x - epsilon*theta/(2*m)",
        "-omega0**2*theta - epsilon*x/(2*I)",
    ],
    "falling_mass": ["-G*M/r**2"],
    "attracted_mass_2": ["-G*M*x/(x**2 + y**2)**(3/2)", "-G*M*y/(x**2 + y**2)**(3/2)"],
    "attracted_unit_mass_3": [f"-k*{q}/(x**2 + y**2 + z**2)**(3/2)" for q in "xyz"],
    "mass_on_spring_2": [
        "-k/m*(1 - l/sqrt(x**2 + y**2))*x",
        "-k/m*(1 - l/sqrt(x**2 + y**2))*y - g",
    ],
    "projectile_with_drag_2": [
        "-c/m*sqrt(x_dot**2 + y_dot**2)*x_dot",
        "-g - c/m*sqrt(x_dot**2 + y_dot**2)*y_dot",
    ],
    "projectile_with_drag_by_mass_2": [
        "-c*sqrt(x_dot**2 + y_dot**2)*x_dot",
        "-g - c*sqrt(x_dot**2 + y_dot**2)*y_dot",
    ],
    "thrown_mass": ["0", "0", "-g"],
    # V. Szebehely, Theory of Orbits, Academic Press 1967
    "restricted_three_bodies_2": [
        "2*y_dot + x - (1 - mu)*(x + mu)/((x + mu)**2 + y**2)**(3/2)"
        " - mu*(x - 1 + mu)/((x - 1 + mu)**2 + y**2)**(3/2)",
        "-2*x_dot + y - (1 - mu)*y/((x + mu)**2 + y**2)**(3/2)"
        " - mu*y/((x - 1 + mu)**2 + y**2)**(3/2)",
    ],
    "charged_mass_3": ["q*B/m*y_dot", "-q*B/m*x_dot", "0"],
    "cubic_potential": ["-x - 2*k*x*y", "-y - k*(x**2 - y**2)"],
    "bodies_2_2": [
        f"{sign}G*m{other}*({q}2 - {q}1)/((x2 - x1)**2 + (y2 - y1)**2)**(3/2)"
        for sign, other in (("", 2), ("-", 1))
        for q in "xy"
    ],
    "small_foucault": [
        "2*Omega*sin(latitude)*y_dot - g/l*x",
        "-2*Omega*sin(latitude)*x_dot - g/l*y",
    ],
    "swinging_atwood_by_ratio": [
        "(r*theta_dot**2 + g*(cos(theta) - mu))/(1 + mu)",
        "-(2*r_dot*theta_dot + g*sin(theta))/r",
    ],
    # H. Goldstein, Classical Mechanics, section 5.7
    "top_about_its_tip": [
        "(I3*(psi_dot + phi_dot*cos(theta))*theta_dot"
        " - 2*I1*phi_dot*theta_dot*cos(theta))/(I1*sin(theta))",
        "phi_dot**2*sin(theta)*cos(theta) + (m*g*l"
        " - I3*phi_dot*(psi_dot + phi_dot*cos(theta)))*sin(theta)/I1",
        "phi_dot*theta_dot*sin(theta) - cos(theta)*(I3*(psi_dot + phi_dot*cos(theta))*theta_dot"
        " - 2*I1*phi_dot*theta_dot*cos(theta))/(I1*sin(theta))",
    ],
    "sliding_ball_on_beam": [
        "x*theta_dot**2 - g*sin(theta)",
        "-(2*m*x*x_dot*theta_dot + m*g*x*cos(theta))/(m*x**2 + J)",
    ],
    # J. Hauser, S. Sastry, P. Kokotovic, IEEE Trans. Automat. Contr. 37 (1992) 392
    "rolling_ball_on_beam": [
        "m/(m + I/R**2)*(x*theta_dot**2 - g*sin(theta))",
        "-(2*m*x*x_dot*theta_dot + m*g*x*cos(theta))/(m*x**2 + J)",
    ],
    "solid_ball_on_beam": [
        "5/7*(x*theta_dot**2 - g*sin(theta))",
        "-(2*m*x*x_dot*theta_dot + m*g*x*cos(theta))/(m*x**2 + J)",
    ],
    "mass_on_hinged_rod": [
        "x*theta_dot**2 - g*sin(theta)",
        "(F*l*cos(theta) - 2*m1*x*x_dot*theta_dot - m1*g*x*cos(theta)"
        " - m2*g*l*cos(theta)/2)/(m1*x**2 + m2*l**2/3)",
    ],
    # M. W. Spong, P. Corke, R. Lozano, Automatica 37 (2001) 1845
    "reaction_wheel_pendulum": [
        "(m1*r + m2*l1)*g*sin(q1)/(m1*r**2 + m2*l1**2 + I1)",
        "-(m1*r + m2*l1)*g*sin(q1)/(m1*r**2 + m2*l1**2 + I1)",
    ],
    "planar_quadrotor_by_rotors": [
        "-(F1 + F2)*sin(theta)/m",
        "(F1 + F2)*cos(theta)/m - g",
        "r*(F1 - F2)/I",
    ],
    "planar_quadrotor_by_thrust": ["-F*sin(theta)/m", "F*cos(theta)/m - g", "tau/I"],
}
#: Equations M q̈ = f, of which a row is `left = right` with accelerations.
EQUATIONS = {
    "wheeled_pendulum_by_path": [
        "(M + m + J/r**2)*x_ddot + m*l*cos(theta)*theta_ddot - m*l*theta_dot**2*sin(theta) - tau/r",
        "m*l*cos(theta)*x_ddot + (I + m*l**2)*theta_ddot - m*g*l*sin(theta) + tau",
    ],
    "wheeled_pendulum_by_turn": [
        "((M + m)*r**2 + J)*phi_ddot + m*l*r*cos(theta)*theta_ddot"
        " - m*l*r*theta_dot**2*sin(theta) - tau",
        "m*l*r*cos(theta)*phi_ddot + (I + m*l**2)*theta_ddot - m*g*l*sin(theta) + tau",
    ],
    # B. S. Cazzolato, Z. Prime, J. Control Sci. Eng. (2011) 528341, for its special cases
    "furuta_with_point_mass": [
        "(J + m*L**2 + m*l**2*sin(theta)**2)*phi_ddot + m*L*l*cos(theta)*theta_ddot"
        " - m*L*l*sin(theta)*theta_dot**2 + m*l**2*sin(2*theta)*phi_dot*theta_dot",
        "m*L*l*cos(theta)*phi_ddot + m*l**2*theta_ddot"
        " - m*l**2*sin(2*theta)*phi_dot**2/2 + m*g*l*sin(theta)",
    ],
    "furuta_with_uniform_rods": [
        "(M*L**2/3 + m*L**2 + m*l**2*sin(theta)**2/3)*phi_ddot + m*L*l/2*cos(theta)*theta_ddot"
        " - m*L*l/2*sin(theta)*theta_dot**2 + m*l**2/3*sin(2*theta)*phi_dot*theta_dot",
        "m*L*l/2*cos(theta)*phi_ddot + m*l**2/3*theta_ddot"
        " - m*l**2/6*sin(2*theta)*phi_dot**2 + m*g*l/2*sin(theta)",
    ],
    "pendulum_on_spring_cart": [
        "(m1 + m2)*x_ddot + m2*l*cos(theta)*theta_ddot - m2*l*theta_dot**2*sin(theta) + k*x",
        "cos(theta)*x_ddot + l*theta_ddot + g*sin(theta)",
    ],
    "cart_and_bar": [
        "(M + m)*x_ddot + m*l*cos(theta)*theta_ddot - m*l*theta_dot**2*sin(theta)",
        "m*l*cos(theta)*x_ddot + (I + m*l**2)*theta_ddot + m*g*l*sin(theta)",
    ],
    "cart_and_half_rod": [
        "(M + m)*x_ddot + m*l*cos(theta)*theta_ddot - m*l*theta_dot**2*sin(theta)",
        "cos(theta)*x_ddot + 4*l/3*theta_ddot + g*sin(theta)",
    ],
    "cart_and_uniform_rod": [
        "(M + m)*x_ddot + m*l/2*cos(theta)*theta_ddot - m*l/2*theta_dot**2*sin(theta)",
        "cos(theta)*x_ddot + 2*l/3*theta_ddot + g*sin(theta)",
    ],
    "sideways_coupled_pendulums": [
        "m*l*theta1_ddot + m*g*sin(theta1) + k*l*(sin(theta1) - sin(theta2))*cos(theta1)",
        "m*l*theta2_ddot + m*g*sin(theta2) + k*l*(sin(theta2) - sin(theta1))*cos(theta2)",
    ],
    "twist_coupled_pendulums": [
        "m*l**2*theta1_ddot + m*g*l*sin(theta1) + k*(theta1 - theta2)",
        "m*l**2*theta2_ddot + m*g*l*sin(theta2) + k*(theta2 - theta1)",
    ],
    "two_links": [
        "(I1 + m1*r1**2 + m2*l1**2)*theta1_ddot + m2*l1*r2*cos(theta1 - theta2)*theta2_ddot"
        " + m2*l1*r2*sin(theta1 - theta2)*theta2_dot**2 + (m1*r1 + m2*l1)*g*sin(theta1)",
        "m2*l1*r2*cos(theta1 - theta2)*theta1_ddot + (I2 + m2*r2**2)*theta2_ddot"
        " - m2*l1*r2*sin(theta1 - theta2)*theta1_dot**2 + m2*g*r2*sin(theta2)",
    ],
    "two_links_about_joints": [
        "(I1 + m2*l1**2)*theta1_ddot + m2*l1*r2*cos(theta1 - theta2)*theta2_ddot"
        " + m2*l1*r2*sin(theta1 - theta2)*theta2_dot**2 + (m1*r1 + m2*l1)*g*sin(theta1)",
        "m2*l1*r2*cos(theta1 - theta2)*theta1_ddot + I2*theta2_ddot"
        " - m2*l1*r2*sin(theta1 - theta2)*theta1_dot**2 + m2*g*r2*sin(theta2)",
    ],
    "two_links_with_motors": [
        "(I1 + m2*l1**2 + Ir*gr**2 + Ir*(1 + gr)**2)*theta1_ddot"
        " + (m2*l1*r2*cos(theta1 - theta2) - Ir*gr*(1 + gr))*theta2_ddot"
        " + m2*l1*r2*sin(theta1 - theta2)*theta2_dot**2 + (m1*r1 + m2*l1)*g*sin(theta1)",
        "(m2*l1*r2*cos(theta1 - theta2) - Ir*gr*(1 + gr))*theta1_ddot"
        " + (I2 + Ir*gr**2)*theta2_ddot"
        " - m2*l1*r2*sin(theta1 - theta2)*theta1_dot**2 + m2*g*r2*sin(theta2)",
    ],
    "two_half_rods": [
        "(4*m1/3 + 4*m2)*l1*theta1_ddot + 2*m2*l2*cos(theta1 - theta2)*theta2_ddot"
        " + 2*m2*l2*sin(theta1 - theta2)*theta2_dot**2 + (m1 + 2*m2)*g*sin(theta1)",
        "2*l1*cos(theta1 - theta2)*theta1_ddot + 4*l2/3*theta2_ddot"
        " - 2*l1*sin(theta1 - theta2)*theta1_dot**2 + g*sin(theta2)",
    ],
    "two_rods_by_centres": [
        "(m1*l1**2/3 + m2*l1**2)*theta1_ddot + m2*l1*r2*cos(theta1 - theta2)*theta2_ddot"
        " + m2*l1*r2*sin(theta1 - theta2)*theta2_dot**2 + (m1*r1 + m2*l1)*g*sin(theta1)",
        "m2*l1*r2*cos(theta1 - theta2)*theta1_ddot + m2*l2**2/3*theta2_ddot"
        " - m2*l1*r2*sin(theta1 - theta2)*theta1_dot**2 + m2*g*r2*sin(theta2)",
    ],
}


def residuals(name: str, rows: list[str]) -> list[sp.Expr]:
    """What rows leave over with the accelerations of a known system, at a generic state."""
    system = named(name)
    accelerations = Derivation(system).accelerations
    symbols = [*system.q, *system.qdot, *(one.symbol for one in system.parameters)]
    known = {one.name: one for one in symbols}
    second = {f"{q}_ddot": sp.Symbol(f"{q}_ddot") for q in system.q}
    values = [parse(row, {**known, **second, **FUNCTIONS, "t": TIME}) for row in rows]
    point = {one: sp.Rational(7 + 3 * k, 11 + k) for k, one in enumerate((*symbols, TIME))}
    exact = [one.subs(point) for one in accelerations]
    names = dict(zip(second.values(), exact, strict=True))
    left = [sp.S.Zero] * len(rows) if any(v.has(*second.values()) for v in values) else exact
    assert len(rows) == len(exact)
    return [
        abs((value.subs(names).subs(point) - own).evalf(30))
        for value, own in zip(values, left, strict=True)
    ]


@pytest.mark.parametrize("name", [*ACCELERATIONS, *EQUATIONS])
def test_known_systems_have_the_equations_of_textbooks(name: str) -> None:
    rows = ACCELERATIONS.get(name) or EQUATIONS[name]
    assert max(residuals(name, rows)) < 1e-25


@pytest.mark.parametrize(("name", "old", "new"), [
    ("quarter_car", "k2*(x2 - x1)", "k2*(x1 - x2)"),
    ("rolling_ball_on_beam", "m + I/R**2", "m + I"),
    ("furuta_with_point_mass", "sin(2*theta)*phi_dot**2/2", "sin(2*theta)*phi_dot**2"),
])  # fmt: skip
def test_a_slip_in_such_equations_leaves_a_residual(name: str, old: str, new: str) -> None:
    rows = [row.replace(old, new) for row in ACCELERATIONS.get(name) or EQUATIONS[name]]
    assert max(residuals(name, rows)) > 1e-6
