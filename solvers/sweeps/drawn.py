"""Pictures of sweeps: maps in colours that suit what they hold, curves and Poincaré's sections."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import product
from math import ceil
from typing import Any, TypeAlias

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, MultipleLocator
from numpy.typing import NDArray

from solvers.answers.drawn import symbol
from solvers.pictures import COLOURS, panels
from solvers.sweeps.axes import Grid
from solvers.sweeps.barrier import barrier, energies
from solvers.sweeps.maps import EnergyError, First, Lyapunov, Map, Samples, Section
from solvers.sweeps.results import Results
from solvers.sweeps.sweep import ENERGY
from solvers.sweeps.work import PROVED, Job, begun

Array: TypeAlias = NDArray[np.float64]

#: Pixels along each side of a map that are drawn, and of the energy's boundary.
PIXELS, BOUNDARY = 2048, 400
#: Curves that are drawn, and points of a section.
CURVES, POINTS = 60, 200_000
#: Panels at most.
MOST = 12
#: Where nothing happened or nothing is known, and where it is proved that nothing can happen.
NOTHING, NEVER = "#c8c8c8", "#ffffff"
#: A map shows values between these percentiles, and colours those beyond like them.
SHOWN = (0.5, 99.5)


def drawn(results: Results) -> Figure:
    """All maps of a sweep, a panel or more each."""
    found = list(_pictures(results))[:MOST]
    columns = min(3, len(found))
    rows = ceil(len(found) / columns)
    asked = results.asked
    figure, axes = panels(
        asked.title, rows=rows, columns=columns,
        size=(max(6.4, 5.4 * columns), 4.9 * rows + 0.5),
    )  # fmt: skip
    for panel, (title, draw) in zip(axes, found, strict=False):
        draw(panel)
        if len(found) > 1:
            panel.set_title(title, fontsize="medium")
    for panel in axes[len(found) :]:
        panel.set_axis_off()
    figure.supxlabel(_note(results), x=0.01, ha="left", fontsize="small", color="#444444")
    return figure


def _note(results: Results) -> str:
    """What the colours do not say."""
    asked, count = results.asked, results.count
    words = []
    if any(isinstance(one, First) for one in asked.maps.values()):
        words += ["white: too little energy for it", f"grey: not within {asked.duration:g} s"]
    others = ("finished", "event", "proved")
    words += [f"{name}: {n:,} motions" for name, n in count.items() if name not in others]
    return "; ".join(words)


def _pictures(results: Results) -> Iterator[tuple[str, Any]]:
    """What each panel is called, and what draws it."""
    for name, one in results.asked.maps.items():
        if isinstance(one, Section):
            for where, chosen in _groups(results):
                yield (
                    where,
                    lambda panel, one=one, name=name, chosen=chosen: _section(
                        panel, results, name, one, chosen
                    ),
                )
        elif isinstance(one, Samples):
            for k, component in enumerate(one.of):
                yield (
                    f"{name}: {symbol(component)}",
                    lambda panel, k=k, one=one, name=name: _curves(panel, results, name, one, k),
                )
        else:
            for place in product(*map(range, one.shape)):
                said = [labels[k] for labels, k in zip(one.labels, place, strict=True)]
                words = " ".join([name, *(symbol(part) for part in said)])
                yield (
                    words,
                    lambda panel, place=place, one=one, name=name, said=said: _map(
                        panel, results, name, one, place, said
                    ),
                )


def _map(
    panel: Axes, results: Results, name: str, one: Map, place: tuple[int, ...], said: list[str]
) -> None:
    """One number of each motion: an image over two axes, a curve over one, or points."""
    cut: Any = (..., *place)
    values = results.maps[name][cut]
    module = results.asked.module
    unit = module.UNITS[said[0]] if said else one.unit(module)
    label = f"{_words(one, name)} / {_in_brackets(unit)}"
    axes = results.axes
    if len(axes) == 1 or not isinstance(results.asked.axes, Grid):
        first, *others = axes
        if len(others) == 1:
            colours, norm = _colours(one, values, unit)
            points = panel.scatter(
                axes[first], axes[others[0]], c=_wrapped(values, unit), s=4, cmap=colours, norm=norm
            )
            panel.figure.colorbar(points, ax=panel, label=label)
            _labelled(panel, results, first, others[0])
        else:
            panel.plot(axes[first], values, ".-" if len(values) < CURVES else "-",
                       color=COLOURS[0], linewidth=0.9, markersize=3)  # fmt: skip
            _labelled(panel, results, first)
            panel.set_ylabel(label)
        return
    _image(panel, results, one, values, unit, label)


def _image(
    panel: Axes, results: Results, one: Map, values: Array, unit: str, label: str
) -> None:  # fmt: skip
    (x, xs), (y, ys), *rest = results.axes.items()
    middle = tuple(len(axis) // 2 for _, axis in rest)
    steps = [max(1, -(-len(axis) // PIXELS)) for axis in (xs, ys)]
    cut: Any = (slice(None, None, steps[0]), slice(None, None, steps[1]), *middle)
    values, status = np.asarray(values[cut]), np.asarray(results.status[cut])
    colours, norm = _colours(one, values, unit)
    panel.set_facecolor(NOTHING)
    extent = [*_edges(xs), *_edges(ys)]
    wrapped = np.ma.masked_invalid(_wrapped(values, unit).T)
    seen: dict[str, Any] = {
        "origin": "lower", "extent": extent, "aspect": "auto", "interpolation": "nearest",
    }  # fmt: skip
    image = panel.imshow(wrapped, cmap=colours, norm=norm, **seen)
    never = np.ma.masked_equal(status.T == PROVED, False)
    panel.imshow(never, cmap=mpl.colors.ListedColormap([NEVER]), **seen)
    if isinstance(one, First) and one.barrier:
        _boundary(panel, results, one, {x: xs, y: ys}, {k: v[len(v) // 2] for k, v in rest})
    panel.figure.colorbar(image, ax=panel, label=label)
    _labelled(panel, results, x, y)
    if rest:
        panel.text(0.02, 0.02, ", ".join(f"{_letter(k)} = {v[len(v) // 2]:.4g}" for k, v in rest),
                   transform=panel.transAxes, fontsize="small")  # fmt: skip


def _boundary(
    panel: Axes, results: Results, one: First, axes: Mapping[str, Array],
    rest: Mapping[str, float],
) -> None:  # fmt: skip
    """The line below which energy forbids the event."""
    asked = results.asked
    fine = {name: np.linspace(*_edges(values), BOUNDARY) for name, values in axes.items()}
    columns = Grid(fine).columns(0, BOUNDARY**2)
    columns |= {name: np.full(BOUNDARY**2, value) for name, value in rest.items()}
    state, params, _ = begun(Job.of(asked), asked.module, columns)
    left = energies(asked.module, state, params)
    left -= barrier(asked.module, one.barrier, params, len(state))
    across, upwards = fine.values()
    panel.contour(across, upwards, left.reshape(BOUNDARY, BOUNDARY).T, [0.0], colors="#D55E00",
                  linewidths=1.2)  # fmt: skip


def _colours(one: Map, values: Array, unit: str) -> tuple[str, Normalize]:
    """Colours and their range: cyclic for angles, logarithmic for times and errors."""
    finite = values[np.isfinite(values)]
    if not finite.size:
        return "viridis", Normalize(0, 1)
    if isinstance(one, First | EnergyError):
        positive = np.abs(finite[finite != 0])
        low, high = np.percentile(positive, SHOWN) if positive.size else (1e-17, 1.0)
        return ("viridis_r" if isinstance(one, First) else "magma"), LogNorm(low, max(high, low))
    if unit == "rad":
        return "twilight", Normalize(-np.pi, np.pi)
    low, high = np.percentile(finite, SHOWN)
    if isinstance(one, Lyapunov):
        return "magma", Normalize(min(low, 0.0), high)
    if low < 0 < high:
        return "RdBu_r", Normalize(-max(-low, high), max(-low, high))
    return "viridis", Normalize(low, high)


def _wrapped(values: Array, unit: str) -> Array:
    """Angles between -π and π; errors without their sign."""
    if unit == "rad":
        return np.asarray(np.remainder(values + np.pi, 2 * np.pi) - np.pi)
    return np.abs(values) if unit == "J" else np.asarray(values)


def _words(one: Map, name: str) -> str:
    known = {First: "time", Lyapunov: "Lyapunov's exponent", EnergyError: "energy error"}
    return known.get(type(one), name)


def _groups(results: Results) -> Iterator[tuple[str, Any]]:
    """Motions that belong in one section: of one energy and one set of parameters."""
    axes = results.axes
    if not isinstance(results.asked.axes, Grid):
        yield "", ...
        return
    apart = [
        k for k, name in enumerate(axes)
        if name == ENERGY or name in results.asked.module.PARAMETERS
    ]  # fmt: skip
    names = list(axes)
    for place in product(*(range(len(axes[names[k]])) for k in apart)):
        chosen: list[Any] = [slice(None)] * len(names)
        for k, number in zip(apart, place, strict=True):
            chosen[k] = number
        yield (
            ", ".join(
                f"{_letter(names[k])} = {axes[names[k]][number]:.4g} {results.unit(names[k])}"
                for k, number in zip(apart, place, strict=True)
            ),
            tuple(chosen),
        )


def _section(panel: Axes, results: Results, name: str, one: Section, chosen: Any) -> None:
    inner = len(one.shape)
    motions = results.maps[name][chosen]
    motions = motions.reshape(-1, *motions.shape[-inner:])
    each = max(1, -(-motions.shape[0] * one.count // POINTS))
    across, upwards = motions[:, 0, ::each], motions[:, min(1, len(one.of) - 1), ::each]
    colours = mpl.colormaps["turbo"](np.linspace(0.05, 0.95, len(motions)))
    units = [results.asked.module.UNITS[component] for component in (one.of * 2)[:2]]
    for x, y, colour in zip(across, upwards, colours, strict=True):
        panel.plot(_wrapped(x, units[0]), _wrapped(y, units[1]), ".", color=colour,
                   markersize=0.9, markeredgewidth=0)  # fmt: skip
    for axis, component in (("x", one.of[0]), ("y", one.of[min(1, len(one.of) - 1)])):
        unit = _in_brackets(results.asked.module.UNITS[component])
        panel.set(**{f"{axis}label": f"{symbol(component)} / {unit}"})


def _curves(panel: Axes, results: Results, name: str, one: Samples, k: int) -> None:
    inner = len(one.shape)
    motions = results.maps[name].reshape(-1, *results.maps[name].shape[-inner:])
    t = np.linspace(0, results.asked.duration, one.count)
    shown = motions[:: max(1, -(-len(motions) // CURVES)), k]
    colours = mpl.colormaps["viridis"](np.linspace(0, 0.9, len(shown)))
    for y, colour in zip(shown, colours, strict=True):
        panel.plot(t, y, color=colour, linewidth=0.7)
    unit = _in_brackets(results.asked.module.UNITS[one.of[k]])
    panel.set(xlabel="$t$ / s", ylabel=f"{symbol(one.of[k])} / {unit}")


def _edges(values: Array) -> tuple[float, float]:
    """Where the first and the last pixel of an axis end."""
    half = (values[-1] - values[0]) / max(len(values) - 1, 1) / 2 or 0.5
    return float(values[0] - half), float(values[-1] + half)


def _labelled(panel: Axes, results: Results, x: str, y: str | None = None) -> None:
    for axis, name in (("x", x), ("y", y)):
        if name is None:
            continue
        unit = results.unit(name)
        panel.set(**{f"{axis}label": f"{_letter(name)} / {_in_brackets(unit)}"})
        if unit == "rad" and np.ptp(results.axes[name]) > np.pi:
            ticks = getattr(panel, f"{axis}axis")
            ticks.set_major_locator(MultipleLocator(np.pi / 2))
            ticks.set_major_formatter(FuncFormatter(_halves_of_pi))


def _letter(name: str) -> str:
    return "$E$" if name == ENERGY else symbol(name)


def _halves_of_pi(value: float, _: int) -> str:
    n = round(value / (np.pi / 2))
    whole, sign = abs(n) // 2, "−" if n < 0 else ""
    if n % 2 == 0:
        return "0" if n == 0 else f"{sign}{whole if whole > 1 else ''}π"
    return f"{sign}{abs(n) if abs(n) > 1 else ''}π/2"


def _in_brackets(unit: str) -> str:
    return f"({unit})" if "/" in unit else unit
