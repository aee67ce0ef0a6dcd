"""Programs of several kinds are verified as they stand, and a slip is found at its line."""

import pytest

from derive.reading.programs.program_reader import read_program
from derive.verification.documents.program_judgement import judge_program
from derive.verification.documents.statements import WORD

CHAIN = """
class Chain:
    def rhs(self, t, y):
        n = self.n
        th, om = y[:n], y[n:]
        M, F = np.zeros((n, n)), np.zeros(n)
        for i in range(n):
            F[i] -= self.g * self.l[i] * np.sin(th[i]) * np.sum(self.m[i:])
            for j in range(n):
                mass = sum(self.m[k] for k in range(max(i, j), n))
                M[i, j] = mass * self.l[i] * self.l[j] * np.cos(th[i] - th[j])
                F[i] -= mass * self.l[i] * self.l[j] * np.sin(th[i] - th[j]) * om[j]**2
        return np.hstack([om, np.linalg.solve(M, F)])
"""
LEAPFROG = """
GM, dt = 39.5, 1e-3
def acceleration(r):
    return -GM * r / np.linalg.norm(r)**3
r, v = np.array([1.0, 0.0]), np.array([0.0, 6.3])
a = acceleration(r)
for step in range(1000):
    v = v + 0.5 * dt * a
    r = r + dt * v
    a = acceleration(r)
    v = v + 0.5 * dt * a
    path.append(r.copy())
"""
DRIFTS = """
def step(theta, w, dt, g, l):
    theta = theta + 0.5 * dt * w
    w = w - dt * g / l * sin(theta)
    theta = theta + 0.5 * dt * w
    return theta, w
"""
VERLET = """
g, L, h = 9.81, 1.2, 0.01
theta_old, theta = 0.5, 0.49
for n in range(1000):
    theta_new = 2 * theta - theta_old - g / L * sin(theta) * h**2
    theta_old = theta
    theta = theta_new
"""
EIGEN = """
struct Pendulum {
    double m[2], l[2], g;
    Vector4d operator()(double t, const Vector4d& y) const {
        double c = cos(y(0) - y(1)), s = sin(y(0) - y(1));
        Matrix2d A;
        A << (m[0] + m[1]) * l[0], m[1] * l[1] * c,
             l[0] * c, l[1];
        Vector2d b(-m[1] * l[1] * y(3) * y(3) * s - (m[0] + m[1]) * g * sin(y(0)),
                   l[0] * y(2) * y(2) * s - g * sin(y(1)));
        Vector2d a = A.ldlt().solve(b);
        return Vector4d(y(2), y(3), a(0), a(1));
    }
};
"""
SPRING = """
def rhs(t, y, mass, stiffness, rest_length, gravity):
    r, theta, r_dot, theta_dot = y
    stretch = r - rest_length
    r_ddot = r * theta_dot**2 + gravity * cos(theta) - stiffness / mass * stretch
    return [r_dot, theta_dot, r_ddot, -(gravity * sin(theta) + 2 * r_dot * theta_dot) / r]
"""
JULIA = """
function f(du, u, p, t)
    r, θ, ṙ, ω = u
    m, k, l, g = p
    du[1], du[2] = ṙ, ω
    du[3] = r*ω^2 + g*cos(θ) - k/m*(r - l)
    du[4] = -(2ṙ*ω + g*sin(θ))/r
end
"""
SPHERE = """
def rhs(t, y, g, l):
    theta, phi, w, p = y
    a = sin(theta) * cos(theta) * p**2 - g / l * sin(theta)
    return [w, p, a, -2 * w * p * cos(theta) / sin(theta)]
"""
DRIVEN = """
p = {1.0, 0.5, 1.2, 2/3};
f = @(t, x) [x(2); -gam*x(2) - w0^2*sin(x(1)) + A*cos(wd*t)];
"""
PARTICLES = """
module bodies
  real(8), parameter :: g = 9.81d0
  real(8) :: m(2) = [1.d0, 1.d0], l(2) = [1.d0, 0.5d0]
contains
  subroutine fcn(n, x, y, f)
    real(8) :: x, y(n), f(n), d, den
    d = y(1) - y(2)
    den = m(1) + m(2)*sin(d)**2
    f(1) = y(3)
    f(2) = y(4)
    f(3) = (-m(2)*sin(d)*(l(1)*y(3)**2*cos(d) + l(2)*y(4)**2) &
         - g*((m(1) + m(2))*sin(y(1)) - m(2)*sin(y(2))*cos(d)))/(l(1)*den)
    f(4) = ((m(1) + m(2))*(l(1)*y(3)**2*sin(d) - g*sin(y(2)) + g*sin(y(1))*cos(d)) &
         + m(2)*l(2)*y(4)**2*sin(d)*cos(d))/(l(2)*den)
  end subroutine
end module
"""
METHODS = """
class DoublePendulum:
    def mass_matrix(self, q):
        c = cos(q[0] - q[1])
        return np.array([[(self.m1 + self.m2) * self.l1, self.m2 * self.l2 * c],
                         [self.l1 * c, self.l2]])

    def forces(self, q, w):
        s = sin(q[0] - q[1])
        return np.array([
            -self.m2 * self.l2 * w[1]**2 * s
            - (self.m1 + self.m2) * self.g * sin(q[0]),
            self.l1 * w[0]**2 * s - self.g * sin(q[1])])

    def rhs(self, t, y):
        q, w = y[:2], y[2:]
        return np.concatenate([w, np.linalg.solve(self.mass_matrix(q), self.forces(q, w))])
"""
ORBIT = """
function update(dt) {
  const r = Math.hypot(pos.x, pos.y);
  const ax = -G * M * pos.x / r ** 3;
  const ay = -G * M * pos.y / r ** 3;
  vel.x += ax * dt;
  vel.y += ay * dt;
  pos.x += vel.x * dt;
  pos.y += vel.y * dt;
}
"""
PROGRAMS = {
    "orbit": ("JavaScript", ORBIT, 2),
    "methods": ("Python", METHODS, 2),
    "chain": ("Python", CHAIN, 2),
    "leapfrog": ("Python", LEAPFROG, 2),
    "drifts": ("Python", DRIFTS, 1),
    "verlet": ("Python", VERLET, 1),
    "eigen": ("C++", EIGEN, 2),
    "spring": ("Python", SPRING, 2),
    "julia": ("Julia", JULIA, 2),
    "sphere": ("Python", SPHERE, 2),
    "driven": ("MATLAB", DRIVEN, 1),
    "particles": ("Fortran", PARTICLES, 2),
}
#: A part of a program, the slip in its place, and the line at which it is found.
SLIPS = {
    "power": ("orbit", "pos.x / r ** 3", "pos.x / r ** 2", "const ax"),
    "second line": ("methods", "- (self.m1", "- (2 * self.m1", "- (2 * self.m1 + self.m2)"),
    "index": ("chain", "F[i] -= mass * self.l[i]", "F[i] -= mass * self.l[j]", "F[i] -= mass"),
    "square": ("eigen", "y(2) * y(2) * s", "y(2) * s", "l[0] * y(2)"),
    "sign": ("spring", "= r * theta_dot**2", "= -r * theta_dot**2", "r_ddot ="),
    "lost factor": ("sphere", "sin(theta) * cos(theta) * p", "sin(theta) * p", "a ="),
    "mass": ("particles", "+ m(2)*l(2)*y(4)", "+ m(1)*l(2)*y(4)", "+ m(1)*l(2)*y(4)"),
}


def verdicts(name: str, old: str = "", new: str = "") -> list[tuple[int, str]]:
    language, text, _ = PROGRAMS[name]
    document = judge_program(read_program(text.replace(old, new) if old else text, language))
    formulas = (one for one in document.formulas if one.latex != "method of integration")
    return [(one.line, one.verdict) for one in formulas]


@pytest.mark.long("more cases of the same kind", keep=11)
@pytest.mark.parametrize("name", PROGRAMS)
def test_right_programs_are_verified(name: str) -> None:
    assert [verdict for _, verdict in verdicts(name)] == ["verified"] * PROGRAMS[name][2]


@pytest.mark.long("more cases of the same kind", keep=2)
@pytest.mark.parametrize("slip", SLIPS)
def test_slips_are_found_at_their_lines(slip: str) -> None:
    name, old, new, place = SLIPS[slip]
    text = PROGRAMS[name][1].replace(old, new)
    assert text.count(new) == 1
    line = text[: text.index(place)].count("\n") + 1
    assert {one for one, verdict in verdicts(name, old, new) if verdict == "wrong"} == {line}


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize(("name", "old", "new"), [
    ("methods", "- (self.m1", "+ (self.m1"), ("spring", "+ gravity", "- gravity"),
])  # fmt: skip
def test_a_sign_of_gravity_can_be_wrong_in_either_equation(name: str, old: str, new: str) -> None:
    # with angles from upright, the other equation has the slip
    assert sorted(verdict for _, verdict in verdicts(name, old, new)) == ["context", "verified"]


def test_a_conservative_system_of_its_own_is_not_accused() -> None:
    # V = (x**2 + y**2)/2 + k*(x**2*y + y**3/3) is no potential of Henon and Heiles, but is one
    text = (
        "def f(t, u):\n    x, y, v, w = u\n    return [v, w, -x - 2*k*x*y, -y - k*(x**2 {} y**2)]"
    )
    for sign, second in (("-", "verified"), ("+", "context")):
        document = judge_program(read_program(text.format(sign), "Python"))
        assert [one.verdict for one in document.formulas] == ["verified", second]


def test_loops_over_time_steps_are_not_unrolled() -> None:
    text = VERLET.replace("range(1000)", "range(n)").replace("for n", "for k")
    program = read_program(text, "Python")
    assert [one.text for one in program.equations] == ["theta_ddot = -g/L*sin(theta)"]


HALVES = """
def kick(p, dt):
    a = acceleration(p.x)
    p.v += 0.5 * dt * a
    p.x += dt * p.v
    a = acceleration(p.x)
    p.v += 0.5 * dt * a
def acceleration(x):
    return -k / m * x
for i in range(100):
    kick(body, 0.001)
"""


@pytest.mark.parametrize(
    ("text", "kind"),
    [(LEAPFROG, "leapfrog"), (DRIFTS, "leapfrog"), (HALVES, "leapfrog"), (VERLET, "verlet")],
)
def test_methods_are_named_and_no_fault_is_seen_in_them(text: str, kind: str) -> None:
    findings = read_program(text, "Python").findings
    assert {(one.kind, one.is_fault) for one in findings} == {(kind, False)}


def test_the_exponent_of_a_number_is_no_letter() -> None:
    # a letter e could stand for a force, with which any formula would hold
    assert WORD.findall("e1 + 6.67e-11*m*x_dot + 1.e3*e") == ["e1", "m", "x_dot", "e"]
