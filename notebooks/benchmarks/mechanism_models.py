"""Three mechanisms of the catalogue in Exudyn: a start, a model, and its solver.

Solvers and formulations are those that take Exudyn the least time of those that were tried:
kinematic trees, which a joint closes where the mechanism has a loop.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from math import asin, cos, pi, sin
from typing import Any

import numpy as np

from benchmarks.exudyn import Link, Model, Point
from benchmarks.motions import Array
from solvers.equations.consistent_start import consistent_start
from solvers.equations.module import GeneratedModule, has_constraints
from solvers.references.taylor import taylor

#: Duration in s.
END = 1.0
Quantities = Mapping[str, float]


@dataclass(frozen=True)
class Mechanism:
    """A motion of a system, and the same in Exudyn."""

    start: Quantities
    #: Takes the package, parameters and the whole start.
    model: Callable[[Any, Quantities, Quantities], Model]
    solver: str
    steps: Sequence[int]
    #: Coordinates, as sums of some of Exudyn's.
    sums: Mapping[str, tuple[int, ...]]
    #: Guesses of coordinates that the start leaves open.
    guess: Quantities = field(default_factory=dict)
    #: Angles of coordinates where those of Exudyn are 0.
    offsets: Quantities = field(default_factory=dict)

    def whole_start(self, module: GeneratedModule) -> Array:
        """The state at the start."""
        if has_constraints(module):
            return consistent_start(module, self.start, module.DEFAULTS, guess=self.guess).y
        return np.array([self.start.get(name, 0.0) for name in module.STATE])

    def reference(self, module: GeneratedModule) -> Array:
        """Coordinates and velocities at the end, by Taylor series of 22 digits."""
        start = self.whole_start(module).tolist()
        return self.part(module, taylor(module, module.DEFAULTS, start, [0.0, END], 22)[-1])

    def part(self, module: GeneratedModule, state: Array) -> Array:
        """The coordinates in `sums`, and their velocities."""
        names = (*self.sums, *(f"{name}_dot" for name in self.sums))
        return state[[module.STATE.index(name) for name in names]]

    def exudyn(self, package: Any, module: GeneratedModule, steps: int) -> Callable[[], Array]:
        """A function that returns the same as `reference`."""
        params = dict(zip(module.PARAMETERS, module.DEFAULTS, strict=True))
        start = dict(zip(module.STATE, self.whole_start(module).tolist(), strict=True))
        model = self.model(package, params, start)
        motion = model.motion(self.solver, END, steps)
        offsets = [self.offsets.get(name, 0.0) for name in self.sums]

        def run() -> Array:
            q, rates = motion()
            angles = [sum(q[k] for k in part) for part in self.sums.values()]
            return np.array(
                [
                    *np.add(angles, offsets),
                    *(sum(rates[k] for k in part) for part in self.sums.values()),
                ]
            )

        return run


@dataclass(frozen=True)
class Bar:
    """A uniform bar in the plane, which may have a point mass at its end."""

    angle: float  # from the horizontal
    rate: float
    length: float
    mass: float
    tip: float = 0.0

    def link(self, before: "Bar") -> Link:
        """The link that starts at the end of another one."""
        m, tip, length = self.mass, self.tip, self.length
        centre = (m / 2 + tip) * length / (m + tip)
        inertia = m * length**2 / 12 + m * (centre - length / 2) ** 2 + tip * (length - centre) ** 2
        return Link(
            self.angle - before.angle,
            self.rate - before.rate,
            m + tip,
            (centre, 0.0, 0.0),
            (0.0, inertia, inertia),
            (before.length, 0.0, 0.0),
        )


def bars(*chain: Bar, pivot: float = 0.0) -> list[Link]:
    """A chain of bars that starts at a point of the horizontal axis."""
    return [bar.link(before) for before, bar in pairwise((Bar(0.0, 0.0, pivot, 0.0), *chain))]


def _four_bar(package: Any, p: Quantities, y: Quantities) -> Model:
    model = Model(package, (0.0, -p["g"], 0.0))
    crank = model.add_tree(bars(Bar(y["phi"], y["phi_dot"], p["a"], p["m1"])))
    rocker = Bar(y["chi"], y["chi_dot"], p["c"], p["m3"])
    coupler = Bar(y["psi"] + pi, y["psi_dot"], p["b"], p["m2"])  # from the rocker to the crank
    rest = model.add_tree(bars(rocker, coupler, pivot=p["d"]))
    ends = Point((p["a"], 0.0, 0.0), crank, 0), Point((p["b"], 0.0, 0.0), rest, 1)
    model.join(*ends, (1, 1, 0))
    return model


def _slider_crank(package: Any, p: Quantities, y: Quantities) -> Model:
    model = Model(package, (0.0, -p["g"], 0.0))
    phi, rate, ratio = y["phi"], y["phi_dot"], p["r"] / p["l"]
    angle = -asin(ratio * sin(phi))
    rod_rate = -ratio * cos(phi) * rate / cos(angle)
    crank = Bar(phi, rate, p["r"], p["m1"])
    rod = Bar(angle, rod_rate, p["l"], p["m2"], tip=p["M"])  # with the slider at its end
    tree = model.add_tree(bars(crank, rod))
    model.join(Point((0.0, 0.0, 0.0)), Point((p["l"], 0.0, 0.0), tree, 1), (0, 1, 0))
    return model


def _heavy_top(package: Any, p: Quantities, y: Quantities) -> Model:
    model = Model(package, (0.0, 0.0, -p["g"]))
    frames = [
        Link(y[name], y[f"{name}_dot"], axis=axis) for name, axis in (("phi", "Z"), ("theta", "X"))
    ]
    moments, centre = (p["A"], p["A"], p["C"]), (0.0, 0.0, p["l"])
    model.add_tree([*frames, Link(y["psi"], y["psi_dot"], p["m"], centre, moments)])
    return model


MECHANISMS = {
    "four_bar": Mechanism(
        start={"phi": 1.0, "phi_dot": 8.0},
        guess={"psi": 0.5, "chi": 1.5},
        model=_four_bar,
        sums={"phi": (0,), "psi": (1, 2), "chi": (1,)},
        offsets={"psi": -pi},
        solver="TrapezoidalIndex2",
        steps=[500 * 2**k for k in range(8)],
    ),
    "slider_crank": Mechanism(
        start={"phi": 1.0, "phi_dot": 10.0},
        model=_slider_crank,
        sums={"phi": (0,)},
        solver="TrapezoidalIndex2",
        steps=[500 * 2**k for k in range(8)],
    ),
    "heavy_top": Mechanism(
        start={"theta": 0.6, "phi_dot": 1.0, "psi_dot": 60.0},
        model=_heavy_top,
        sums={"phi": (0,), "psi": (2,), "theta": (1,)},
        solver="RK67",
        steps=[10 * 2**k for k in range(6)],
    ),
}
