"""Forms of programs: their equations are those that a person reads from the same lines."""

import math
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from derive.reading.programs.program import Finding
from derive.reading.programs.program_reader import read_program

MATRICES = r"""
function dx = arm(x, u)
    H = @(q) [a + b*cos(q(2))  c
              c                d];
    V = @(q, w) [0              -b*sin(q(2))*w(1)
                 b*sin(q(2))*w(1)   0];
    P = @(q) [-k*sin(q(1)); -s*sin(q(2))];
    q = x(1:2);
    w = x(3:4);
    dx = [w; H(q)\(P(q) - V(q, w)*w)];
end
"""
LETTERS = r"""
function dx = wheel(x, D, k, tau)
    acc = D\([0, tau]' + [k*sin(x(1)), 0]');
    dx = [x(2), acc(1), x(4), acc(2)]';
end
"""
HALVES = """
while (t < end) {
    r = sqrt(x*x);
    ax = -K*x/(r*r*r);
    xn = x + vx*dt + 0.5*ax*dt*dt;
    r = sqrt(xn*xn);
    axn = -K*xn/(r*r*r);
    vn = vx + 0.5*dt*(ax + axn);
    x = xn;
    vx = vn;
}
"""
#: Each half of the change of a velocity has the value of a function at another time.
KICKS = """
double force(double a) { return -K*a/m; }
void step(double &q, double &p, double h) {
  double middle = p + h/2.0*force(q);
  q = q + h*middle;
  p = middle + h/2.0*force(q);
}
"""
QUOTIENT = """
def rates(s):
    return np.array([s[1], -(g/l)*np.sin(s[0])])
h = 1.0/(pictures*parts)
while True:
    s += h*rates(s)
"""
ROWS = """
function dz = cart(z)
    dz(1,:) = z(2);
    dz(2,:) = [c*z(2) - k*z(1)]/[m + M];
end
"""
COLUMNS = """
def batch(x, u, *, m=1.0):
    r, v = x[:, 0], x[:, 1]
    dx = torch.empty_like(x)
    dx[:, 0] = v
    dx[:, 1] = (u - k * r) / m
    return dx
"""
FILLED = """
def planar(t, y):
    d = np.zeros(4)
    d[0:2] = y[2:4]
    d[2] = -k*y[0]/m
    d[3] = -k*y[1]/m - g
    return d
"""
LIMITS = """
function dx = thrown(x, u)
    top = 5;
    if (u(1) > top), u(1) = top;
    elseif (u(1) < -top), u(1) = -top;
    end
    dx = [x(2); u(1)/max(m, 1e-6) - g];
end
"""
PARTS = """
function draw() {
  f = force(x, y);
  other = force(2*x, 2*y);
  vx += f.x/m*dt;
  vy += f.y/m*dt;
  x += vx*dt;
  y += vy*dt;
}
function force(a, b) {
  F = {x: -k*a, y: -k*b};
  return F;
}
"""
MOMENTUM = """
from numpy import array as vector
r = vector([1, 0])
v = vector([0, 1])
while t < end:
    P = m * v
    P = P + (-k * r) * dt
    r = r + v * dt
    v = P / m
"""
SHARED = """
function one(x, v, h) {
  const rate = (w) => w
  const turn = (a, w) => -(g / L) * Math.sin(a) - b * w
  const p1 = rate(v), q1 = turn(x, v)
  const p2 = rate(v + 0.5*h*q1), q2 = turn(x + 0.5*h*p1, v + 0.5*h*q1)
  const p3 = rate(v + 0.5*h*q2), q3 = turn(x + 0.5*h*p2, v + 0.5*h*q2)
  const p4 = rate(v + h*q3), q4 = turn(x + h*p3, v + h*q3)
  return [x + h/6*(p1 + 2*p2 + 2*p3 + p4), v + h/6*(q1 + 2*q2 + 2*q3 + q4)]
}
for (let i = 0; i < n; i++) { [x, v] = one(x, v, h) }
"""
OBJECT = """
class Model:
    def __init__(self, angle, rate, dt):
        self.state = [angle, rate]
        self.dt = dt
        self.half = dt / 2
"""
HEUN = """
def step(x, v, h):
    a1 = -omega**2 * sin(x)
    v2 = v + h * a1
    a2 = -omega**2 * sin(x + h * v)
    x = x + h / 2 * (v + v2)
    v = v + h / 2 * (a1 + a2)
    return x, v
"""
STAGES = """
program swing
real :: x, v
do i = 1, n
  if (i > 1) then
    x1 = h*v
    v1 = h*(-c*v - g/l*sin(x))
    x2 = h*(v + v1/2)
    v2 = h*(-c*(v + v1/2) - g/l*sin(x + x1/2))
    x3 = h*(v + v2/2)
    v3 = h*(-c*(v + v2/2) - g/l*sin(x + x2/2))
    x4 = h*(v + v3)
    v4 = h*(-c*(v + v3) - g/l*sin(x + x3))
    x = x + (x1 + 2*x2 + 2*x3 + x4)/6
    v = v + (v1 + 2*v2 + 2*v3 + v4)/6
  end if
end do
end program swing
"""
TRANSPOSED = """
function d = f(t, y)
    s = [a b; c e]'*[y(1); y(2)];
    d = [y(3); y(4); s(1); s(2)];
end
"""
#: Programs with their language and their equations, as read by eye.
PROGRAMS = {
    "matrices": (
        MATRICES,
        "MATLAB",
        "(a + b*cos(x_2))*x_1_ddot + c*x_2_ddot = -k*sin(x_1) - (0*x_1_dot"
        " - b*sin(x_2)*x_1_dot*x_2_dot); "
        "c*x_1_ddot + d*x_2_ddot = -s*sin(x_2) - (b*sin(x_2)*x_1_dot*x_1_dot + 0*x_2_dot)",
    ),
    "letters": (
        LETTERS,
        "MATLAB",
        "D_1_1*x_1_ddot + D_1_2*x_3_ddot = k*sin(x_1); D_2_1*x_1_ddot + D_2_2*x_3_ddot = tau + 0",
    ),
    "halves": (HALVES, "C++", "x_ddot = -K*x/(sqrt(x*x)*sqrt(x*x)*sqrt(x*x))"),
    "kicks": (KICKS, "C++", "q_ddot = -K*q/m"),
    "quotient": (QUOTIENT, "Python", "s_0_ddot = -g/l*sin(s_0)"),
    "rows": (ROWS, "MATLAB", "z_1_ddot = (c*z_1_dot - k*z_1)/(m + M)"),
    "columns": (COLUMNS, "Python", "r_ddot = (u - k*r)/m"),
    "filled": (FILLED, "Python", "y_0_ddot = -k*y_0/m; y_1_ddot = -k*y_1/m - g"),
    "limits": (LIMITS, "MATLAB", "x_1_ddot = u_1/m - g"),
    "parts": (PARTS, "JavaScript", "x_ddot = -k*x/m; y_ddot = -k*y/m"),
    "momentum": (MOMENTUM, "Python", "r_0_ddot = -k*r_0/m; r_1_ddot = -k*r_1/m"),
    "transposed": (
        TRANSPOSED,
        "MATLAB",
        "y_1_ddot = a*y_1 + c*y_2; y_2_ddot = b*y_1 + e*y_2",
    ),
    "shared": (SHARED, "JavaScript", "x_ddot = -g/L*sin(x) - b*x_dot"),
    "object": (OBJECT, "Python", ""),
    "Heun": (HEUN, "Python", "x_ddot = -omega**2*sin(x)"),
    "stages": (STAGES, "Fortran", "x_ddot = -c*x_dot - g/l*sin(x)"),
}


def methods(text: str, language: str) -> list[Finding]:
    found = read_program(text, language).findings
    return [one for one in found if one.kind in ("runge_kutta", "mixed_update")]


@pytest.mark.parametrize("name", PROGRAMS)
def test_equations_are_those_that_a_person_reads(name: str) -> None:
    text, language, expected = PROGRAMS[name]
    assert "; ".join(one.text for one in read_program(text, language).equations) == expected


def test_stages_without_functions_have_the_coefficients_of_a_method() -> None:
    # the order follows from the conditions on the coefficients
    right = methods(STAGES, "Fortran") + methods(HEUN, "Python")
    assert [(one.is_fault, one.text.split(" is ")[0][-7:]) for one in right] == [
        (False, "order 4"),
        (False, "order 2"),
    ]
    for old, new in (("2*v2 + 2*v3", "v2 + 2*v3"), ("1/2", "1")):
        assert any(one.is_fault for one in methods(STAGES.replace(old, new), "Fortran"))


def test_wrong_weights_of_a_method_are_stated() -> None:
    text = """
f = @(s) [s(2); -g/L*sin(s(1))]';
k = zeros(4, 2);
for i = 2:n
    k(1, :) = f(s(i-1, :));
    k(2, :) = f(s(i-1, :) + h/2*k(1, :));
    k(3, :) = f(s(i-1, :) + h/2*k(2, :));
    k(4, :) = f(s(i-1, :) + h*k(3, :));
    s(i, :) = s(i-1, :) + h/6*(k(1, :) + 2*k(2, :) + 2*k(3, :) + k(4, :));
end
"""
    assert [one.is_fault for one in methods(text, "MATLAB")] == [False]
    (wrong,) = methods(text.replace("h/6*(", "h/6*").replace("k(4, :));", "k(4, :);"), "MATLAB")
    assert wrong.is_fault
    assert "weights 0.1667, 2, 2, 1," in wrong.text
    (halved,) = methods(text.replace("h/6", "h/12"), "MATLAB")
    assert "weights 0.08333, 0.1667, 0.1667, 0.08333," in halved.text


def test_stages_change_the_state_and_not_the_rate() -> None:
    text = """
while t < end:
    a1 = -g/l*sin(x)
    a2 = -g/l*sin(x) - 0.5*a1
    a3 = -g/l*sin(x) - 0.5*a2
    a4 = -g/l*sin(x) - a3
    v = v + dt/6*(a1 + 2*(a2 + a3) + a4)
    x = x + v*dt
"""
    (wrong,) = methods(text, "Python")
    assert wrong.is_fault
    assert wrong.line == 4


def test_a_half_of_leapfrog_has_all_of_a_position_at_one_time() -> None:
    text = """
for _ in range(n):
    r = sqrt(x**2 + y**2)
    u -= 0.5*dt*K*x/r**3
    v -= 0.5*dt*K*y/r**3
    x += u*dt
    y += v*dt
    AGAIN
    u -= 0.5*dt*K*x/r**3
    v -= 0.5*dt*K*y/r**3
"""
    right = text.replace("AGAIN", "r = sqrt(x**2 + y**2)")
    assert not methods(right, "Python")
    old = [(one.line, one.is_fault) for one in methods(text.replace("AGAIN", "pass"), "Python")]
    assert old == [(9, True), (10, True)]


@pytest.mark.parametrize(("first", "second", "is_whole"), [
    ("x += v*h/4", "x += 3*v*h/4", True),
    ("x += 1.5*v*h", "x -= 0.5*v*h", True),
    ("x += 0.25*v*h", "x += 0.5*v*h", False),
    ("x += 0.25*v*h", "x += 0.75*v*s", False),
])  # fmt: skip
def test_parts_of_a_step_add_up_to_it(first: str, second: str, is_whole: bool) -> None:
    text = f"while t < 9:\n    {first}\n    v += -k*x*h\n    {second}\n"
    assert (equations(text, "Python") == ["x_ddot = -k*x"]) == is_whole


def test_a_limit_of_0_is_that_of_a_contact() -> None:
    text = "def f(t, y, k):\n    x, v = y\n    return v, -k*max(x, 0)\n"
    assert not read_program(text, "Python").equations
    assert read_program(text.replace("0)", "1e-9)"), "Python").equations


def test_a_small_limit_only_keeps_a_denominator_from_zero() -> None:
    text = "def f(t, y, k, m, l):\n    x, v = y\n    return v, -k*x/max(m*l**2, LIMIT)\n"
    (equation,) = read_program(text.replace("LIMIT", "1e-4"), "Python").equations
    assert equation.text == "x_ddot = -k*x/(m*l**2)"
    assert not read_program(text.replace("LIMIT", "0.5"), "Python").equations


@pytest.mark.parametrize(
    "change", ["v += a*dt\n    x += v*dt", "dv = a*dt\n    v += dv\n    dx = v*dt\n    x += dx"]
)
def test_changes_can_have_names(change: str) -> None:
    text = f"x, v = 1.0, 0.0\nwhile x > 0:\n    a = -k*x/m\n    {change}\n"
    assert [one.text for one in read_program(text, "Python").equations] == ["x_ddot = -k*x/m"]


def test_a_velocity_can_be_damped_after_its_change() -> None:
    text = """
class Swing {
    update() {
        this.acc = (-this.g / this.l) * Math.sin(this.angle);
        this.rate = (this.rate + this.acc) * this.damping;
        this.angle += this.rate;
    }
}
"""
    program = read_program(text, "JavaScript")
    assert [one.text for one in program.equations] == ["angle_ddot = -g/l*sin(angle)"]
    assert "damping" in [one.kind for one in program.findings]


PROPERTY = {
    "Python": """
class Swing:
    @property
    def acc(self):
        return -self.g/self.l*np.sin(self.angle)

    def step(self, dt):
        self.rate += self.acc*dt
        self.angle += self.rate*dt
""",
    "TypeScript": """
class Swing {
    get acc(): number {
        return -this.g / this.l * Math.sin(this.angle);
    }
    step(): void {
        this.rate += this.acc * this.dt;
        this.angle += this.rate * this.dt;
    }
}
""",
}


@pytest.mark.parametrize("language", PROPERTY)
def test_properties_have_the_values_of_their_functions(language: str) -> None:
    program = read_program(
        PROPERTY[language], "JavaScript" if language == "TypeScript" else language
    )
    assert [one.text for one in program.equations] == ["angle_ddot = -g/l*sin(angle)"]


def test_a_property_with_a_variable_of_its_own_has_its_value() -> None:
    text = PROPERTY["Python"].replace("return", "k = self.g/self.l\n        return")
    text = text.replace("-self.g/self.l*", "-k*")
    assert equations(text, "Python") == ["angle_ddot = -g/l*sin(angle)"]
    stored = text.replace("k = ", "self.k = ").replace("-k*", "-self.k*")
    assert equations(stored, "Python") == ["angle_ddot = acc"]  # its call changes the object


def test_functions_can_be_passed_by_their_names() -> None:
    text = """
def dx(x, v):
    return v

def dv(x, v):
    return -k*x

def step(x, v, dx, dv, h):
    k1, l1 = dx(x, v)*h, dv(x, v)*h
    k2, l2 = dx(x + k1/2, v + l1/2)*h, dv(x + k1/2, v + l1/2)*h
    k3, l3 = dx(x + k2/2, v + l2/2)*h, dv(x + k2/2, v + l2/2)*h
    k4, l4 = dx(x + k3, v + l3)*h, dv(x + k3, v + l3)*h
    x += (k1 + 2*k2 + 2*k3 + k4)/6
    v += (l1 + 2*l2 + 2*l3 + l4)/6
    return x, v
"""
    program = read_program(text, "Python")
    assert [one.text for one in program.equations] == ["x_ddot = -k*x"]


@pytest.mark.parametrize("first", ["60", "1.0"])
def test_a_default_in_degrees_can_be_replaced_by_a_converted_angle(first: str) -> None:
    text = f"""
class Swing:
    def __init__(self):
        self.angle = {first}
        self.rate = 0.0

    def read(self):
        self.angle = math.radians(float(input()))

    def step(self, dt):
        self.rate -= self.g/self.l*math.sin(self.angle)*dt
        self.angle += self.rate*dt
"""
    faults = [
        one.is_fault for one in read_program(text, "Python").findings if one.kind == "degrees"
    ]
    assert faults == [False] * (first == "60")
    always = text.replace("math.radians(float(input()))", "float(input())")
    faults = [
        one.is_fault for one in read_program(always, "Python").findings if one.kind == "degrees"
    ]
    assert faults == [True] * (first == "60")


@pytest.mark.parametrize(("first", "second", "is_fault"), [
    ("v += dt*(g - k*v**2)", "pos += v*dt", False),
    ("v += dt*(g - k*v**2)", "pos += v", True),
    ("v += dt*g - k*v", "pos += v", False),  # friction of a frame
])  # fmt: skip
def test_a_step_size_belongs_to_both_updates(first: str, second: str, is_fault: bool) -> None:
    text = f"pos, v = 1.0, 0.0\nwhile pos > 0:\n    {first}\n    {second}\n"
    faults = [one for one in read_program(text, "Python").findings if one.is_fault]
    assert [one.kind for one in faults] == ["lost_step"] * is_fault


@pytest.mark.parametrize("limited", ["min(max(u, low), high)", "max(min(u, high), low)"])
def test_a_value_between_two_limits_is_the_value(limited: str) -> None:
    text = f"def f(t, y, u, m, low, high):\n    x, v = y\n    return v, {limited}/m\n"
    assert [one.text for one in read_program(text, "Python").equations] == ["x_ddot = u/m"]
    other = text.replace("min", "max")
    assert not read_program(other, "Python").equations


def test_a_velocity_can_change_by_a_factor_alone() -> None:
    text = "pos, v = 1.0, 2.0\nwhile pos > 0:\n    v *= 0.99\n    pos += v\n"
    findings = read_program(text, "Python").findings
    assert "damping" in [one.kind for one in findings]
    assert not any(one.is_fault for one in findings)


def test_unknowns_can_stand_in_rows_of_a_column() -> None:
    text = """
for i in range(n):
    A = np.array([[m + M, m*l*cos(a[i])], [cos(a[i]), l]])
    [[acc], [turn]] = np.linalg.solve(A, np.array([[m*l*w[i]**2*sin(a[i])], [-g*sin(a[i])]]))
    x[i + 1] = x[i] + v[i]*h
    a[i + 1] = a[i] + w[i]*h
    v[i + 1] = v[i] + acc*h
    w[i + 1] = w[i] + turn*h
"""
    assert [one.text for one in read_program(text, "Python").equations] == [
        "(m + M)*x_ddot + m*l*cos(a)*a_ddot = m*l*a_dot**2*sin(a)",
        "cos(a)*x_ddot + l*a_ddot = -g*sin(a)",
    ]


def test_a_function_of_time_that_is_passed_is_a_load() -> None:
    text = "function f(du, u, p, t)\n  du[1] = u[2]\n  du[2] = -k*u[1] + p(t)\nend\n"
    assert [one.text for one in read_program(text, "Julia").equations] == ["u_1_ddot = -k*u_1 + p"]


def test_a_loop_in_a_loop_of_the_same_variable_is_followed() -> None:
    text = """
void step() {
  for (int i = 0; i < 2; ++i) {
    for (int i = 0; i < 2; ++i) { a[i] = -k*x[i]/m; }
    v[i] += a[i]*dt;
    x[i] += v[i]*dt;
  }
}
"""
    read_program(text, "C")


@pytest.mark.parametrize("force", ["-k*x", "-k*new", "-x", "-k*x/m", "k*x", "-k*sin(x)"])
def test_new_values_can_replace_the_old_ones_at_the_end(force: str) -> None:
    text = f"while s < 9:\n    new = x + h*v\n    w = v + h*({force})\n    x = new\n    v = w\n"
    program = read_program(text, "Python")
    assert [one.text for one in program.equations] == [f"x_ddot = {force.replace('new', 'x')}"]
    kind = "semi_implicit_euler" if "new" in force else "explicit_euler"
    assert [one.kind for one in program.findings] == [kind]


VPYTHON = """
from vpython import *
sun = sphere(radius=0.1, color=color.yellow, mass=1)
earth = sphere(pos=vector(1, 0, 0), mass=2, p=vector(0, 3, 0))
dt = 0.1
while True:
    r = earth.pos - sun.pos
    F = -G*sun.mass*earth.mass*norm(r)/mag(r)**2
    earth.p = earth.p + F*dt
    earth.pos = earth.pos + earth.p/earth.mass*dt
"""


@pytest.mark.parametrize(
    ("norm", "power"),
    [("norm(r)", 2), ("r.hat", 2), ("r.norm()", 2), ("r/r.mag", 2), ("r", 3)],
)
def test_bodies_of_vpython_have_vectors(norm: str, power: int) -> None:
    text = VPYTHON.replace("norm(r)", norm).replace("**2", f"**{power}")
    for one in read_program(text, "Python").equations:
        left, _, right = one.text.partition(" = ")
        x = [f"pos_{i}" for i in range(3)]
        value = eval(right, {"sqrt": math.sqrt, "G": 5.0, "mass": 7.0, "earth_mass": 2.0, x[0]: 1.0,
                             x[1]: 2.0, x[2]: 2.0})  # fmt: skip
        assert value == pytest.approx(-5 * 7 * {x[0]: 1, x[1]: 2, x[2]: 2}[left[:5]] / 27)
    assert len(read_program(text, "Python").equations) == 3


def test_the_square_of_the_length_of_a_vector_has_a_function() -> None:
    text = "from vpython import *\nx, v = vector(1, 2, 3), vector(1, 1, 2)\nwhile t < 3:\n"
    text += "    v = v - k*x*mag2(x)*dt\n    x = x + v*dt\n"
    assert equations(text, "Python") == [
        f"x_{i}_ddot = -k*x_{i}*(x_0**2 + x_1**2 + x_2**2)" for i in range(3)
    ]


def test_zeros_of_a_constant_vector_are_numbers() -> None:
    text = """
g = vector(0, -9.8, 0)
while t < 3:
    v = v + (g - k*x)*dt
    x = x + v*dt
"""
    text = "x, v = vector(1, 2, 3), vector(1, 1, 2)\n" + text
    found = [one.text for one in read_program(text, "Python").equations]
    assert found == ["x_0_ddot = -k*x_0", "x_1_ddot = g_1 - k*x_1", "x_2_ddot = -k*x_2"]


def test_a_momentum_is_divided_by_its_mass() -> None:
    text = "while t < 3:\n    p = p - k*x*dt\n    x = x + p/m*dt\n"
    assert [one.text for one in read_program(text, "Python").equations] == ["x_ddot = -k*x/m"]


ORBIT = """
r, v, h = np.array([1.0, 0.5]), np.array([0.0, 1.0]), 0.01
def orbit(r, v, h):
    for i in range(100):
        middle = r + v*h/2
        v += -k*middle/np.linalg.norm(middle)**3*h
        r = middle + v*h/2
        places.append(r)
    return r
orbit(r, v, h)
"""


def test_calls_give_the_lengths_of_vectors() -> None:
    program = read_program(ORBIT + "orbit(start, speed, h)\n", "Python")
    expected = [f"r_{i}_ddot = -k*r_{i}/sqrt(r_0**2 + r_1**2)**3" for i in (0, 1)]
    assert [one.text for one in program.equations] == expected
    assert not program.unread  # the loop is read by itself
    method = read_program(ORBIT.replace("np.linalg.norm(middle)", "middle.norm()"), "Python")
    assert [one.text for one in method.equations] == expected
    unknown = ORBIT.replace("np.linalg.norm(middle)", "h.norm()")  # of a number
    assert not read_program(unknown, "Python").equations
    other = ORBIT + "r = np.array([1.0, 0.5, 2.0])\norbit(r, r, h)\n"
    assert not read_program(other, "Python").equations


def test_an_array_with_an_entry_for_each_time_is_no_vector() -> None:
    text = """
def rate(y, t):
    return np.array([y[1], -k*y[0]])
def solved(y, t, n):
    for i in range(n):
        a = rate(y[i], t[i])
        b = rate(y[i] + h/2*a, t[i] + h/2)
        y[i+1] = y[i] + h*b
    return y
y = solved(np.array([[1.0, 0.0], [0.0, 0.0]]), times, 1)
"""
    (midpoint,) = methods(text, "Python")
    assert "order 2" in midpoint.text
    assert not read_program(text, "Python").unread


def test_a_loop_of_verlet_steps_is_read_by_itself() -> None:
    text = """
def positions(x, n):
    for i in range(1, n):
        x[i+1] = 2*x[i] - x[i-1] - k*x[i]*h**2
    return x
"""
    program = read_program(text, "Python")
    assert [one.text for one in program.equations] == ["x_ddot = -k*x"]
    assert not program.unread


def test_values_can_be_kept_for_the_next_time() -> None:
    text = """
for i in range(n - 1):
    v[i+1] = v[i] - k*x[i]/d[i]**3*h
    x[i+1] = x[i] + v[i+1]*h
    d[i+1] = sqrt(x[i+1]**2 + a**2)
"""
    (equation,) = read_program(text, "Python").equations
    assert equation.text == "x_ddot = -k*x/sqrt(x**2 + a**2)**3"


def equations(text: str, language: str) -> list[str]:
    return [one.text for one in read_program(text, language).equations]


def test_a_velocity_can_be_damped_before_its_change() -> None:
    text = "while (true) {\n  v *= c;\n  v += -k*x;\n  x += v;\n}\n"
    assert equations(text, "JavaScript") == ["x_ddot = -k*x"]


@pytest.mark.parametrize(("value", "expected"), [
    ("a{-k*x/m}", ["x_ddot = -k*x/m"]), ("a[1]{-k/m}", ["x_0_ddot = -k/m"]),
])  # fmt: skip
def test_a_value_in_braces_is_no_array(value: str, expected: list[str]) -> None:
    text = f"void step() {{\n  double {value};\n  v += a*h;\n  x += v*h;\n}}\n"
    assert equations(text, "C++") == expected


def test_a_word_of_fixed_form_can_be_continued() -> None:
    text = """
      program spring
      do while (t < 9)
        v = v - k*x*del
     1ta
        x = x + v*delta
      end do
      end program spring
"""
    assert equations(text, "Fortran 77") == ["x_ddot = -k*x"]
    apart = text.replace("del\n     1ta", "delta\n     1 - 3")
    assert equations(apart, "Fortran 77") == ["x_ddot = (-k*x*delta - 3)/delta"]


@pytest.mark.parametrize("types", ["{T<:Number}", "{S, T}", "T"])
def test_types_of_parameters_convert_numbers(types: str) -> None:
    text = f"function f(u::Vector{{T}}, k) where {types}\n    [u[2], -T(2.0)*k*u[1]]\nend\n"
    assert equations(text, "Julia") == ["u_1_ddot = -2.0*k*u_1"]
    assert not equations(text.replace("T(2.0)", "R(2.0)"), "Julia")


@pytest.mark.parametrize(("name", "meaning"), [
    ("tempo", "t"), ("sim_time", "t"), ("self.tempo", "t"), ("theta", "theta"), ("phase", "phase"),
])  # fmt: skip
def test_a_variable_that_grows_by_the_step_size_is_the_time(name: str, meaning: str) -> None:
    text = "while run:\n    t0 += dt\n    v += (sin(w*t0) - k*x)*dt\n    x += v*dt\n"
    text = text.replace("t0", name)
    assert equations(text, "Python") == [f"x_ddot = sin(w*{meaning}) - k*x"]
    faster = text.replace(f"{name} += dt", f"{name} += 2*dt")
    assert equations(faster, "Python") == [f"x_ddot = sin(w*{name.removeprefix('self.')}) - k*x"]


def test_parameters_can_state_accelerations() -> None:
    text = "function f(ddu, du, u, p, t)\n    ddu[1] = -k*u[2]\n    ddu[2] = -k*u[1]\nend\n"
    other = "function g(y)\n    [y[2], -q*y[1]]\nend\n"
    assert equations(text + other, "Julia") == [
        "u_1_ddot = -k*u_2", "u_2_ddot = -k*u_1", "y_1_ddot = -q*y_1",
    ]  # fmt: skip
    first_order = text.replace("ddu, du, u", "dw, du, u").replace("ddu", "dw")
    assert equations(first_order, "Julia") == ["u_1_dot = -k*u_2", "u_2_dot = -k*u_1"]


def test_accelerations_in_arrays_are_known_by_their_names() -> None:
    text = "function f(p, x, dx, ddx)\n    ddx[1] = -k*x[1] - c*dx[1]\nend\n"
    assert equations(text, "Julia") == ["x_1_ddot = -k*x_1 - c*x_1_dot"]


COUPLED = """
def acceleration(t, x):
    return -k*x/m
def velocity(t, v):
    return v
def step(x, v, t, h):
    a1 = h*acceleration(t, x)
    b1 = h*velocity(t, v)
    a2 = h*acceleration(t + h/2, x + b1/2)
    b2 = h*velocity(t + h/2, v + a1/2)
    a3 = h*acceleration(t + h/2, x + b2/2)
    b3 = h*velocity(t + h/2, v + a2/2)
    a4 = h*acceleration(t + h, x + b3)
    b4 = h*velocity(t + h, v + a3)
    x = x + (b1 + 2*b2 + 2*b3 + b4)/6
    v = v + (a1 + 2*a2 + 2*a3 + a4)/6
    return x, v
"""


def test_rates_are_added_to_their_own_variables() -> None:
    assert not any(one.is_fault for one in methods(COUPLED, "Python"))

    def exchanged(term: re.Match[str]) -> str:
        return f"{term[1]} + {'ba'[term[1] == 'x']}{term[2]}"

    slip = re.sub(r"([xv]) \+ [ab](\d)", exchanged, COUPLED)
    assert [one.text for one in methods(slip, "Python") if one.is_fault] == [
        "stages add rates to other variables: those of x to v, those of v to x",
    ]


BALLS = "".join(f"{one}.pos = vector(1, 0, 0)\n{one}.v = vector(0, 1, 0)\n" for one in "abcdef")
BALLS += "while t < 9:\n" + "".join(
    f"    {one}.v = {one}.v - k*{one}.pos*dt\n    {one}.pos = {one}.pos + {one}.v*dt\n"
    for one in "abcdef"
)
ROOT = Path(__file__).parents[2]
READING = """
import sys
from derive.reading.programs.program_reader import read_program
print([one.text for one in read_program(sys.argv[1], "Python").equations])
"""


def test_names_do_not_depend_on_the_hash_seed() -> None:
    equations = {
        subprocess.run(
            [sys.executable, "-c", READING, BALLS],
            env=os.environ | {"PYTHONHASHSEED": seed, "PYTHONPATH": str(ROOT)},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for seed in "123"
    }
    assert len(equations) == 1
    assert equations.pop().count("_ddot") == 18
