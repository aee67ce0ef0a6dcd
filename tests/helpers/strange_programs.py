"""Programs of strangers, in the styles of public ones: right and wrong, in several languages."""

#: Accelerations written out, with temporaries, as a function of time and state.
ARRAY_OF_RATES = """
import numpy as np
from numpy import sin, cos
from scipy.integrate import solve_ivp

G, L1, L2 = 9.81, 1.0, 0.7  # lengths in metres
M1 = 2.0
M2 = 1.0


def rates(t, state):
    out = np.zeros_like(state)
    out[0] = state[1]
    d = state[2] - state[0]
    below = (M1 + M2) * L1 - M2 * L1 * cos(d) ** 2
    out[1] = (M2 * L1 * state[1] ** 2 * sin(d) * cos(d)
              + M2 * G * sin(state[2]) * cos(d)
              + M2 * L2 * state[3] ** 2 * sin(d)
              - (M1 + M2) * G * sin(state[0])) / below
    out[2] = state[3]
    below = below * L2 / L1
    out[3] = (-M2 * L2 * state[3] * state[3] * sin(d) * cos(d)
              + (M1 + M2) * G * sin(state[0]) * cos(d)
              - (M1 + M2) * L1 * state[1] * state[1] * sin(d)
              - (M1 + M2) * G * sin(state[2])) / below
    return out


start = np.radians([120.0, 0.0, -10.0, 0.0])
found = solve_ivp(rates, (0, 10), start, method="DOP853")
"""

#: A linear system for the accelerations, and a step of the classical method.
LINEAR_SYSTEM = """
import numpy as np

class Pendulum:
    def __init__(self, m1, m2, l1, l2, g=9.8):
        self.m1, self.m2 = m1, m2
        self.l1 = l1
        self.l2 = l2
        self.g = g
        self.total = m1 + m2
        self.y = np.array([0.1, 0.2, 0.0, 0.0])

    def slope(self, y):
        theta1, theta2, omega1, omega2 = y
        diff = theta1 - theta2
        matrix = np.array([
            [self.total * self.l1, self.m2 * self.l2 * np.cos(diff)],
            [self.l1 * np.cos(diff), self.l2],
        ])
        right = np.array([
            -self.m2 * self.l2 * omega2 ** 2 * np.sin(diff) - self.total * self.g * np.sin(theta1),
            self.l1 * omega1 ** 2 * np.sin(diff) - self.g * np.sin(theta2),
        ])
        alpha1, alpha2 = np.linalg.solve(matrix, right)
        return np.array([omega1, omega2, alpha1, alpha2])

    def step(self, h):
        k1 = self.slope(self.y)
        k2 = self.slope(self.y + h / 2 * k1)
        k3 = self.slope(self.y + h / 2 * k2)
        k4 = self.slope(self.y + h * k3)
        self.y += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
"""

#: Velocities in units of pictures, changed in a drawing function; one of them is damped.
SKETCH = """
let l1 = 150, l2 = 120;
let m1 = 20, m2 = 10;
let g = 1;
let p1, p2, v1 = 0, v2 = 0;

function setup() {
  createCanvas(600, 600);
  p1 = PI / 2;
  p2 = PI / 3;
}

function draw() {
  let d = p1 - p2;
  let below = 2 * m1 + m2 - m2 * cos(2 * d);
  let part1 = -g * (2 * m1 + m2) * sin(p1);
  let part2 = -m2 * g * sin(p1 - 2 * p2);
  let part3 = -2 * sin(d) * m2 * (v2 * v2 * l2 + v1 * v1 * l1 * cos(d));
  let acc1 = (part1 + part2 + part3) / (l1 * below);
  let part4 = v1 * v1 * l1 * (m1 + m2) + g * (m1 + m2) * cos(p1) + v2 * v2 * l2 * m2 * cos(d);
  let acc2 = 2 * sin(d) * part4 / (l2 * below);

  v1 += acc1;
  v2 += acc2;
  p1 += v1;
  p2 += v2;
  v2 *= 0.999;
  line(0, 0, l1 * sin(p1), l1 * cos(p1));
}
"""

#: A class whose angles start in degrees; the coordinates grow by the old velocities.
BROWSER = """
class Model {
  constructor(options) {
    this.a = 45;
    this.b = Math.PI / 2;
    this.va = 0.0;
    this.vb = 0.0;
    const { m1, m2, l1, l2, g } = options;
    Object.assign(this, { m1, m2, l1, l2, g });
  }

  accelerations() {
    const { sin, cos } = Math;
    const d = this.a - this.b;
    const mu = 1 + this.m1 / this.m2;
    const q = mu - Math.pow(Math.cos(d), 2);
    return {
      a: (this.g * (Math.sin(this.b) * Math.cos(d) - mu * Math.sin(this.a))
        - (this.l2 * this.vb ** 2 + this.l1 * this.va ** 2 * Math.cos(d)) * Math.sin(d))
        / (this.l1 * q),
      b: (mu * this.g * (Math.sin(this.a) * Math.cos(d) - Math.sin(this.b))
        + (mu * this.l1 * this.va ** 2 + this.l2 * this.vb ** 2 * Math.cos(d)) * Math.sin(d))
        / (this.l2 * q),
    };
  }

  update(dt) {
    const acc = this.accelerations();
    this.a += this.va * dt;
    this.b += this.vb * dt;
    this.va += acc.a * dt;
    this.vb += acc.b * dt;
    if (this.a > Math.PI) this.a -= 2 * Math.PI;
  }
}
"""

TYPED = """
interface State { theta: number; omega: number; }
const gravity: number = 9.81;
export class Pendulum {
  private state: State = { theta: 0.5, omega: 0 };
  constructor(private readonly length: number) {}
  public advance(h: number): void {
    const s = this.state;
    s.omega = s.omega - (gravity / this.length) * Math.sin(s.theta) * h;
    s.theta = s.theta + s.omega * h;
  }
}
"""

#: Arrays over time.
HISTORY = """
import math
g, L = 9.81, 2.0
dt = 0.01
N = 1000
theta = [math.pi / 4]
omega = [0.0]
for n in range(N):
    alpha = -(g / L) * math.sin(theta[-1])
    omega.append(omega[-1] + alpha * dt)
    theta.append(theta[-1] + omega[-1] * dt)
"""

CART = """
from math import sin, cos

class Cart:
    def __init__(self):
        self.g, self.m, self.M, self.l = 9.8, 0.1, 1.0, 0.5
        self.tau = 0.02
        self.state = (0.0, 0.0, 0.1, 0.0)

    def step(self):
        x, x_dot, theta, theta_dot = self.state
        s, c = sin(theta), cos(theta)
        below = self.M + self.m * s ** 2
        x_acc = self.m * s * (self.l * theta_dot ** 2 + self.g * c) / below
        theta_acc = -(self.m * self.l * theta_dot ** 2 * s * c + (self.M + self.m) * self.g * s) / (
            self.l * below)
        x = x + self.tau * x_dot
        x_dot = x_dot + self.tau * x_acc
        theta = theta + self.tau * theta_dot
        theta_dot = theta_dot + self.tau * theta_acc
        self.state = (x, x_dot, theta, theta_dot)
"""

#: Momenta instead of velocities.
CANONICAL = """
def hamilton(t, y, m, l, g):
    theta, p = y
    return [p / (m * l**2), -m * g * l * sin(theta)]
"""

#: A step of the classical method in loops over entries, with arrays that functions change.
C_PROGRAM = r"""
#include <stdio.h>
#include <math.h>

#define G 9.81
const double m1 = 1.0, m2 = 2.0; /* kg */
static double l1 = 1.0, l2 = 0.5;

void slope(double t, const double *y, double *f)
{
    double d = y[1] - y[0];
    double c = cos(d), s = sin(d);
    double below = m1 + m2 - m2*c*c, upper;

    f[0] = y[2];
    f[1] = y[3];
    upper = m2*l1*pow(y[2], 2)*s*c + m2*G*sin(y[1])*c;
    upper += m2*l2*y[3]*y[3]*s - (m1 + m2)*G*sin(y[0]);
    f[2] = upper/(l1*below);
    f[3] = (-m2*l2*y[3]*y[3]*s*c + (m1 + m2)*(G*sin(y[0])*c - l1*y[2]*y[2]*s - G*sin(y[1])))
        / (l2*below);
}

void step(double t, double h, double y[])
{
    double k1[4], k2[4], k3[4], k4[4], z[4];
    int i;
    slope(t, y, k1);
    for (i = 0; i < 4; i++) z[i] = y[i] + 0.5*h*k1[i];
    slope(t + h/2, z, k2);
    for (i = 0; i < 4; i++) { z[i] = y[i] + 0.5*h*k2[i]; }
    slope(t + h/2, z, k3);
    for (i = 0; i < 4; i++) z[i] = y[i] + h*k3[i];
    slope(t + h, z, k4);
    for (i = 0; i < 4; i++)
        y[i] += h*(k1[i] + 2*k2[i] + 2*k3[i] + k4[i])/6.0;
}

int main(void)
{
    double y[4] = {1.0, 2.0, 0.0, 0.0};
    for (int n = 0; n < 1000; n++) {
        step(n*0.01, 0.01, y);
        printf("%g %g\n", y[0], y[1]);
    }
    return 0;
}
"""

#: A pendulum on a spring: members without `this`, a method outside its class.
CPP_PROGRAM = r"""
#include <cmath>

class Spring {
    double r, theta, vr = 0.0, vtheta = 0.0;
    const double mass_, k_, rest_;
    static constexpr double g = 9.81;
public:
    Spring(double m, double k, double l) : r(l), theta(0.3), mass_(m), k_(k), rest_(l) {}
    void advance(double dt);
    double radial() const { return r*vtheta*vtheta + g*std::cos(theta) - k_/mass_*(r - rest_); }
};

void Spring::advance(double dt)
{
    const double a = radial();
    const double b = -(g*std::sin(theta) + 2.0f*vr*vtheta)/r;
    vr += a*dt;
    vtheta += dt*b;
    this->r += vr*dt;
    theta += vtheta*dt;
}
"""

MATLAB_PROGRAM = """
function pendulum_demo()
  % masses in kg
  m1 = 1; m2 = 2; l1 = 1; l2 = 0.5; g = 9.81;
  y0 = [30; 0; 0; 0];
  options = odeset('RelTol', 1e-8);
  [t, y] = ode45(@(t, y) rates(t, y, m1, m2, l1, l2, g), [0 20], y0, options);
  plot(t, y(:, 1), 'k--');
end

function dydt = rates(~, y, m1, m2, l1, l2, g)
  q = y(1:2);  v = y(3:4);
  d = q(1) - q(2);
  M = [(m1 + m2)*l1, m2*l2*cos(d)
       l1*cos(d),    l2];
  f = [-m2*l2*v(2)^2*sin(d) - (m1 + m2)*g*sin(q(1));  l1*v(1)^2*sin(d) - g*sin(q(2))];
  dydt = [v; M\\f];
end
"""

OCTAVE_PROGRAM = """
# a pendulum, in Octave
g = 9.81; len = 2; h = 0.01; n = 500;
phi = zeros(1, n); w = phi;
phi(1) = pi/3;
for k = 1:n-1
  acc = -(g/len)*sin(phi(k));
  phi(k+1) = phi(k) + h*w(k);
  w(k+1) = w(k) + h*acc;
endfor
"""

FORTRAN_PROGRAM = """
module parameters
  implicit none
  integer, parameter :: dp = kind(1.0d0)
  real(dp), parameter :: g = 9.81_dp, M1 = 1.0d0, m2 = 2.0d0, l1 = 1.d0, l2 = 0.5_dp
end module parameters

program pendulum
  use parameters
  implicit none
  real(dp) :: y(4), k1(4), k2(4), k3(4), k4(4), h, t
  integer :: i
  y = (/ 1.d0, 0.d0, 2.d0, 0.d0 /)
  h = 0.01d0
  t = 0
  do i = 1, 1000
    call Slope(t, y, k1)
    call slope(t + h/2, y + h/2*k1, k2)
    call slope(t + h/2, y + h/2*k2, k3)
    call slope(t + h, y + h*k3, k4)
    y = y + h/6*(k1 + 2*k2 + 2*k3 + k4)
    t = t + h
    write(*, *) t, y(1), y(3)
  end do
contains
  subroutine slope(t, y, dydt)
    real(dp), intent(in) :: t, y(:)
    real(dp), intent(out) :: dydt(4)
    real(dp) :: d, den
    d = y(3) - y(1)
    den = m1 + m2 - m2*COS(d)**2
    dydt(1) = y(2)
    dydt(2) = (m2*l1*y(2)**2*sin(d)*cos(d) + m2*g*sin(y(3))*cos(d) &
            + m2*l2*y(4)**2*dsin(d) - (m1 + m2)*g*sin(y(1)))/(l1*den)
    dydt(3) = y(4)
    dydt(4) = (-m2*l2*y(4)**2*sin(d)*cos(d) &
            + (m1 + m2)*(g*sin(y(1))*cos(d) - l1*y(2)**2*sin(d) - g*sin(y(3))))/(l2*den)
  end subroutine slope
end program pendulum
"""

JULIA_PROGRAM = """
using DifferentialEquations

const g = 9.81

function pendulum!(du, u, p, t)
    (; m1, m2, l1, l2) = p
    θ₁, ω₁, θ₂, ω₂ = u
    Δ = θ₁ - θ₂
    q = 2m1 + m2 - m2 * cos(2Δ)
    du[1] = ω₁
    du[2] = (-g * (2m1 + m2) * sin(θ₁) - m2 * g * sin(θ₁ - 2θ₂) -
             2sin(Δ) * m2 * (ω₂^2 * l2 + ω₁^2 * l1 * cos(Δ))) / (l1 * q)
    du[3] = ω₂
    du[4] = 2sin(Δ) * (ω₁^2 * l1 * (m1 + m2) + g * (m1 + m2) * cos(θ₁) +
             ω₂^2 * l2 * m2 * cos(Δ)) / (l2 * q)
    nothing
end

u0 = [π / 2, 0.0, 120.0, 0.0]
problem = ODEProblem(pendulum!, u0, (0.0, 10.0), (m1 = 1.0, m2 = 1.0, l1 = 1.0, l2 = 1.0))
"""

JULIA_MATRIX = """
function slope(u, p, t)
    m1, m2, l1, l2, g = p
    q, v = u[1:2], u[3:4]
    c = cos(q[1] - q[2]); s = sin(q[1] - q[2])
    M = [(m1 + m2)*l1^2 m2*l1*l2*c; m2*l1*l2*c m2*l2^2]
    C = [0 m2*l1*l2*s*v[2]; -m2*l1*l2*s*v[1] 0]
    G = [(m1 + m2)*g*l1*sin(q[1]), m2*g*l2*sin(q[2])]
    return [v; M \\ (-C*v - G)]
end
"""

#: Steps of Runge and Kutta for each variable.
SCALAR_STEPS = """
import math

def acc1(t1, t2, w1, w2, m1, m2, l1, l2, g):
    above = -g*(2*m1 + m2)*math.sin(t1) - m2*g*math.sin(t1 - 2*t2)
    above -= 2*math.sin(t1 - t2)*m2*(w2**2*l2 + w1**2*l1*math.cos(t1 - t2))
    return above/(l1*(2*m1 + m2 - m2*math.cos(2*t1 - 2*t2)))

def acc2(t1, t2, w1, w2, m1, m2, l1, l2, g):
    above = w1**2*l1*(m1 + m2) + g*(m1 + m2)*math.cos(t1) + w2**2*l2*m2*math.cos(t1 - t2)
    return 2*math.sin(t1 - t2)*above/(l2*(2*m1 + m2 - m2*math.cos(2*t1 - 2*t2)))

def step(t1, t2, w1, w2, h, *p):
    a1, b1 = h*w1, h*w2
    c1, d1 = h*acc1(t1, t2, w1, w2, m1, m2, l1, l2, g), h*acc2(t1, t2, w1, w2, m1, m2, l1, l2, g)
    a2, b2 = h*(w1 + c1/2), h*(w2 + d1/2)
    c2 = h*acc1(t1 + a1/2, t2 + b1/2, w1 + c1/2, w2 + d1/2, m1, m2, l1, l2, g)
    d2 = h*acc2(t1 + a1/2, t2 + b1/2, w1 + c1/2, w2 + d1/2, m1, m2, l1, l2, g)
    t1, t2, w1, w2 = t1 + a2, t2 + b2, w1 + c2, w2 + d2
    return t1, t2, w1, w2
"""

#: A step that depends on a condition, and a force with one of two values.
CONDITIONAL = """
class Model:
    def step(self, action):
        x, v = self.state
        force = self.push if action else -1.0
        kick = 10 if action else -10
        a = (kick - self.k*x)/self.m
        if self.kind == "euler":
            x = x + self.h*v
            v = v + self.h*a
        else:
            v = v + self.h*a
            x = x + self.h*v
        self.state = x, v

    def other(self, t, y):
        if y[0] > 1:
            force = self.push*y[0]
        else:
            force = 0
        return [y[1], force - y[0]]
"""

#: Parts that are not followed.
UNREADABLE = """
def chain(t, y, n):
    theta, omega = y[:n], y[n:]
    a = np.zeros(n)
    for i in order:
        for j in range(n):
            a[i] -= omega[j]**2*sin(theta[i] - theta[j])
    return np.concatenate([omega, a])

def table(t, y):
    return [y[1], lookup(y[0]) - y[1]]

def early(t, y):
    if y[0] > 1:
        return [0, 0]
    return [y[1], -y[0]]

def broken(t, y):
    k = 2 +* 3
    return [y[1], -k*y[0]]

def verlet(x, v, a, h, k):
    x = x + v*h + 0.5*a*h**2
    new = -k*x
    v = v + 0.5*(a + new)*h
    return x, v, new
"""

#: The second acceleration uses the new velocity of the first.
MIXED = """
function step() {
  w1 += h * (-Math.sin(t1) - k * w2);
  w2 += h * (-Math.sin(t2) - k * w1);
  t1 += h * w1;
  t2 += h * w2;
}
"""

JULIA_MACROS = """
function slope(u, p, t)
    @unpack m1, m2, l1, l2, g = p
    (th1, th2, w1, w2) = u
    d = th1 - th2
    M = [(m1+m2)*l1 m2*l2*cos(d); l1*cos(d) l2]
    b = [-m2*l2*w2^2*sin(d) - (m1+m2)*g*sin(th1); l1*w1^2*sin(d) - g*sin(th2)]
    a = M \\ b
    return SA[w1, w2, a[1], a[2]]
end
"""

#: A step of the classical method with functions of entries.
ARRAY_STEPS = """
const slope = ([angle, rate]) => [rate, -g / l * Math.sin(angle)];
const moved = (y, k, h) => y.map((x, i) => x + h * k[i]);

function step(y, h) {
  const k1 = slope(y);
  const k2 = slope(moved(y, k1, h / 2));
  const k3 = slope(moved(y, k2, h / 2));
  const k4 = slope(moved(y, k3, h));
  return y.map((x, i) => x + h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]));
}
"""

#: Fortran in fixed form, and a state that contains parameters.
FIXED_FORM = """
      program pendulum
c     theta = 0
      double precision theta, omega, dt, g
      g = 9.81d0
      dt = 0.01d0
      do i = 1, 100
         omega = omega - g/l*
     &           sin(theta)*dt
         theta = theta + omega*dt
      enddo
      end
"""

STATE_WITH_PARAMETERS = """
function out = rates(t, x)
out = zeros(4, 1);
out(1) = x(2);
out(2) = -x(3)/x(4)*sin(x(1));
end
"""
