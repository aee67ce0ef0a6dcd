"""Hand derivations of systems with constraints: multipliers, reduced equations, and mistakes."""

from pathlib import Path
from types import SimpleNamespace
from typing import cast

import pytest
import sympy as sp

from derive.verification.hand_derivation_files import judge
from derive.verification.judging.reference_system import ReferenceSystem
from derive.verification.judging.substitution import substituted_constraints
from derive.verification.judging.verdict import Verdict

MASS = """
[[masses]]
mass = "m"
position = ["x + a*cos(theta)", "y + a*sin(theta)"]
inertia = "J"
angle = "theta"
"""
SYSTEMS = {
    # J. I. Neimark, N. A. Fufaev, Dynamics of Nonholonomic Systems, chapter III
    "sleigh": f"""
title = "Chaplygin's sleigh"
potential = "0"
constraints = ["y_dot*cos(theta) - x_dot*sin(theta)"]
coordinates = {{ x = {{ unit = "m" }}, y = {{ unit = "m" }}, theta = {{}} }}
[parameters]
m = {{ value = 1, unit = "kg" }}
J = {{ value = 1, unit = "kg m^2" }}
a = {{ value = 0.5, unit = "m" }}
{MASS}""",
    "disc": """
title = "A vertical rolling disc"
potential = "0"
constraints = ["x_dot - R*phi_dot*cos(theta)", "y_dot - R*phi_dot*sin(theta)"]
coordinates = { x = { unit = "m" }, y = { unit = "m" }, theta = {}, phi = {} }
[parameters]
m = { value = 1, unit = "kg" }
J = { value = 1, unit = "kg m^2" }
I = { value = 1, unit = "kg m^2" }
R = { value = 0.5, unit = "m" }
[[masses]]
mass = "m"
position = ["x", "y", "R"]
[[masses]]
mass = "J"
position = ["theta", "0", "0"]
[[masses]]
mass = "I"
position = ["phi", "0", "0"]
""",
    "swing": """
title = "Pendulum in Cartesian coordinates"
constraints = [{ formula = "x**2 + y**2 - l**2", name = "rod", unit = "N/m" }]
coordinates = { x = { unit = "m" }, y = { unit = "m" } }
[parameters]
m = { value = 1, unit = "kg" }
l = { value = 0.8, unit = "m" }
g = { value = 9.81, unit = "m/s^2" }
[[masses]]
mass = "m"
position = ["x", "y"]
""",
    # at some generic states a > l, and the bob is not below the ceiling
    "ceiling": """
title = "Pendulum below a ceiling"
constraints = ["x**2 + (h + a)**2 - l**2"]
coordinates = { x = { unit = "m" }, h = { unit = "m", positive = true } }
[parameters]
m = { value = 1, unit = "kg" }
l = { value = 0.8, unit = "m" }
a = { value = 0.3, unit = "m" }
g = { value = 9.81, unit = "m/s^2" }
[[masses]]
mass = "m"
position = ["x", "-h"]
""",
}
X = "m*x_ddot - m*a*theta_ddot*sin(theta) - m*a*theta_dot**2*cos(theta) = -lambda*sin(theta)"
Y = "m*y_ddot + m*a*theta_ddot*cos(theta) - m*a*theta_dot**2*sin(theta) = lambda*cos(theta)"
TURN = "(J + m*a**2)*theta_ddot + m*a*(y_ddot*cos(theta) - x_ddot*sin(theta)) = 0"
NEGATIVE = [one.replace("lambda", "(-lambda_1)") for one in (X, Y, TURN)]
SPEED = 'names.v = "x_dot*cos(theta) + y_dot*sin(theta)"\n'
ROLLING = ["m*x_ddot = lambda_1", "m*y_ddot = lambda_2", "J*theta_ddot = 0"]
SPIN = "I*phi_ddot = -R*(lambda_1*cos(theta) + lambda_2*sin(theta))"


def judged(folder: Path, system: str, equations: list[str], more: str = "") -> tuple[Verdict, ...]:
    """Verdicts on equations, and on other lines of a file."""
    (folder / "system.toml").write_text(SYSTEMS[system])
    path = folder / "source.toml"
    path.write_text(f'system = "system.toml"\neuler_lagrange = {equations}\n{more}')
    return judge(path).equations


@pytest.mark.long("more cases of the same kind", keep=3)
@pytest.mark.parametrize(
    ("system", "equations", "more"),
    [
        ("sleigh", [X, Y, TURN], ""),
        ("sleigh", [X, Y, TURN, "y_dot*cos(theta) = x_dot*sin(theta)"], ""),
        ("sleigh", NEGATIVE, ""),
        ("sleigh", [one.replace("lambda", "R") for one in (X, Y, TURN)], 'names.R = "lambda_1"'),
        ("sleigh", ["v_dot = a*theta_dot**2", "(J + m*a**2)*theta_ddot + m*a*theta_dot*v = 0"],
         SPEED + 'kinetic_energy = "m*(v**2 + a**2*theta_dot**2)/2 + J*theta_dot**2/2"'),
        ("sleigh", [X, Y, TURN],
         SPEED + '[accelerations]\ntheta = "-m*a*v*theta_dot/(J + m*a**2)"'),
        ("disc", [*ROLLING, SPIN], ""),
        ("disc", ["J*theta_ddot = 0", "(I + m*R**2)*phi_ddot = 0"], ""),
        ("swing", ["m*x_ddot = -2*lambda*x", "m*y_ddot + m*g = -2*lambda*y"], ""),
        ("swing", ["m*x_ddot = lambda*x", "m*y_ddot + m*g = lambda*y"], ""),
        ("swing", ["y*x_ddot - x*y_ddot = g*x"], ""),
        ("swing", ["m*x_ddot = 2*rod*x", "m*y_ddot = 2*rod*y - m*g",
                   "2*rod*l**2 = -m*(x_dot**2 + y_dot**2) + m*g*y"], ""),
        ("ceiling", ["m*x_ddot = -2*lambda*x", "m*h_ddot - m*g = -2*lambda*(h + a)",
                     "h = sqrt(l**2 - x**2) - a"], ""),
    ],
)  # fmt: skip
def test_correct_equations_hold(
    system: str, equations: list[str], more: str, tmp_path: Path
) -> None:
    verdicts = judged(tmp_path, system, equations, more)
    assert [one.verdict for one in verdicts] == ["verified"] * len(verdicts), verdicts
    assert not any("incomplete" in one.note for one in verdicts)


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize(
    ("system", "equations", "wrong"),
    [
        ("sleigh", [X, Y.replace("- m*a*theta_dot", "+ m*a*theta_dot"), TURN],
         "m*a*theta_dot**2*sin(theta)"),
        ("sleigh", [X, Y, TURN.replace("= 0", "= lambda")], "lambda"),
        ("disc", [*ROLLING[1:], SPIN, "m*x_ddot = -lambda_1"], "lambda_1"),
        ("swing", ["m*x_ddot = -2*lambda*x", "m*y_ddot - m*g = -2*lambda*y"], "m*g"),
        ("swing", ["y*x_ddot + x*y_ddot = g*x"], "x*y_ddot"),
        ("swing", ["x_dot = y*y_dot/x"], "y*y_dot/x"),
    ],
)  # fmt: skip
def test_the_wrong_term_is_found(
    system: str, equations: list[str], wrong: str, tmp_path: Path
) -> None:
    (verdict,) = (one for one in judged(tmp_path, system, equations) if one.verdict == "wrong")
    changed = [f"{one.wrong} {one.correct}" for one in verdict.corrections]
    assert any(wrong in one for one in (*changed, verdict.difference)), verdict


def test_incomplete_sets_are_reported(tmp_path: Path) -> None:
    for equations in ([X, Y], ["(J + m*a**2)*theta_ddot + m*a*theta_dot*(x_dot*cos(theta)"
                               " + y_dot*sin(theta)) = 0"]):  # fmt: skip
        assert "the set is incomplete" in judged(tmp_path, "sleigh", equations)[-1].note


SUBSTITUTED = {
    # L with y_dot = x_dot*tan(theta), and its own equations
    "sleigh": (
        "m*(x_dot**2/cos(theta)**2 + a**2*theta_dot**2)/2 + J*theta_dot**2/2",
        ["m*x_ddot/cos(theta)**2 + 2*m*x_dot*theta_dot*sin(theta)/cos(theta)**3 = 0",
         "(J + m*a**2)*theta_ddot - m*x_dot**2*sin(theta)/cos(theta)**3 = 0"],
    ),
    # L with phi_dot = x_dot/(R*cos(theta)) and y_dot = x_dot*tan(theta)
    "disc": (
        "(m + I/R**2)*x_dot**2/cos(theta)**2/2 + J*theta_dot**2/2",
        ["x_ddot*cos(theta) + 2*x_dot*theta_dot*sin(theta) = 0",
         "J*theta_ddot = (m + I/R**2)*x_dot**2*sin(theta)/cos(theta)**3"],
    ),
}  # fmt: skip


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize("system", SUBSTITUTED)
def test_substitution_into_the_lagrangian_is_recognised(system: str, tmp_path: Path) -> None:
    lagrangian, equations = SUBSTITUTED[system]
    verdicts = judged(tmp_path, system, equations, f'lagrangian = "{lagrangian}"')
    assert {one.verdict for one in verdicts} == {"wrong"}
    for one in verdicts:
        assert "must not be used before the Lagrangian is differentiated" in one.note
    assert [one.note.count("without") for one in verdicts] == [1, 1, 0]
    assert verdicts[-1].note.startswith("it is the Lagrangian of motions alone")


@pytest.mark.parametrize(("is_lagrangian_of_motions", "nonholonomic", "count"), [
    (False, None, 0), (True, (), 0), (True, ("y_dot",), 1),
])  # fmt: skip
def test_integrability_of_constraints_is_decided_for_few_slips(
    is_lagrangian_of_motions: bool, nonholonomic: tuple[str, ...] | None, count: int
) -> None:
    decision = SimpleNamespace(nonholonomic=nonholonomic) if nonholonomic is not None else None
    derivation = SimpleNamespace(
        system=SimpleNamespace(conditions=("y_dot",)), integrability=decision, lagrangian=0
    )
    motions = SimpleNamespace(is_small=lambda _difference: is_lagrangian_of_motions)
    model = cast("ReferenceSystem", SimpleNamespace(derivation=derivation, motions=motions))
    note = substituted_constraints(model, "lagrangian", sp.S.One)
    assert note.count("it is the Lagrangian of motions alone") == count


def test_forces_count_in_equations_by_substitution(tmp_path: Path) -> None:
    braked = 'dissipation = "c*theta_dot**2/2"\npotential = "0"'
    text = SYSTEMS["sleigh"].replace('potential = "0"', braked)
    text = text.replace("[parameters]", '[parameters]\nc = { value = 0.1, unit = "N m s" }')
    (tmp_path / "braked.toml").write_text(text)
    path, (_, equations) = tmp_path / "source.toml", SUBSTITUTED["sleigh"]
    for force, count in (("- c*theta_dot", 1), ("c*theta_dot", 0)):
        turn = equations[1].replace("= 0", f"= {force}")
        path.write_text(f'system = "braked.toml"\neuler_lagrange = ["{turn}"]')
        (one,) = judge(path).equations
        assert one.verdict == "wrong"
        assert one.note.count("it follows from the Lagrangian without y_dot; ") == count


# L of the shipped disc with x_dot = R*chi_dot*cos(psi), y_dot = R*chi_dot*sin(psi); of its own
# equations that of phi holds, and those of chi and psi lack the moments of the multipliers. The
# last equation is that of psi with chi_dot = x_dot/(R*cos(psi)), y_dot = x_dot*tan(psi)
@pytest.mark.long("a long substitution")
def test_a_rolling_disc_by_substitution_is_wrong(tmp_path: Path) -> None:
    path = tmp_path / "disc.toml"
    path.write_text("""
system = "rolling_disc"
lagrangian = '''m*R**2*((2*k + 1)*n**2 + (k + 1)*phi_dot**2 + k*psi_dot**2*cos(phi)**2)/2
 - m*g*R*cos(phi)'''
euler_lagrange = ["(2*k + 1)*n_dot = 0",
 '''k*psi_ddot*cos(phi)**2 - 2*k*psi_dot*phi_dot*sin(phi)*cos(phi)
 + (2*k + 1)*(n_dot*sin(phi) + n*phi_dot*cos(phi)) = 0''',
 '''(k + 1)*phi_ddot + k*psi_dot**2*sin(phi)*cos(phi) - (2*k + 1)*psi_dot*n*cos(phi)
 - g*sin(phi)/R = 0''',
 '''k*psi_ddot*cos(phi)**2 - 2*k*psi_dot*phi_dot*sin(phi)*cos(phi)
 + (2*k + 1)*(n_dot*sin(phi) + n*phi_dot*cos(phi) - n*chi_dot*tan(psi)) = 0''']
names.n = "chi_dot + psi_dot*sin(phi)"
""")
    lagrangian, turn, heading, lean, other = judge(path).equations
    assert lagrangian.note.startswith("it is the Lagrangian of motions alone")
    for one, removed in (
        (turn, "x_dot, y_dot"),
        (heading, "x_dot, y_dot"),
        (other, "y_dot, chi_dot"),
    ):
        assert one.verdict == "wrong"
        assert one.note.startswith(f"it follows from the Lagrangian without {removed}; ")
    assert (lagrangian.verdict, lean.verdict) == ("wrong", "verified")


def test_other_mistakes_are_not_this_one(tmp_path: Path) -> None:
    wrong = [X, Y.replace("- m*a*theta_dot", "+ m*a*theta_dot"), TURN]
    assert not any("differentiated" in one.note for one in judged(tmp_path, "sleigh", wrong))
