"""Programs as people write them: measurements of a state, limits, inputs, callbacks of frames."""

import re

import pytest

from derive.reading.programs.program_reader import read_program
from derive.verification.documents.letters import candidates
from derive.verification.documents.pages.verdicts_in_place import DocumentVerdicts
from derive.verification.documents.program_judgement import judge_program

ROD = """
import numpy as np

class Rod:
    def step(self, torque):
        angle, rate = self.state
        torque = np.clip(torque, -self.top, self.top).astype(float)[0]
        rate = rate + (3 * g / (2 * l) * np.sin(angle) + 3 / (m * l**2) * torque) * dt
        rate = np.clip(rate, -8, 8)
        angle = angle + rate * dt
        self.state = np.array([angle, rate])

    def seen(self):
        angle, rate = self.state
        return np.array([np.cos(angle), np.sin(angle), rate])
"""
FRAMES = """
function start() {
  var l = Number(box("l").value), a = Number(box("a").value), w = 0;
  setInterval(function () {
    acc = -g * Math.sin(a) / l;
    w += acc * dt;
    a += w * dt;
    draw();
  }, 20);
}
"""
CART = """
class Cart:
    def __init__(self):
        self.gravity, self.polemass, self.cartmass, self.length = 9.8, 0.1, 1.0, 0.5
        self.total_mass = self.polemass + self.cartmass
        self.strength = 10.0

    def step(self, action):
        x, x_dot, theta, theta_dot = self.state
        force = self.strength if action else -self.strength
        s, c = sin(theta), cos(theta)
        part = (force + self.polemass * self.length * theta_dot**2 * s) / self.total_mass
        turn = (self.gravity * s - c * part) / (
            self.length * (4.0 / 3.0 - self.polemass * c**2 / self.total_mass))
        push = part - self.polemass * self.length * turn * c / self.total_mass
        x_dot = x_dot + dt * push
        x = x + dt * x_dot
        theta_dot = theta_dot + dt * turn
        theta = theta + dt * theta_dot
        self.state = (x, x_dot, theta, theta_dot)

class Other:
    def __init__(self):
        self.total_mass = self.polemass + self.cartmass
"""
#: A force on the first of two coordinates.
DIRECTED = r"""
function dx = cart(x, u, M, m, l, g)
    H = [M + m, m*l*cos(x(2)); m*l*cos(x(2)) m*l*l];
    C = [0, -m*l*x(4)*sin(x(2)); 0, 0];
    G = [0; m*g*l*sin(x(2))];
    B = [1; 0];
    dx = [x(3:4); H\(B*u - G - C*x(3:4))];
end
"""


def judged(text: str, language: str = "Python") -> DocumentVerdicts:
    return judge_program(read_program(text, language))


def equations(document: DocumentVerdicts) -> list[str]:
    formulas = document.formulas
    return [one.verdict for one in formulas if one.latex != "method of integration"]


def test_measurements_of_a_state_are_no_rates() -> None:
    document = judged(ROD)
    assert equations(document) == ["verified"]
    assert all(one.verdict != "wrong" for one in document.formulas)
    assert equations(judged(ROD.replace("3 * g", "5 * g"))) != ["verified"]


def test_limits_and_types_change_no_equation() -> None:
    (formula,) = (one for one in judged(ROD).formulas if "ddot" in one.latex)
    assert "torque" in formula.latex
    assert "clip" not in formula.latex


def test_functions_without_a_name_that_a_timer_calls_are_followed() -> None:
    assert equations(judged(FRAMES, "JavaScript")) == ["verified"]


def test_one_of_two_constants_is_an_input_and_repeated_formulas_are_one() -> None:
    (function,) = (one for one in read_program(CART, "Python").functions if one.equations)
    for equation in function.equations:
        assert "force" in equation.text
        assert "polemass + cartmass" in equation.text
        assert "total_mass" not in equation.text


@pytest.mark.long("other tests reach its code")
def test_a_parameter_is_not_the_variable_of_its_name_in_another_function() -> None:
    text = """
def reduced(length):
    l = 2 * length
    return l

def rhs(t, y, l):
    theta, omega = y
    return [omega, -g / l * sin(theta)]
"""
    shown = {given: [one.latex for one in judged(text.replace("y, l", given)).formulas]
             for given in ("y, l", "y")}  # fmt: skip
    assert shown["y, l"] == ["theta_ddot = -g/l*sin(theta)"]
    # without the parameter it is that variable, as of an object or a program that assigns it once
    assert shown["y"] == ["theta_ddot = -g/(2*length)*sin(theta)"]


@pytest.mark.long("other tests reach its code")
def test_a_vector_of_zeros_and_ones_gives_a_force_its_direction() -> None:
    # of the letters B_1 and B_2, the second would be a force that the system does not have
    assert equations(judged(DIRECTED, "MATLAB")) == ["verified", "verified"]
    wrong = judged(DIRECTED.replace("g*l*sin", "g*l*cos"), "MATLAB")
    assert [(one.line, one.verdict) for one in wrong.formulas] == [(5, "wrong"), (7, "verified")]


#: A leapfrog step with momenta, and variables of their own for values in the step.
MOMENTA = """
void orbit(int n) {
    double x0 = 1, y0 = 0, px0 = 0, py0 = m;
    for (int i = 0; i < n; i++) {
        double x = x0 + dt*px0/(2*m), y = y0 + dt*py0/(2*m);
        double px = px0 - dt*G*M*m*x/pow(sqrt(x*x + y*y), 3);
        double py = py0 - dt*G*M*m*y/pow(sqrt(x*x + y*y), 3);
        x0 = x + dt*px/(2*m);
        y0 = y + dt*py/(2*m);
        px0 = px;
        py0 = py;
    }
}
"""


@pytest.mark.long("other tests reach its code")
def test_momenta_of_a_leapfrog_step_give_accelerations() -> None:
    document = judged(MOMENTA, "C")
    assert equations(document) == ["verified", "verified"]
    assert all("leapfrog" in one.note for one in document.formulas if "method" in one.latex)
    wrong = judged(MOMENTA.replace("py0 - dt", "py0 + dt"), "C")
    assert [one.line for one in wrong.formulas if one.verdict == "wrong"] == [7]


#: A plate on a hinge, whose moment of inertia follows from other constants.
PLATE = """
M, a, b, g = 2.0, 0.5, 0.25, 9.81
I = M*(a**2 + b**2)/3
d = np.sqrt(a**2 + b**2)/2

def rates(t, y):
    theta, w = y
    return [w, -M*g*d/I*np.sin(theta)]
"""


@pytest.mark.long("other tests reach its code")
def test_constants_that_follow_from_others_can_be_letters() -> None:
    (function,) = read_program(PLATE, "Python").functions
    assert "a**2 + b**2" in function.equations[0].text
    (formula,) = judged(PLATE).formulas
    assert (formula.latex, formula.verdict) == ("theta_ddot = -M*g*d/I*sin(theta)", "verified")
    assert equations(judged(PLATE.replace("np.sin", "np.cos"))) != ["wrong"]


#: Accelerations by their names, of a state that is an object of a library.
NAMED = """
def dynamics(model, x, u):
    th, thdot = x[1].item(), x[3].item()
    f = u[0].item()
    M, m, l, g = model.M, model.m, model.l, model.g
    s, c = np.sin(th), np.cos(th)
    mu = M + m*s**2
    xddot = (f + m*c*s*g - m*l*s*thdot**2)/mu
    thddot = (c*f/l + (M + m)*g*s/l - m*c*s*thdot**2)/mu
    return [xddot, thddot]
"""


@pytest.mark.long("other tests reach its code")
def test_accelerations_can_be_known_by_their_names_alone() -> None:
    assert equations(judged(NAMED)) == ["verified", "verified"]
    wrong = judged(NAMED.replace("l*s*thdot**2", "l*s*thdot"))
    assert [(one.line, one.verdict) for one in wrong.formulas] == [(8, "wrong"), (9, "verified")]
    assert not judged(NAMED.replace("thdot", "rate")).formulas


@pytest.mark.long("other tests reach its code")
def test_a_ratio_can_stand_for_two_masses() -> None:
    text = """
def rates(t, y, g, mu):
    r, v, theta, omega = y
    a = (r*omega**2 + g*(np.cos(theta) - mu))/(1 + mu)
    return v, a, omega, -(2*v*omega + g*np.sin(theta))/r
"""
    assert equations(judged(text)) == ["verified", "verified"]
    assert equations(judged(text.replace("(1 + mu)", "(1 - mu)"))) == ["wrong", "verified"]


@pytest.mark.long("other tests reach its code")
def test_friction_can_have_the_name_of_a_gain() -> None:
    text = """
def rates(t, y, u, M, m, l, g, Kd):
    x, v, theta, omega = y
    F = u - Kd*v - m*l*omega**2*np.sin(theta)
    a = (F + m*g*np.sin(theta)*np.cos(theta))/(M + m*np.sin(theta)**2)
    return v, a, omega, (g*np.sin(theta) + a*np.cos(theta))/l
"""
    assert equations(judged(text)) == ["verified"] * 2
    assert equations(judged(text.replace("+ a*np", "- a*np"))) == ["verified", "wrong"]


SEGWAY = """
function dy = rates(t, y)
    theta = y(1); w = y(2); u = y(3);
    a = (M + m)*r^2 + J;
    b = m*r*l*cos(theta);
    c = m*l^2 + I;
    dy(1) = w;
    dy(2) = (g*a*m*l*sin(theta) - b*m*r*l*sin(theta)*w^2 - (a + b)*tau)/(a*c - b^2);
    dy(3) = (c*m*r*l*sin(theta)*w^2 - g*b*m*l*sin(theta) + (b + c)*tau)/(a*c - b^2);
end
"""


def test_a_velocity_can_stand_without_its_coordinate() -> None:
    program = judge_program(read_program(SEGWAY.replace("u = y(3)", "omega_r = y(3)"), "MATLAB"))
    assert equations(program) == ["verified", "verified"]
    assert [one.latex.partition(" = ")[0] for one in program.formulas] == [
        "theta_ddot", "omega_r_dot",
    ]  # fmt: skip


THROWN = """
g, k = -9.8, -0.01
def rates(t, s):
    x, y, u, v = s
    speed = np.sqrt(u**2 + v**2)
    return u, v, k*speed*u, g + k*speed*v
"""


def test_constants_can_be_negative() -> None:
    assert equations(judged(THROWN)) == ["verified", "verified"]
    positive = equations(judged(THROWN.replace("-0.01", "0.01")))
    assert positive == ["context", "context"]


@pytest.mark.long("other tests reach its code")
def test_masses_can_have_any_letters_where_no_other_is_usual() -> None:
    text = """
def rates(t, y, r1, r2, l1, l2, g):
    a, b, v, w = y
    d = r1 + r2*sin(a - b)**2
    p = -r2*l2*w**2*sin(a - b) - (r1 + r2)*g*sin(a)
    q = l1*v**2*sin(a - b) - g*sin(b)
    return v, w, (p - r2*cos(a - b)*q)/(l1*d), ((r1 + r2)*q - cos(a - b)*p)/(l2*d)
"""
    assert equations(judged(text)) == ["verified", "verified"]
    # a guess of letters verifies, and accuses of nothing
    slip = equations(judged(text.replace("(r1 + r2)*q", "(r1 + 2*r2)*q")))
    assert "wrong" not in slip


@pytest.mark.long("other tests reach its code")
def test_a_length_with_an_index_is_not_that_of_another_rod() -> None:
    text = """
def rates(t, y, m1, m2, r1, r2, g):
    a, b, v, w = y
    d = m1 + m2*sin(a - b)**2
    q = r1*v**2*sin(a - b) - g*sin(b)
    p = -m2*r2*w**2*sin(a - b) - (m1 + m2)*g*sin(a)
    return v, w, (p - m2*cos(a - b)*q)/(r1*d), ((m1 + m2)*q - cos(a - b)*p)/(r2*d)
"""
    assert equations(judged(text)) == ["verified", "verified"]
    slip = judged(text.replace("-m2*r2*w**2", "-m2*r1*w**2"))
    assert "verified" not in equations(slip)[:1]


@pytest.mark.long("other tests reach its code")
def test_friction_can_have_any_letter() -> None:
    text = """
def rates(t, y, g, length, res):
    a, v = y
    return v, -g/length*sin(a) - res*v
"""
    assert equations(judged(text)) == ["verified"]
    assert equations(judged(text.replace("res*v", "res*a"))) != ["verified"]


UPRIGHT = """
def rates(t, y, M, m, l, g, u):
    x, a, v, w = y
    d = M + m*sin(a)**2
    return (v, w, (u + m*l*w**2*sin(a) - m*g*sin(a)*cos(a))/d,
            ((M + m)*g*sin(a) - u*cos(a) - m*l*w**2*sin(a)*cos(a))/(l*d))
"""


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize(("masses", "force"), [
    (("M", "m"), "u"), (("mc", "mp"), "U"), (("mCart", "mPend"), "F"),
])  # fmt: skip
def test_letters_can_have_indices_in_one_word(masses: tuple[str, str], force: str) -> None:
    text = UPRIGHT
    for old, new in zip(("M", "m", "u"), (*masses, force), strict=True):
        text = re.sub(rf"\b{old}\b", f"@{new}", text)
    assert equations(judged(text.replace("@", ""))) == ["verified", "verified"]


@pytest.mark.long("other tests reach its code")
def test_of_two_equations_the_one_with_a_slip_is_wrong() -> None:
    slip = UPRIGHT.replace("*w**2*sin(a) -", "*w**2*sin(a)*2 -")
    assert equations(judged(slip)) == ["wrong", "verified"]


@pytest.mark.long("other tests reach its code")
def test_gravity_with_another_sign_in_all_equations_is_another_angle(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(candidates, "MAX_CANDIDATES", 3)  # only angles from hanging are tried
    assert equations(judged(UPRIGHT)) == ["context", "context"]
    assert "wrong" in equations(
        judged(UPRIGHT.replace("- m*g*", "+ 2*m*g*").replace("g*sin(a) - u", "-g*sin(a) - u"))
    )


@pytest.mark.long("other tests reach its code")
def test_constants_can_be_those_of_a_unit_mass() -> None:
    text = """
def rates(t, y, k, g, L):
    r, a, v, w = y
    return v, w, r*w**2 + g*cos(a) - k*(r - L), -(2*v*w + g*sin(a))/r
"""
    assert equations(judged(text)) == ["verified", "verified"]
    assert equations(judged(text.replace("+ g*cos", "+ 2*g*cos")))[0] != "verified"


@pytest.mark.long("other tests reach its code")
def test_a_frequency_can_be_1_beside_that_of_a_force() -> None:
    text = "def rates(t, y, b, w):\n    a, v = y\n    return v, -sin(a) + b*cos(w*t)\n"
    assert equations(judged(text)) == ["verified"]
    assert equations(judged(text.replace("cos(w*t)", "cos(w*a)"))) != ["verified"]


def test_an_entry_of_an_array_of_times_is_the_time() -> None:
    text = """
program swing
  real :: theta(0:100), omega(0:100), t(0:100)
  do i = 0, 99
    omega(i+1) = omega(i) + (-(g/l)*sin(theta(i)) + a*sin(w*t(i)))*dt
    theta(i+1) = theta(i) + omega(i+1)*dt
    t(i+1) = t(i) + dt
  end do
end program
"""
    assert equations(judged(text, "Fortran")) == ["verified"]


@pytest.mark.long("other tests reach its code")
def test_a_gain_of_an_input_is_no_friction() -> None:
    # a two-link arm whose second joint has the torque B u
    text = """
def rates(t, s, m1, m2, l1, lc1, lc2, I1, I2, g, B, u):
    a, b, v, w = s
    M = np.array([[I1 + I2 + m2*l1**2 + 2*m2*l1*lc2*cos(b), I2 + m2*l1*lc2*cos(b)],
                  [I2 + m2*l1*lc2*cos(b), I2]])
    f = np.array([-m1*g*lc1*sin(a) - m2*g*(l1*sin(a) + lc2*sin(a + b))
                  + m2*l1*lc2*sin(b)*(2*v*w + w**2),
                  -m2*g*lc2*sin(a + b) - m2*l1*lc2*sin(b)*v**2 + B*u])
    acc = np.linalg.solve(M, f)
    return v, w, acc[0], acc[1]
"""
    assert equations(judged(text)) == ["verified", "context"]
    slip = equations(judged(text.replace("- m2*l1*lc2*sin(b)*v**2 + B*u", "+ u")))
    assert slip == ["verified", "wrong"]


@pytest.mark.long("other tests reach its code")
def test_equations_of_which_one_letter_agrees_are_not_wrong() -> None:
    # a body with two rotors, of which a mass in space would be the nearest known system
    text = """
def rates(t, y, m, r, J, g, f1, f2, w):
    a, b, c, va, vb, vc = y
    return va, vb, vc, -(f1 + f2)*sin(c)/m, (f1 + f2)*cos(c)/m - g, w*r/J*(f1 - f2)
"""
    assert "wrong" not in equations(judged(text))
    text = "def rates(t, y, G, mass):\n    x, z, v, w = y\n    return v, w, 0/mass, -G/mass\n"
    assert equations(judged(text)) == ["context", "context"]
    assert equations(judged(text.replace("G/mass", "G"))) == ["verified", "verified"]


@pytest.mark.long("other tests reach its code")
def test_a_name_that_only_angles_have_is_an_angle() -> None:
    text = """
def rates(t, x, m, l, I, g, u1, u2):
    x1, x2, x3, v1, v2, v3 = x
    return v1, v2, v3, -(u1 + u2)*sin(x3)/m, (u1 + u2)*cos(x3)/m - g, l/I*(u1 - u2)
"""
    assert equations(judged(text)) == ["verified"] * 3
    assert "verified" not in equations(judged(text.replace("cos(x3)/m", "cos(x2)/m")))[1:2]


def test_a_letter_of_springs_can_be_one_of_friction() -> None:
    text = "def rates(y, t, g, l, k, m):\n    s, v = y\n    return v, -g*sin(s/l) - k/m*v\n"
    assert equations(judged(text)) == ["verified"]
    assert equations(judged(text.replace("- k/m*v", "- k/m*v*s"))) != ["verified"]


def test_a_length_can_be_a_part_of_the_canvas() -> None:
    text = """
let a = 1, v = 0, r;
function setup() { r = height/4; }
function draw() {
  acc = -g*sin(a)/r;
  v += acc;
  a += v;
}
"""
    assert equations(judged(text, "JavaScript"))[:1] == ["verified"]
    assert equations(judged(text.replace("/r", "*r*r*r"), "JavaScript"))[:1] != ["verified"]


@pytest.mark.long("other tests reach its code")
def test_an_equation_with_the_step_size_is_not_wrong() -> None:
    text = """
def rates(t, s, m, k, L, g, dt):
    x, y, v, w = s
    r = sqrt(x**2 + y**2)
    return v, w, -k/m*(r - L)*x/r + g*2, -k/m*(r - L)*y/r - g
"""
    assert equations(judged(text)) == ["wrong", "verified"]
    assert equations(judged(text.replace("g*2", "g*dt"))) == ["context", "verified"]


AIR = """
def rates(t, y, g, L, mu):
    theta, omega = y
    return omega, -mu*omega - g/L*sin(theta)
"""


def test_a_friction_can_have_the_letter_of_a_mass() -> None:
    assert equations(judged(AIR)) == ["verified"]
    assert equations(judged(AIR.replace("mu*omega", "mu*theta"))) != ["verified"]


def test_notes_on_what_is_not_read_name_its_function() -> None:
    calls = [f"def g{k}(x):\n    return g{k - 1}(x)\n" for k in range(1, 9)]
    program = (
        f"def g0(x):\n    return -x\n{''.join(calls)}def f(t, y):\n    return [y[1], g8(y[0])]\n"
    )
    (note,) = judged(program).notes
    assert note.startswith("line 20 in f is not read: line 4: calls of g0")
