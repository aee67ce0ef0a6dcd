"""
Stability regions
=================

Where one step does not enlarge a solution of y' = λy: the boundaries of five methods, from
their exact stability functions.
"""

from solvers.runge_kutta.method_catalogue import load
from solvers.runge_kutta.stability_function import StabilityFunction
from solvers.studies.stability import boundaries

names = ("rk1", "midpoint", "rk3", "rk4", "dop853")
picture = boundaries({name: StabilityFunction.of(load(name)) for name in names})
