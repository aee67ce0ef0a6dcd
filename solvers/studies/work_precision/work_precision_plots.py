"""Work-precision diagrams, and diagrams of steps and of energy."""

from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from solvers.equations.energy import EnergyUnit
from solvers.io.figure_names import axis_label
from solvers.io.figures import COLOURS, coloured, columns, panels
from solvers.studies.work_precision.cost_curve import CostCurve, select
from solvers.studies.work_precision.measured_curves import FORMS, REPORT_METHODS

#: The plotted methods, one curve each; the others are close to one of them.
METHODS = "rk1 midpoint rk3 rk4 bs32 dp54 tsit54 dop853 verner853 verner98 gauss3 radau3".split()
STYLES = ("-", "--", ":")
#: The method whose forms and backends are compared.
EXAMPLE = "verner853"
#: Backends of this package and of SciPy, and a method for each.
BACKENDS = {"compiled": EXAMPLE, "python": EXAMPLE, "scipy": "DOP853"}
ERROR = "global error / rad, rad/s"


def work_precision(title: str, curves: Sequence[CostCurve]) -> Figure:
    """Methods in seconds and in calls; forms and backends.

    Parameters
    ----------
    title : str
        Title of the figure.
    curves : sequence of Curve
        Curves of one scene; those that belong to no panel are left out.

    Returns
    -------
    Figure
        Three panels of the global error in rad and rad/s over time in s, one of them over
        calls of the right-hand side.
    """
    figure, (seconds, calls, choices) = panels(title, columns=3, size=(18, 5.5))
    for n, method in enumerate(METHODS):
        style = {"color": COLOURS[n % len(COLOURS)], "linestyle": STYLES[n // len(COLOURS)]}
        combinations = ((method, form, "compiled") for form in reversed(FORMS))
        for curve in list(select(curves, *combinations))[:1]:  # rational where there is one
            _plot(seconds, curve, method, **style)
            _plot(calls, curve, method, "work_rhs", **style)
    seconds.set(title="methods, compiled, fastest form", xlabel="time / s")
    calls.set(title="the same", xlabel="calls of the right-hand side")
    for (backend, method), line in zip(BACKENDS.items(), STYLES, strict=True):
        for form, colour in coloured(FORMS):
            for curve in select(curves, (method, form, backend)):
                label = f"{method}, {backend}, {form}"
                _plot(choices, curve, label, color=colour, linestyle=line)
    choices.set(title="forms and backends", xlabel="time / s")
    for panel in (calls, choices):
        if panel.lines:
            panel.legend(frameon=False, fontsize="small")
    for panel in (seconds, calls, choices):
        panel.set_ylabel(ERROR)
    return figure


def _plot(
    panel: Axes, curve: CostCurve, label: str, work: str = "work_seconds", **style: str
) -> None:
    panel.loglog(*curve.costs(work), marker=".", label=label, **style)


def steps(title: str, curves: Sequence[CostCurve]) -> Figure:
    """Errors of the report's methods over the step.

    Parameters
    ----------
    title : str
        Title of the figure.
    curves : sequence of Curve
        Curves of one scene, of which those of the report's methods are plotted, compiled, in
        Lagrange's form.

    Returns
    -------
    Figure
        The global error in rad and rad/s over the step in s, both logarithmic.
    """
    figure, (axes,) = panels(title, size=(7.5, 5))
    for (name, method), colour in coloured(REPORT_METHODS.items()):
        for curve in select(curves, (method, "lagrangian", "compiled")):
            points = zip(*((p.setting["h"], p.global_error) for p in curve.points), strict=True)
            axes.loglog(*points, marker=".", color=colour, label=f"{name} ({method})")
    axes.set(xlabel="step / s", ylabel=ERROR)
    if axes.lines:
        axes.legend(frameon=False)
    return figure


def energy(title: str, curves: Sequence[CostCurve], wrong: float, unit: EnergyUnit) -> Figure:
    """Global error over energy error of every run, with the error above which a state is wrong."""
    figure, (axes,) = panels(title, size=(7.5, 5))
    for backend, colour in coloured(BACKENDS):
        points = [p for c in curves if c.backend == backend for p in c.points]
        errors = columns(points, "energy_error", "global_error")
        axes.loglog(*errors, ".", color=colour, markersize=4, label=backend)
    axes.axhline(wrong, color="#888888", label="above: no digit is right")
    axes.set(xlabel=axis_label("energy error at the end", unit.name), ylabel=ERROR)
    axes.legend(frameon=False)
    return figure
