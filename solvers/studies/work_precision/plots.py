"""Work-precision diagrams, and what they say of steps and of energy."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from solvers.io.figures import COLOURS, panels
from solvers.studies.work_precision.curve import Curve
from solvers.studies.work_precision.measurement import FORMS, REPORT
from solvers.studies.work_precision.peers import PEERS

#: Methods that are drawn, one a line; others are close to one of them.
METHODS = ("rk1", "midpoint", "rk3", "rk4", "bs32", "dp54", "tsit54", "dop853", "verner87",
           "verner98", "gauss3", "radau3")  # fmt: skip
STYLES = ("-", "--", ":")
#: The method whose forms and backends are compared.
EXAMPLE = "verner87"


def work_precision(title: str, curves: Sequence[Curve]) -> Figure:
    """Methods in seconds and in calls; forms and backends; other programs.

    Parameters
    ----------
    title : str
        Of the picture.
    curves : sequence of Curve
        Of one scene; those that no panel wants are left out.

    Returns
    -------
    Figure
        Four panels of the global error in rad and rad/s over time in s, one of them over
        calls of the right-hand side.
    """
    figure, (seconds, calls, choices, peers) = panels(title, rows=2, columns=2, size=(14, 10))
    for n, method in enumerate(METHODS):
        style = {"color": COLOURS[n % len(COLOURS)], "linestyle": STYLES[n // len(COLOURS)]}
        own = [c for c in curves if (c.method, c.backend) == (method, "compiled")]
        if not own:
            continue
        curve = max(own, key=lambda c: FORMS.index(c.form))  # rational where there is one
        _draw(seconds, curve, "work_seconds", method, **style)
        _draw(calls, curve, "work_rhs", method, **style)
    seconds.set(title="methods, compiled, fastest form", xlabel="time / s")
    calls.set(title="the same", xlabel="calls of the right-hand side")
    for n, (backend, method) in enumerate((
        ("compiled", EXAMPLE), ("python", EXAMPLE), ("scipy", "DOP853"),
    )):  # fmt: skip
        for form, colour in zip(FORMS, COLOURS, strict=False):
            for curve in curves:
                if (curve.method, curve.form, curve.backend) == (method, form, backend):
                    label = f"{method}, {backend}, {form}"
                    _draw(choices, curve, "work_seconds", label, color=colour, linestyle=STYLES[n])
    choices.set(title="forms and backends", xlabel="time / s")
    others = [curve for curve in curves if curve.backend in PEERS]
    ours = (EXAMPLE, "rational", "compiled")
    for curve in curves if others else ():
        if (curve.method, curve.form, curve.backend) == ours:
            _draw(peers, curve, "work_seconds", f"holonomic {EXAMPLE}", color="black")
    for n, curve in enumerate(others):
        _draw(peers, curve, "work_seconds", f"{curve.backend} {curve.method}",
              color=COLOURS[n % 6], linestyle=STYLES[n // 6])  # fmt: skip
    peers.set(title="other programs", xlabel="time / s")
    if not others:
        peers.set_axis_off()
        peers.set_title("other programs: none is installed")
    for panel in (calls, choices, peers):
        if panel.lines:
            panel.legend(frameon=False, fontsize="small")
    for panel in (seconds, calls, choices, peers):
        panel.set_ylabel("global error / rad, rad/s")
    return figure


def _draw(panel: Axes, curve: Curve, work: str, label: str, **style: str) -> None:
    points = [p for p in curve.points if getattr(p, work) is not None]
    panel.loglog([getattr(p, work) for p in points], [p.global_error for p in points],
                 marker=".", label=label, **style)  # fmt: skip


def steps(title: str, curves: Sequence[Curve]) -> Figure:
    """Errors of the report's rules over the step.

    Parameters
    ----------
    title : str
        Of the picture.
    curves : sequence of Curve
        Of one scene; of these the report's rules, compiled, in Lagrange's form.

    Returns
    -------
    Figure
        The global error in rad and rad/s over the step in s, both logarithmic.
    """
    figure, (axes,) = panels(title, size=(7.5, 5))
    for (name, method), colour in zip(REPORT.items(), COLOURS, strict=False):
        for curve in curves:
            if (curve.method, curve.form, curve.backend) == (method, "lagrangian", "compiled"):
                axes.loglog([p.setting["h"] for p in curve.points],
                            [p.global_error for p in curve.points], marker=".", color=colour,
                            label=f"{name} ({method})")  # fmt: skip
    axes.set(xlabel="step / s", ylabel="global error / rad, rad/s")
    if axes.lines:
        axes.legend(frameon=False)
    return figure


def energy(title: str, curves: Sequence[Curve], wrong: float) -> Figure:
    """Global over energy error of every run: right below, wrong above."""
    figure, (axes,) = panels(title, size=(7.5, 5))
    for backend, colour in zip(("compiled", "python", "scipy"), COLOURS, strict=False):
        points = [p for c in curves if c.backend == backend for p in c.points]
        axes.loglog([p.energy_error for p in points], [p.global_error for p in points], ".",
                    color=colour, markersize=4, label=backend)  # fmt: skip
    axes.axhline(wrong, color="#888888", label="above: not right in any digit")
    axes.set(xlabel="energy error, relative", ylabel="global error / rad, rad/s")
    axes.legend(frameon=False)
    return figure
