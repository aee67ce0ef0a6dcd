"""The studies as pictures."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import inf, log
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from solvers.io.figures import COLOURS, panels, save
from solvers.studies.failure_modes.drift import Drift
from solvers.studies.failure_modes.oscillation import Growth
from solvers.studies.failure_modes.singular import Loss
from solvers.studies.failure_modes.stiffness import EXPLICIT, Cost
from solvers.studies.failure_modes.tolerances import Honesty

EPSILON = float(np.finfo(float).eps)


def oscillation(found: Sequence[Growth]) -> Figure:
    """Growth per period over the number of steps in it."""
    figure, (axes,) = panels("Small oscillations grow with every step of Euler's method and of RK2",
                             size=(7, 4.5))  # fmt: skip
    for method, colour in zip(("rk1", "midpoint"), COLOURS, strict=False):
        rows = [g for g in found if g.method == method]
        steps = [g.steps_per_period for g in rows]
        axes.loglog(steps, [g.predicted for g in rows], color=colour, label=f"{method}, from R(z)")
        axes.loglog(steps, [g.measured for g in rows], "o", color=colour, label=f"{method}, run")
    axes.set(xlabel="steps per period", ylabel="logarithm of growth per period")
    axes.legend(frameon=False)
    return figure


def stiffness(found: Sequence[Cost]) -> Figure:
    """Cost over the ratio of frequencies, one panel a family."""
    families = list(dict.fromkeys(cost.family for cost in found))
    figure, axes = panels("Cost of a slow angle within 1e-3 rad after 6 s, beside a fast mode",
                          columns=len(families), size=(13, 4))  # fmt: skip
    methods = list(dict.fromkeys(cost.method for cost in found))
    for panel in axes[1:]:
        panel.sharey(axes[0])
    for panel, family in zip(axes, families, strict=True):
        for method, colour in zip(methods, COLOURS, strict=False):
            rows = [c for c in found if (c.family, c.method) == (family, method)]
            panel.loglog(
                [c.ratio for c in rows], [1e3 * c.work_seconds for c in rows],
                "--" if method in EXPLICIT else "-", marker=".", color=colour, label=method,
            )  # fmt: skip
        panel.set(title=family, xlabel="fast over slow frequency", xlim=(0.7, 1e4))
    axes[0].set_ylabel("time, compiled / ms")
    axes[-1].legend(frameon=False, title="explicit dashed", loc="upper left",
                    bbox_to_anchor=(1, 1))  # fmt: skip
    return figure


def drift(found: Sequence[Drift]) -> Figure:
    """Largest energy error so far over time.

    Parameters
    ----------
    found : sequence of Drift
        Of at most seven methods, as `solvers.studies.failure_modes.drift.study` finds them.

    Returns
    -------
    Figure
        Both axes logarithmic, time in periods of the slow mode.
    """
    figure, (axes,) = panels("Energy over very many periods: lost by Runge-Kutta methods, "
                             "kept by symplectic ones", size=(8, 5))  # fmt: skip
    colours = dict(zip(dict.fromkeys(d.method for d in found), COLOURS, strict=False))
    for d in found:
        axes.loglog(
            d.periods[1:], np.maximum.accumulate(np.abs(d.energy_error))[1:],
            color=colours[d.method], linestyle="-" if d.form == "hamiltonian" else "--",
            label=f"{d.method}, {d.form}, {d.steps_per_period} steps a period",
        )  # fmt: skip
    axes.set(xlabel="periods of the slow mode", ylabel="largest energy error so far, relative")
    axes.legend(frameon=False, fontsize="small", loc="upper left", bbox_to_anchor=(1, 1))
    return figure


def singular(found: Sequence[Loss]) -> Figure:
    """Errors over the mass."""
    figure, (axes,) = panels("Aligned rods, light first mass: what both forms lose", size=(7, 4.5))
    m1 = [s.m1 for s in found]
    for name, label, style, colour in (
        ("acceleration", "Lagrange: accelerations", "o-", COLOURS[0]),
        ("velocity", "Hamilton: velocities", "s-", COLOURS[1]),
        ("lagrangian", "Lagrange: end of a motion", "o:", COLOURS[0]),
        ("hamiltonian", "Hamilton: end of a motion", "s:", COLOURS[1]),
    ):
        axes.loglog(m1, [getattr(s, name) or np.nan for s in found], style, color=colour,
                    label=label)  # fmt: skip
    axes.loglog(m1, [EPSILON * s.condition for s in found], color="#888888",
                label="rounding × condition of M")  # fmt: skip
    axes.set(xlabel="m1 / kg (m2 = 1 kg)", ylabel="error")
    axes.legend(frameon=False)
    return figure


def chaos(found: Mapping[str, Any]) -> Figure:
    """Growth of a difference; horizons seen and predicted.

    Parameters
    ----------
    found : mapping of str
        ``exponent``, ``separation`` and ``horizons`` of `chaos_study`.

    Returns
    -------
    Figure
        Two panels: the difference over time, and horizons over the tolerance, both in s.
    """
    figure, (growth, horizons) = panels("Chaos in the report's motion", columns=2)
    apart, exponent = found["separation"], found["exponent"]
    growth.semilogy(apart.t, apart.distance, color=COLOURS[0], label="two references")
    growth.semilogy(apart.t, apart.predicted, ":", color=COLOURS[1], label="variational equations")
    growth.semilogy(apart.t, 1e-12 * np.exp(exponent.value * apart.t), color="#888888",
                    label=f"exp({exponent.value:.3f} t)")  # fmt: skip
    growth.set(xlabel="time / s", ylabel="distance of two motions", ylim=(1e-13, 100))
    growth.legend(frameon=False)
    rows = found["horizons"]
    for method, colour in zip(dict.fromkeys(h.method for h in rows), COLOURS, strict=False):
        here = [h for h in rows if h.method == method and h.seen < inf]
        horizons.semilogx([h.tolerance for h in here], [h.seen for h in here], "o", color=colour,
                          label=method)  # fmt: skip
    tolerances = sorted({h.tolerance for h in rows})
    predicted = [log(1 / tol) / exponent.value for tol in tolerances]
    horizons.semilogx(tolerances, predicted, color="#888888", label="ln(1/tolerance)/exponent")
    horizons.set(xlabel="tolerance", ylabel="horizon / s")
    horizons.legend(frameon=False)
    return figure


def separatrix(found: Mapping[str, Any]) -> Figure:
    """Growth of errors near upright."""
    figure, (axes,) = panels("Single pendulum released near upright", size=(7, 4.5))
    rows = found["sensitivity"]
    distance = [s.distance for s in rows]
    axes.loglog(distance, [s.amplification for s in rows], "o", color=COLOURS[0],
                label="growth of small errors within 10 s")  # fmt: skip
    axes.loglog(distance, [s.predicted for s in rows], color=COLOURS[0],
                label="frequency / distance: one fall")  # fmt: skip
    axes.set(xlabel="distance from upright / rad", ylabel="factor")
    axes.legend(frameon=False)
    return figure


def tolerances(found: Sequence[Honesty]) -> Figure:
    """Achieved over asked error of every method."""
    figure, (axes,) = panels("Achieved over asked error: medians (dots) and worst of many scenes",
                             size=(9, 4.5))  # fmt: skip
    methods = list(dict.fromkeys(h.method for h in found))
    for k, tolerance in enumerate(dict.fromkeys(h.tolerance for h in found)):
        rows = [h for h in found if h.tolerance == tolerance]
        places = [methods.index(h.method) + 0.15 * (k - 1) for h in rows]
        axes.vlines(places, [h.median for h in rows], [h.worst for h in rows], COLOURS[k])
        axes.plot(places, [h.median for h in rows], "o", color=COLOURS[k],
                  label=f"tolerance {tolerance:.0e}")  # fmt: skip
    axes.axhline(1, color="#888888")
    axes.set(yscale="log", ylabel="error / tolerance", xticks=range(len(methods)))
    axes.set_xticklabels(methods, rotation=45)
    axes.legend(frameon=False, loc="upper left", bbox_to_anchor=(1, 1))
    return figure


#: How each study is drawn.
DRAW: dict[str, Callable[[Any], Figure]] = {
    "oscillation": oscillation,
    "stiffness": stiffness,
    "drift": drift,
    "singular": singular,
    "chaos": chaos,
    "separatrix": separatrix,
    "tolerances": tolerances,
}


def draw(name: str, found: Any, folder: Path) -> Path:
    """Write the picture of a study into `folder`, and say where."""
    path = folder / f"failures_{name}.png"  # scenes have names, too
    save(DRAW[name](found), path)
    return path
