"""Programs of Java, Go and Rust in the habits of public ones."""

#: Fields without their object, casts, and a constructor whose parameters hide fields.
FIELDS = """
package simulation;

import static java.lang.Math.*;

/** Two masses on rods. */
public class DoublePendulum implements Runnable {
    private static final double G = 9.81;
    private final double m1, m2, l1, l2;
    private double a1 = Math.PI / 2, a2 = Math.toRadians(100), a1Velocity, a2Velocity;

    public DoublePendulum(double m1, double m2, double l1, double l2) {
        this.m1 = m1;
        this.m2 = m2;
        this.l1 = l1;
        this.l2 = l2;
    }

    @Override
    public void run() {
        while (true) {
            step(0.001d);
            if (Thread.interrupted()) break;
        }
    }

    void step(double dt) {
        double num1 = -G * (2 * m1 + m2) * Math.sin(a1);
        double num2 = -m2 * G * Math.sin(a1 - 2 * a2);
        double num3 = -2 * Math.sin(a1 - a2) * m2;
        double num4 = Math.pow(a2Velocity, 2) * l2 + a1Velocity * a1Velocity * l1 * cos(a1 - a2);
        final double den = 2 * m1 + m2 - m2 * Math.cos(2 * a1 - 2 * a2);
        double a1Acceleration = (num1 + num2 + num3 * num4) / (l1 * den);
        num1 = 2 * Math.sin(a1 - a2);
        num2 = a1Velocity * a1Velocity * l1 * (m1 + m2);
        num3 = G * (m1 + m2) * Math.cos(a1);
        num4 = a2Velocity * a2Velocity * l2 * m2 * Math.cos(a1 - a2);
        double a2Acceleration = num1 * (num2 + num3 + num4) / (l2 * den);
        a1Velocity += (double) (a1Acceleration * dt);
        a2Velocity += a2Acceleration * dt;
        a1 += a1Velocity * dt;
        a2 += a2Velocity * dt;
    }
}
"""

#: An interface, a static method that returns rates, and stages with loops over their entries.
STAGES = """
interface Rates { double[] of(double t, double[] y); }

final class CartPole {
    static final double G = 9.81, M = 1.0, m = 0.1, l = 0.5;

    static double[] rates(double t, double[] y) {
        double x = y[0], v = y[1]; // of the cart
        final double theta = y[2];
        final double s = Math.sin(theta), c = Math.cos(theta);
        double total = M + m * s * s;
        double[] dydt = new double[y.length];
        dydt[0] = y[1];
        dydt[1] = m * s * (l * y[3] * y[3] + G * c) / total;
        dydt[2] = y[3];
        dydt[3] = -(m * l * y[3] * y[3] * s * c + (M + m) * G * s) / (l * total);
        return dydt;
    }

    private static double[] moved(double[] y, double[] k, double h) {
        double[] result = new double[y.length];
        for (int i = 0; i < y.length; i++) {
            result[i] = y[i] + h * k[i];
        }
        return result;
    }

    public static void main(String[] args) {
        double[] y = {0, 0, 0.5, 0};
        double t = 0, h = 1e-3;
        for (int n = 0; n < 1000; n++) {
            double[] k1 = rates(t, y);
            double[] k2 = rates(t + h / 2, moved(y, k1, h / 2));
            double[] k3 = rates(t + h / 2, moved(y, k2, h / 2));
            double[] k4 = rates(t + h, moved(y, k3, h));
            for (int i = 0; i < y.length; i++) {
                y[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
            }
            t += h;
        }
    }
}
"""

#: A sketch of Processing, with conversions, a colour, and conditions without brackets.
SKETCH = """
Bob bob;
color back = #102030;
int side;

void setup() {
  size(640, 360);
  bob = new Bob(float(175), PI / 3);
}

void draw() {
  background(back);
  bob.update(1.0 / frameRate);
  line(0, 0, bob.r * sin(bob.angle), bob.r * cos(bob.angle));
}

class Bob {
  float r, angle;
  float rVelocity = 0.0f, angleVelocity;
  float mass = 2, stiffness = 40, restLength = 150, gravity = 9.81;

  Bob(float r_, float angle_) {
    r = r_;
    angle = angle_;
  }

  void update(float dt) {
    float stretch = r - restLength;
    float rAcceleration = r * sq(angleVelocity) + gravity * cos(angle) - stiffness / mass * stretch;
    float angleAcceleration = (-gravity * sin(angle) - 2 * rVelocity * angleVelocity) / r;
    rVelocity += rAcceleration * dt;
    angleVelocity += angleAcceleration * dt;
    if (rVelocity > 0) side = 1;
    else if (rVelocity < 0) side = 2;
    else side = 0;
    r += rVelocity * dt;
    angle += angleVelocity * dt;
  }
}
"""

#: Methods with a receiver, a group of constants, and several variables in one assignment.
RECEIVERS = """
package main

import "math"

const (
	g, dt = 9.81, 0.01
	steps = 1000
)

// Cart is a cart with a pendulum.
type Cart struct {
	M, m, l             float64
	X, Theta, V, Omega  float64
	trace               []float64
}

func NewCart(theta float64) *Cart {
	return &Cart{M: 1, m: 0.5, l: 2, Theta: theta}
}

func (c *Cart) accelerations() (float64, float64) {
	sin, cos := math.Sincos(c.Theta)
	total := c.M + c.m*math.Pow(sin, 2)
	a := c.m * sin * (c.l*c.Omega*c.Omega + g*cos) / total
	return a, -(g*sin + a*cos) / c.l
}

func (c *Cart) Step() {
	a, alpha := c.accelerations()
	c.V, c.Omega = c.V+a*dt, c.Omega+alpha*dt
	c.X += c.V * dt
	c.Theta += c.Omega * dt
	c.trace = append(c.trace, c.Theta)
}

func main() {
	c := NewCart(math.Pi / 3)
	for i := 0; i < steps; i++ {
		c.Step()
	}
}
"""

#: A closure over parameters returns rates; slices are combined with range.
CLOSURE = """
package main

import (
	"fmt"
	"math"
)

type Params struct{ m1, m2, l1, l2, g float64 }

func equations(p Params) func(t float64, y []float64) []float64 {
	return func(t float64, y []float64) []float64 {
		th1, th2, w1, w2 := y[0], y[1], y[2], y[3]
		d := th1 - th2
		den := p.m1 + p.m2*math.Pow(math.Sin(d), 2)
		a1 := (-p.m2*math.Sin(d)*(p.l1*w1*w1*math.Cos(d)+p.l2*w2*w2) -
			p.g*((p.m1+p.m2)*math.Sin(th1)-p.m2*math.Sin(th2)*math.Cos(d))) / (p.l1 * den)
		inner := p.l1*w1*w1*math.Sin(d) - p.g*math.Sin(th2) + p.g*math.Sin(th1)*math.Cos(d)
		a2 := ((p.m1+p.m2)*inner +
			p.m2*p.l2*w2*w2*math.Sin(d)*math.Cos(d)) / (p.l2 * den)
		return []float64{w1, w2, a1, a2}
	}
}

func rk4(f func(float64, []float64) []float64, t, h float64, y []float64) []float64 {
	add := func(y, k []float64, h float64) []float64 {
		out := make([]float64, len(y))
		for i, v := range y {
			out[i] = v + h*k[i]
		}
		return out
	}
	k1 := f(t, y)
	k2 := f(t+h/2, add(y, k1, h/2))
	k3 := f(t+h/2, add(y, k2, h/2))
	k4 := f(t+h, add(y, k3, h))
	next := make([]float64, len(y))
	for i := range y {
		next[i] = y[i] + h/6*(k1[i]+2*k2[i]+2*k3[i]+k4[i])
	}
	return next
}

func main() {
	f := equations(Params{m1: 1, m2: 1, l1: 1, l2: 1, g: 9.81})
	y := []float64{1, 0.5, 0, 0}
	for t := 0.0; t < 10; t += 0.01 {
		y = rk4(f, t, 0.01, y)
	}
	fmt.Println(y)
}
"""

#: Two accelerations as a pair with names, and a state as a literal of a struct.
PAIRS = """
package main

import "math"

type Spring struct {
	M, K, L, G float64
}

type State struct{ r, phi, vr, vphi float64 }

func (s Spring) accelerations(x State) (ar, aphi float64) {
	ar = x.r*x.vphi*x.vphi - s.K/s.M*(x.r-s.L) + s.G*math.Cos(x.phi)
	aphi = -(s.G*math.Sin(x.phi) + 2*x.vr*x.vphi) / x.r
	return
}

func (s Spring) step(x *State, h float64) {
	ar, aphi := s.accelerations(*x)
	if math.IsNaN(ar) {
		panic("no number")
	} else if ar > 1e6 {
		return
	}
	x.vr += h * ar
	x.vphi += h * aphi
	x.r += h * x.vr
	x.phi += h * x.vphi
}
"""

#: Methods of numbers, and values of blocks.
METHODS = """
use std::f64::consts::PI;

const G: f64 = 9.81;

#[derive(Debug, Clone)]
pub struct DoublePendulum {
    pub m1: f64, pub m2: f64, pub l1: f64, pub l2: f64,
    pub theta1: f64, pub theta2: f64, pub omega1: f64, pub omega2: f64,
}

impl DoublePendulum {
    pub fn new(l1: f64, l2: f64) -> Self {
        let theta1 = PI / 2.0;
        Self { m1: 1.0, m2: 1.0_f64, l1, l2, theta1, theta2: 0.0, omega1: 0.0, omega2: 0.0 }
    }

    fn accelerations(&self) -> (f64, f64) {
        let delta = self.theta1 - self.theta2;
        let (s, c) = delta.sin_cos();
        let den = self.m1 + self.m2 * s.powi(2);
        let w1 = self.omega1.powi(2) * self.l1;
        let w2 = self.omega2.powf(2.0) * self.l2;
        let a1 = (-self.m2 * s * (w1 * c + w2)
            - G * ((self.m1 + self.m2) * self.theta1.sin() - self.m2 * self.theta2.sin() * c))
            / (self.l1 * den);
        let a2 = {
            let inner = w1 * s - G * self.theta2.sin() + G * self.theta1.sin() * c;
            ((self.m1 + self.m2) * inner + self.m2 * w2 * s * c) / (self.l2 * den)
        };
        (a1, a2)
    }

    pub fn step(&mut self, dt: f64) {
        let (a1, a2) = self.accelerations();
        self.omega1 += a1 * dt;
        self.omega2 += a2 * dt;
        self.theta1 += self.omega1 * dt;
        self.theta2 += self.omega2 * dt;
    }
}

fn main() {
    let mut pendulum = DoublePendulum::new(1.0, 0.5);
    for _ in 0..1000 {
        pendulum.step(0.01);
    }
    println!("{}", pendulum.theta1);
}
"""

#: An array pattern, the value of a block, and stages with loops over ranges.
PATTERNS = """
type State = [f64; 4];

fn derivative(y: &State, params: &(f64, f64, f64, f64)) -> State {
    let [r, theta, vr, omega] = *y;
    let (m, k, l, g) = *params;
    [
        vr,
        omega,
        r * omega * omega + g * f64::cos(theta) - k / m * (r - l),
        -(2.0 * vr * omega + g * f64::sin(theta)) / r,
    ]
}

fn axpy(y: &State, k: &State, h: f64) -> State {
    let mut out = [0.0; 4];
    for i in 0..4 {
        out[i] = y[i] + h * k[i];
    }
    out
}

fn rk4(y: &mut State, params: &(f64, f64, f64, f64), h: f64) {
    let k1 = derivative(y, params);
    let k2 = derivative(&axpy(y, &k1, 0.5 * h), params);
    let k3 = derivative(&axpy(y, &k2, 0.5 * h), params);
    let k4 = derivative(&axpy(y, &k3, h), params);
    for i in 0..4 {
        y[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
    }
}
"""

#: A trait whose method fills an array, and parameters taken from a struct by their names.
TRAIT = """
struct Params { gravity: f64, length: f64, damping: f64 }

trait System {
    fn system(&self, t: f64, y: &[f64], dy: &mut [f64]);
}

impl System for Params {
    fn system(&self, _t: f64, y: &[f64], dy: &mut [f64]) {
        let Params { gravity, length, .. } = self;
        let (theta, phi, w, p) = (y[0], y[1], y[2], y[3]);
        dy[0] = w;
        dy[1] = p;
        dy[2] = theta.sin() * theta.cos() * p.powi(2) - gravity / length * theta.sin();
        dy[3] = -2.0 * w * p / theta.tan();
    }
}
"""
