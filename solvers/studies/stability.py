"""Stability of methods on a scene: the longest steps with which no oscillation grows, regions.

The measurement uses the method only to make steps. A single mode of small motion is integrated
with a fixed step, and its growth is recorded. The step is increased until the mode grows, and the
limit is found by bisection.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from math import inf
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from solvers.equations.energy import equilibrium_state
from solvers.equations.linearisation.normal_modes import Modes, local_eigenvalues
from solvers.equations.module import GeneratedModule
from solvers.integration.checks.predictability import ignore_predictability
from solvers.integration.integrate import integrate
from solvers.io.figures import COLOURS, coloured, panels
from solvers.io.terminal import text_table
from solvers.runge_kutta.method_catalogue import load, names
from solvers.runge_kutta.stability_function import StabilityFunction
from solvers.runge_kutta.stepper import NoConvergenceError, NotFiniteError, Stepper
from solvers.scenes.scene import Scene

Array = NDArray[np.float64]
#: Takes a step in s; returns the logarithm of an oscillation's growth per step.
Growth = Callable[[float], float]

#: Amplitude in units of the coordinates: nonlinear terms are below rounding.
AMPLITUDE = 1e-7
#: Growth per step below this is rounding.
NO_GROWTH = 1e-15
#: Range and ratio of steps times frequency, and the relative resolution of the bisection.
SHORTEST, LONGEST, RATIO, RESOLUTION = 0.25, 40.0, 1.25, 1e-4
#: Number of steps; growth is measured over the second half.
STEPS = 100
#: Sizes relative to the initial size that count as zero and as no longer small.
LOST, LARGE = 1e-6, 1e4
#: Largest number of rounding errors of a state that add up.
ROUNDINGS = 100
#: Growth is reported for a step longer than the limit by this factor, or for 1/frequency.
BEYOND = 1.05


@dataclass(frozen=True)
class CriticalStep:
    """The step in s at which a method becomes unstable for the fastest small oscillation.

    0: oscillations grow even with the shortest step; inf: with none.
    """

    method: str
    title: str  # common name of the method
    order: int
    stages: int
    function: StabilityFunction
    predicted: float  # imaginary stability interval over the frequency
    linear: float  # limit for runs of the linear equations
    measured: float  # limit for runs of the system's equations in small motion
    probe: float  # a step in s; the linear equations grow by these logarithms per step
    growth_predicted: float
    growth_measured: float


def critical_step(method: str, module: GeneratedModule, params: Sequence[float]) -> CriticalStep:
    """The longest stable step of a method for small motions about the equilibrium.

    Parameters
    ----------
    method : str
        One of ``solvers.runge_kutta.method_catalogue.names()``.
    module : module
        A generated module.
    params : sequence of float
        In the order of ``module.PARAMETERS``.

    Returns
    -------
    CriticalStep
        The limit in s, predicted from R(z) and measured.

    Raises
    ------
    solvers.runge_kutta.method_catalogue.UnknownMethodError
        When no method has this name.
    ValueError
        When no stable equilibrium of the system is known, or a mode has no mass.
    """
    modes = Modes.at_rest(module, params)
    fastest = float(modes.frequencies[-1])
    tableau = load(method)
    function = StabilityFunction.of(tableau)
    linear, running = _linear(method, modes), _small_motion(method, module, params, modes)
    # rounding of M and K makes motion grow in proportion to the ratio of frequencies
    no_growth = NO_GROWTH * fastest / float(modes.frequencies[0])
    measured = limit(running, fastest, no_growth)
    probe = BEYOND * measured if 0 < measured < inf else 1 / fastest
    names = method, tableau.title, tableau.order, tableau.stages, function
    predicted = function.imaginary_stability_interval / fastest
    limits = predicted, limit(linear, fastest, no_growth), measured
    growth = float(np.log(np.abs(function(1j * probe * fastest)))), linear(probe)
    return CriticalStep(*names, *limits, probe, *growth)


def limit(growth: Growth, frequency: float, no_growth: float = NO_GROWTH) -> float:
    """The longest step without growth: 0 if all steps in the range have growth, inf if none."""
    stable, h = 0.0, SHORTEST / frequency
    while growth(h) <= no_growth:
        stable, h = h, h * RATIO
        if h * frequency > LONGEST:
            return inf
    if stable == 0:
        return 0.0
    while h - stable > RESOLUTION * stable:
        middle = (stable + h) / 2
        stable, h = (middle, h) if growth(middle) <= no_growth else (stable, middle)
    return stable


def _linear(method: str, modes: Modes) -> Growth:
    """Growth per step of M₀ ẍ + K x = 0, by the stepper in Python."""
    matrix = modes.matrix
    start = AMPLITUDE * np.concatenate([modes.shapes[:, -1], np.zeros(len(modes.frequencies))])

    def growth(h: float) -> float:
        stepper = Stepper(load(method), lambda _, y: matrix @ y, lambda _, y: matrix)
        y, sizes, last = start, [], None
        with np.errstate(over="ignore", invalid="ignore"):
            try:
                for _ in range(2):
                    for _ in range(STEPS // 2):
                        step = stepper.step(0.0, y, h, stepper.derivative(0.0, y), last)
                        y, last = step.y, step.last
                    sizes.append(modes.size(y))
            except (NotFiniteError, NoConvergenceError):
                return inf
        return _rate(sizes, LOST * modes.size(start))

    return growth


def _small_motion(
    method: str, module: GeneratedModule, params: Sequence[float], modes: Modes
) -> Growth:
    """Growth per step of the system itself, by `integrate`."""
    n = len(modes.frequencies)
    rest = equilibrium_state(module, params)
    assert rest is not None  # the modes are those of the equilibrium
    start = rest + AMPLITUDE * np.concatenate([modes.shapes[:, -1], np.zeros(n)])
    # rounding is relative to the coordinates of the equilibrium
    rounding = ROUNDINGS * modes.size(np.finfo(float).eps * rest)
    size = modes.size(start - rest)

    @ignore_predictability()
    def growth(h: float) -> float:
        half = STEPS // 2 * h
        solve = partial(integrate, method=method, form="lagrangian", h=h)
        run = solve(module, (0, 2 * half), start, params, t_eval=(half, 2 * half))
        with np.errstate(over="ignore", invalid="ignore"):
            sizes = [modes.size(y - rest) for y in run.y.T]
        if len(sizes) < 2 or not max(sizes) < LARGE * size:
            return inf  # motion that is no longer small has grown
        return _rate(sizes, LOST * size + 10 * rounding) - rounding / size / STEPS

    return growth


def _rate(sizes: Sequence[float], lost: float) -> float:
    """Logarithm of the growth per step over the second half; -inf for a size of zero."""
    halfway, end = sizes
    if not np.isfinite(halfway + end):
        return inf
    if min(halfway, end) < lost:
        return -inf
    return float(np.log(end / halfway) / (STEPS - STEPS // 2))


Frequencies = NDArray[np.float64]
Eigenvalues = NDArray[np.complex128]

#: Limits of the plotted part of the complex plane, and points along each axis.
LEFT, RIGHT, TOP, POINTS = -7.0, 4.0, 7.0, 221
X, Y = np.linspace(LEFT, RIGHT, POINTS), np.linspace(-TOP, TOP, POINTS)


def regions(
    title: str, steps: Sequence[CriticalStep], frequencies: Frequencies, eigenvalues: Eigenvalues
) -> Figure:
    """The region |R| ≤ 1 of each stability function, with hλ of modes and along a motion."""
    shared: dict[object, list[CriticalStep]] = {}
    for step in steps:
        shared.setdefault(step.function, []).append(step)
    columns = min(5, len(shared))
    rows = -(-len(shared) // columns)
    figure, axes = panels(title, rows=rows, columns=columns, size=(2.6 * columns, 9))
    for panel, group in zip(axes, shared.values(), strict=False):
        _region(panel, group, frequencies, eigenvalues)
    for panel in axes[len(shared) :]:
        panel.set_axis_off()
    figure.supxlabel("Re hλ")
    figure.supylabel("Im hλ")
    return figure


def boundaries(functions: Mapping[str, StabilityFunction]) -> Figure:
    """Boundaries |R| = 1 in one panel.

    Parameters
    ----------
    functions : mapping of str to StabilityFunction
        By their labels; at most seven.

    Returns
    -------
    matplotlib.figure.Figure
        The plane of hλ, a step times an eigenvalue.
    """
    figure, (panel,) = panels("", size=(5.2, 4.8))
    for name, colour in coloured(functions):
        size = np.abs(functions[name](X + 1j * Y[:, None]))
        panel.contour(X, Y, size, levels=[1], colors=[colour], linewidths=1.4)
    panel.axvline(0, color="#bbbbbb", linewidth=0.6, zorder=0)
    panel.axhline(0, color="#bbbbbb", linewidth=0.6, zorder=0)
    panel.set(xlabel="Re hλ", ylabel="Im hλ", aspect="equal")
    handles = [Line2D([], [], color=colour) for _, colour in coloured(functions)]
    style = {"frameon": False, "fontsize": "small", "columnspacing": 1.2}
    figure.legend(handles, list(functions), loc="outside upper center", ncols=4, **style)
    return figure


def _region(
    panel: Axes, group: Sequence[CriticalStep], frequencies: Frequencies, eigenvalues: Eigenvalues
) -> None:
    first = group[0]
    size = np.abs(first.function(X + 1j * Y[:, None]))
    panel.contourf(X, Y, size, levels=[0, 1], colors=["#cfe3f2"])
    panel.contour(X, Y, size, levels=[1], colors=[COLOURS[0]], linewidths=0.8)
    panel.axhline(0, color="#bbbbbb", linewidth=0.5)
    panel.axvline(0, color="#bbbbbb", linewidth=0.5)
    limits = {0: "no step is stable", inf: "every step is stable"}
    limit = limits.get(first.predicted, f"h ≤ {first.predicted:.3g} s")
    h = 1 / frequencies[-1] if first.predicted in limits else first.predicted
    along = h * eigenvalues
    panel.plot(along.real, along.imag, ".", color="#999999", markersize=1.5)
    modes = h * np.concatenate([frequencies, -frequencies])
    panel.plot(np.zeros_like(modes), modes, "o", color=COLOURS[1], markersize=3)
    panel.set(xlim=(LEFT, RIGHT), ylim=(-TOP, TOP), aspect="equal")
    panel.set_title(f"{', '.join(step.method for step in group)}\n{limit}", fontsize="small")


#: Samples of a scene's motion at which its modes are computed.
SAMPLES = 100


@dataclass(frozen=True)
class SceneStability:
    """Critical steps of every method for small motions with a scene's parameters."""

    scene: Scene
    steps: list[CriticalStep]

    @classmethod
    def of(cls, scene: Scene, report: Callable[[str], None] = lambda _: None) -> "SceneStability":
        """The critical steps of all methods, each reported before it is computed.

        Fixed steps of a method with variable order are those of another method, and splittings have
        no stability region.
        """
        steps, tableaus = [], {name: load(name) for name in names()}
        for method in (m for m, t in tableaus.items() if not t.lower and not t.is_splitting):
            report(f"{scene.name}: {method}")
            steps.append(critical_step(method, scene.module, scene.params))
        return cls(scene, steps)

    def summary(self) -> Iterator[str]:
        """The critical steps as a table."""
        yield f"Longest stable steps of {self.scene.title}: its fastest small oscillation, in s"
        columns = {"method": "", "order": "d", "real": ".4g", "imaginary": ".5g"}
        columns |= {"predicted": ".5g", "linear": ".5g", "nonlinear": ".5g"}
        columns |= {"at h": ".3g", "ln growth/step": ".1e", "predicted ln": ".1e"}
        yield from text_table(columns, map(_cells, self.steps))
        yield "0: unstable at every step size; inf: stable at every step size"

    def plot(self) -> Figure:
        """Stability regions of all methods with the scene's modes."""
        module, params, duration = self.scene.module, self.scene.params, self.scene.duration
        t = np.linspace(0, duration, SAMPLES)
        motion = integrate(module, (0, duration), self.scene.y0, params, t_eval=t)
        eigenvalues = local_eigenvalues(module, params, motion.y.T).ravel()
        frequencies = Modes.at_rest(module, params).frequencies
        title = f"|R(hλ)| ≤ 1, small motions (dots) and the motion (grey) of {self.scene.title}"
        return regions(title, self.steps, frequencies, eigenvalues)

    def rows(self) -> list[dict[str, Any]]:
        """The figures of each method, for JSON."""
        return [{"scene": self.scene.name} | _row(step) for step in self.steps]


def _cells(step: CriticalStep) -> tuple[object, ...]:
    intervals = step.function.real_stability_interval, step.function.imaginary_stability_interval
    limits = step.predicted, step.linear, step.measured
    growth = step.probe, step.growth_measured, step.growth_predicted
    return step.method, step.order, *intervals, *limits, *growth


def _row(step: CriticalStep) -> dict[str, Any]:
    function, probe = step.function, {"h": step.probe}
    probe |= {"growth_predicted": step.growth_predicted, "growth_measured": step.growth_measured}
    numerator, denominator = map(str, function.numerator), map(str, function.denominator)
    names = {name: getattr(step, name) for name in ("method", "title", "order", "stages")}
    return names | {
        "stability_function": {"numerator": [*numerator], "denominator": [*denominator]},
        "real_stability_interval": function.real_stability_interval,
        "imaginary_stability_interval": function.imaginary_stability_interval,
        "critical_step_predicted": step.predicted,
        "critical_step_measured": step.measured,
        "critical_step_measured_linear": step.linear,
        "probe": probe,
    }
