"""Results and messages of public functions, a line of Python each."""

from importlib import import_module

import numpy as np
import sympy
from cart_pole import cart_pole
from evaluated import evaluated
from recording import Record

import holonomic

EXPRESSIONS = """
integrate(dp, (0, 1), (1, 2, 0, 0), dp.DEFAULTS)
integrate(dp, (0, 1, 2), (1, 2, 0, 0), dp.DEFAULTS)
integrate(dp, (0, 1), (1, 2, 0), dp.DEFAULTS)
integrate(dp, (0, 1), {"theta1": 1, "theta3": 2}, dp.DEFAULTS)
integrate(dp, (0, 1), {"theta1": 1}, {"m3": 2})
integrate(dp, (0, 1), (1, 2, 0, 0), (1, 1, 2, 2, 9.81, 3))
integrate(dp, (0, 1), (1, 2, 0, 0), {"m1": -1})
integrate(dp, (0, 1), (1, 2, 0, 0), {"m2": 0})
integrate(dp, (0, 1), (1, 2, 0, 0), {}, method="rk4")
integrate(dp, (0, 1), (1, 2, 0, 0), {}, method="rk4", h=-0.1)
integrate(dp, (0, 1), (1, 2, 0, 0), {}, method="rk4", h=1e-20)
integrate(dp, (0, 1), (1, 2, 0, 0), {}, method="leapfrog", h=0.1)
integrate(dp, (0, 1), (1, 2, 0, 0), {}, form="rationl")
integrate(dp, (0, 1), (1, 2, 0, 0), {}, form="linear")
integrate(dp, (0, 1), (1, 2, 0, 0), {}, backend="fortran")
integrate(dp, (0, 1), (1, 2, 0, 0), {}, rtol=0, atol=0)
integrate(dp, (0, 1), (1, 2, 0, 0), {}, rtol=-1)
integrate(dp, (0, 1), (1, 2, 0, 0), {}, accuracy=1e-6, rtol=1e-3)
integrate(dp, (0, 1), (1, 2, 0, 0), {}, accuracy=0)
integrate(dp, (0, 1), (1, 2, 0, 0), {}, t_eval=[0.5, 0.2])
integrate(dp, (0, 1), (1, 2, 0, 0), {}, t_eval=[0.5, 1.2])
integrate(dp, (0, 1), (1, 2, 0, 0), {}, events=3)
integrate(dp, (1, 0), (1, 2, 0, 0), {}, t_eval=[0.5, 0.2]).y
integrate(dp, (0, 2), (1, 2, 0, 0), {}, events=[Event(dp, "theta1", 0.0)]).t_events
integrate(sp, (0, 9), (1, 0), {}, events=[Event(sp, "theta", 0, terminal=True, direction=1)]).t[-1]
Event(dp, "theta3", 0.0)
Event(dp, "theta1", float("nan"))
Event(dp, "theta1", 0.0, direction=2)
ensemble(dp, (0, 1), np.zeros((3, 2)), {})
ensemble(dp, (0, 1), np.zeros((4, 2)), {"m1": [1.0, 2.0, 3.0]})
ensemble(dp, (0, 1), np.ones((4, 2)), {"m1": [1.0, 2.0]}, rtol=1e-12, atol=1e-12)
ensemble(dp, (0, 1), np.ones((4, 2)), {"m1": [1.0, 2.0]}, rtol=1e-12, atol=1e-12).y
ensemble(dp, (0, 1), np.ones((4, 2)), {}, occurrences=0)
ensemble(dp, (0, 1), np.ones((4, 2)), {}, workers=0)
prepare(dp, (1, 2))
consistent_start(four_bar, {"phi": 1.0}, {})
consistent_start(four_bar, {"phi": 1.0, "phi_dot": 1.0}, {}).y
consistent_start(four_bar, {}, {})
consistent_start(dp, {"theta1": 1.0}, {})
equilibria(spherical, {}, {"phi_dot": 0.0})
Scene(dp, dp.DEFAULTS, (1, 2, 0, 0), -1.0)
Scene(dp, dp.DEFAULTS, (1, 2, 0, 0), 1.0, outputs=("theta9",))
Scene(dp, dp.DEFAULTS, (1, 2, 0, 0), 1.0, pictures=("theta1 over q",))
Derivation(cart_pole).identifiable(["x"])
lyapunov_spectrum(sp, (0.1, 0.0), {}, 5.0)
linearise(dp, {}, {"m3": 1.0})
[one.eigenvalues.imag.max() for one in equilibria(dp, {})]
Grid({"theta1": [1.0, 2.0], "theta2": []})
Sweep(dp, Grid({"theta1": [0.1]}), {}, 1.0, values={"theta2": 0.0})
Sweep(dp, Grid({"m9": [0.1]}), {"a": Final(("theta1",))}, 1.0)
System("a b", "t", [], [], [])
System("a", "t", [Coordinate(x, "m", "")], [], [PointMass(1, (x, y))])
System("a", "t", [Coordinate(x, "m", "")], [], [PointMass(0, (x, 0))], potential=0)
System("a", "t", [Coordinate(x, "m", "")], [], [PointMass(1, (x, 0, 0, 0))], potential=0)
System("a", "t", [Coordinate(x, "m", ""), Coordinate(x, "m", "")], [], [PointMass(1, (x, 0))])
Derivation(System("a", "t", [Coordinate(x, "m", "")], [], [PointMass(1, (1, 0))], potential=x))
Parameter(x, "kg", float("inf"), "mass")
Derivation(cart_pole).identifiable(["m"])
Derivation(cart_pole).regressor.parameters
Derivation(cart_pole).state_space().A
Derivation(cart_pole).linearisation()
export(cart_pole, "cobol", ".")
Sweep(dp, Grid({"theta1": [0.1]}), {"a": Final(("theta9",))}, 1.0, values={"theta2": 0.0})
Derivation(cart_pole).equilibria({"F": 0, "T": 0})
"""
MODULES = {"dp": "double_pendulum", "sp": "single_pendulum",
    "four_bar": "four_bar", "spherical": "spherical_pendulum"}  # fmt: skip


def test_values_of_expressions_are_as_recorded(record: Record) -> None:
    x, y = sympy.symbols("x y", real=True)
    names = {name: getattr(holonomic, name) for name in holonomic.__all__}
    names |= {name: import_module(f"generated.{module}") for name, module in MODULES.items()}
    names |= {"np": np, "x": x, "y": y, "cart_pole": cart_pole}
    record.check(evaluated(EXPRESSIONS, names))
