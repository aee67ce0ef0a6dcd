"""Forms of programs: their equations are those that a person reads from the same lines."""

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
    "shared": (SHARED, "JavaScript", "x_ddot = -g/L*sin(x) - b*x_dot"),
    "object": (OBJECT, "Python", ""),
}


def methods(text: str, language: str) -> list[Finding]:
    found = read_program(text, language).findings
    return [one for one in found if one.kind in ("runge_kutta", "mixed_update")]


@pytest.mark.parametrize("name", PROGRAMS)
def test_equations_are_those_that_a_person_reads(name: str) -> None:
    text, language, expected = PROGRAMS[name]
    assert "; ".join(one.text for one in read_program(text, language).equations) == expected


def test_weights_without_brackets_lack_the_step_size() -> None:
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
