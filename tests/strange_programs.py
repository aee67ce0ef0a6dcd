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
