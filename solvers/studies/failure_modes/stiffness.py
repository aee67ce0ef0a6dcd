"""Stiff scenes: a fast mode at rest forces explicit methods to take short steps."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from math import cos, isfinite, nan

import numpy as np
from matplotlib.figure import Figure

from solvers.equations.linearisation.normal_modes import Modes
from solvers.equations.module import GeneratedModule
from solvers.integration.accuracy.integration_run import median_seconds
from solvers.integration.prepare import NotFinishedError, Prepared, prepare
from solvers.io.figures import coloured, columns, legend_beside, panels
from solvers.io.terminal import text_table
from solvers.runge_kutta.method_catalogue import load as load_method
from solvers.studies.failure_modes.study import Load, Study
from solvers.studies.work_precision.measured_curves import MOST_STEPS

#: Approximate ratios of the fast to the slow frequency.
RATIOS = (3.0, 10.0, 30.0, 100.0, 300.0, 1000.0, 3000.0)
EXPLICIT, IMPLICIT = ("rk4", "dp54", "verner853"), ("gauss2", "gauss3", "radau2", "radau3")
#: Tolerances of explicit methods, and numbers of fixed steps of the others, by rising cost.
TOLERANCES, STEPS = 10.0 ** -np.arange(1, 9, 0.5), np.ceil(10 * 2 ** np.arange(0, 18, 0.5))
#: Requested accuracy of the slow angle at the end, in rad, and the duration in s.
ACCURACY, DURATION = 1e-3, 6.0
#: Parameters and initial state of a motion.
Motion = tuple[tuple[float, ...], tuple[float, ...]]


@dataclass(frozen=True)
class Cost:
    """The cheapest run of a method that meets the requested accuracy."""

    family: str  # of scenes
    method: str
    ratio: float  # of the frequencies of the fast and the slow mode, about the equilibrium
    steps: int
    work_rhs: int  # evaluations of the right-hand side
    work_seconds: float  # of the compiled run
    global_error: float  # of the slow angle, in rad


def short_second_rod(ratio: float) -> Motion:
    """Double pendulum, l2 = 2 l1/ratio²; the short rod hangs at rest at first."""
    return (1.0, 1.0, 1.0, 2.0 / ratio**2, 9.81), (1.0, 1.0, 0.0, 0.0)


def light_first_mass(ratio: float) -> Motion:
    """Double pendulum, m1 = 2 m2/ratio²: both rods form a string that carries a bead, m1."""
    return (2.0 / ratio**2, 1.0, 1.0, 1.0, 9.81), (1.0, 1.0, 0.0, 0.0)


def light_second_mass(ratio: float) -> Motion:
    """Double pendulum, m2 = m1/ratio²: no mode becomes fast."""
    return (1.0, 1.0 / ratio**2, 1.0, 1.0, 9.81), (1.0, 1.0, 0.0, 0.0)


def stiff_spring(ratio: float) -> Motion:
    """Elastic pendulum, k = ratio² m g/l, stretched by its weight."""
    stiffness = 9.81 * ratio**2
    return (1.0, stiffness, 1.0, 9.81), (1.0 + 9.81 * cos(1.0) / stiffness, 1.0, 0.0, 0.0)


#: Families by name: the system, motions by the ratio, and the index of the slow angle.
FAMILIES: dict[str, tuple[str, Callable[[float], Motion], int]] = {
    "short second rod": ("double_pendulum", short_second_rod, 0),
    "light first mass": ("double_pendulum", light_first_mass, 0),
    "light second mass": ("double_pendulum", light_second_mass, 0),
    "stiff spring": ("elastic_pendulum", stiff_spring, 1),
}


@dataclass(frozen=True)
class StiffScene:
    """A motion with a fast and a slow mode; `slow` is the index of the slow angle."""

    module: GeneratedModule
    params: tuple[float, ...]
    y0: tuple[float, ...]
    slow: int

    @property
    def ratio(self) -> float:
        """Frequency of the fast mode over that of the slow mode, about the equilibrium."""
        frequencies = Modes.at_rest(self.module, self.params).frequencies
        return float(frequencies[-1] / frequencies[0])

    def prepared(self, method: str, rtol: float = 0.0, h: float | None = None) -> Prepared:
        """The compiled function with a tolerance or a step."""
        run = partial(prepare, method=method, form="lagrangian", max_steps=MOST_STEPS)
        return run(self.module, self.params, rtol=rtol, atol=rtol, h=h)

    def slow_angle(self, run: Prepared) -> float:
        """The slow angle at the end; NaN if that is not reached."""
        try:
            return run((0.0, DURATION), self.y0)[self.slow]
        except NotFinishedError:
            return nan

    def reference(self) -> float:
        """The slow angle at the end, on which an explicit and an implicit method agree."""
        runs = self.prepared("verner98", rtol=1e-9), self.prepared("gauss3", h=DURATION / 3000)
        ends = [*map(self.slow_angle, runs)]
        if not abs(ends[0] - ends[1]) < ACCURACY / 100:
            raise ArithmeticError(f"the references of a stiff scene differ: {ends}")
        return ends[0]

    def cheapest(self, method: str, reference: float) -> tuple[int, int, float, float] | None:
        """Steps, work and error of the cheapest run of sufficient accuracy."""
        tableau = load_method(method)
        # a controlled implicit step follows the fast mode, which the slow angle does not need
        is_controlled = tableau.estimates_error and not tableau.needs_jacobian
        key, values = ("rtol", TOLERANCES) if is_controlled else ("h", DURATION / STEPS)
        for value in values:
            run = self.prepared(method, **{key: value})
            error = abs(self.slow_angle(run) - reference)
            if error < ACCURACY:
                seconds = median_seconds(partial(run, (0.0, DURATION), self.y0))
                return run.steps, run.nfev, seconds, float(error)
        return None


@dataclass(frozen=True)
class Stiffness(Study[list[Cost]]):
    """The cheapest sufficient run of each method on each scene."""

    SMALL = ((3.0, 100.0, 300.0),)

    ratios: tuple[float, ...] = RATIOS
    methods: tuple[str, ...] = (*EXPLICIT, *IMPLICIT)

    def run(self, load: Load) -> list[Cost]:
        costs = []
        for family, (system, motion, slow) in FAMILIES.items():
            for ratio in self.ratios:
                scene = StiffScene(load(system), *motion(ratio), slow)
                reference = scene.reference()
                cheapest = {method: scene.cheapest(method, reference) for method in self.methods}
                costs += [Cost(family, m, scene.ratio, *run) for m, run in cheapest.items() if run]
        return costs

    def summary(self, results: list[Cost]) -> Iterator[str]:
        yield f"Stiff scenes: cheapest runs with the slow angle right to {ACCURACY:g} rad"
        rows = []
        families = list(dict.fromkeys(cost.family for cost in results))
        scenes = {(cost.family, cost.ratio) for cost in results}
        for family, ratio in sorted(scenes, key=lambda pair: (families.index(pair[0]), pair[1])):
            cells = []
            for kind in (EXPLICIT, IMPLICIT):
                best = min(_select(results, family, ratio, kind), key=lambda c: c.work_seconds)
                microseconds = 1e6 * best.work_seconds
                cells.append(f"{best.steps} steps, {microseconds:.0f} µs, {best.method}")
            rows.append((family, ratio, *cells))
        specs = {"family": "", "fast/slow": ".4g", " explicit": "", " implicit": ""}
        yield from text_table(specs, rows)
        for family in families:
            ratios = [crossover(results, family, work) for work in ("work_rhs", "work_seconds")]
            text = "implicit methods do not become cheaper"
            if all(map(isfinite, ratios)):
                text = f"implicit methods cost less from a ratio of {ratios[0]:.0f} on "
                text += f"(right-hand sides), {ratios[1]:.0f} (seconds)"
            yield f"{family}: {text}"

    def plot(self, results: list[Cost]) -> Figure:
        families = list(dict.fromkeys(cost.family for cost in results))
        title = "Cost of a slow angle within 1e-3 rad after 6 s, beside a fast mode"
        figure, axes = panels(title, columns=len(families), size=(13, 4))
        for panel in axes[1:]:
            panel.sharey(axes[0])
        for panel, family in zip(axes, families, strict=True):
            for method, colour in coloured(cost.method for cost in results):
                rows = [c for c in results if (c.family, c.method) == (family, method)]
                times = [1e3 * c.work_seconds for c in rows]
                style = ".--" if method in EXPLICIT else ".-"
                panel.loglog(*columns(rows, "ratio"), times, style, color=colour, label=method)
            panel.set(title=family, xlabel="fast over slow frequency", xlim=(0.7, 1e4))
        axes[0].set_ylabel("time, compiled / ms")
        legend_beside(axes[-1], title="explicit dashed")
        return figure


def crossover(costs: Sequence[Cost], family: str, work: str) -> float:
    """The ratio from which on the best implicit method costs less; NaN if there is none."""
    ratios = sorted({cost.ratio for cost in costs if cost.family == family})
    gains = []
    for ratio in ratios:
        kinds = (_select(costs, family, ratio, kind) for kind in (EXPLICIT, IMPLICIT))
        explicit, implicit = (min(*columns(kind, work), default=np.inf) for kind in kinds)
        gains.append(np.log(explicit / implicit))
    k = next((k for k in range(len(gains)) if min(gains[k:]) > 0), 0)
    if k == 0:
        return float("nan")
    return float(np.exp(np.interp(0.0, gains[k - 1 : k + 1], np.log(ratios[k - 1 : k + 1]))))


def _select(costs: Sequence[Cost], family: str, ratio: float, methods: Sequence[str]) -> list[Cost]:
    return [c for c in costs if (c.family, c.ratio) == (family, ratio) and c.method in methods]
