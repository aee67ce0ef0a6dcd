"""Text and figures that describe the results of a sweep."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from solvers.runge_kutta.method_catalogue import load
from solvers.sweeps.execution.sweep_run import Convergence, tighter_rtol
from solvers.sweeps.results import Results

#: Advice on other motions.
HINTS = {
    "step limit": "raise max_steps",
    "step too small": "a singularity, most likely",
    "not done yet": "the same command without --draw resumes",
}


def summary(
    results: Results, seconds: float | None, changes: Mapping[str, Convergence]
) -> Iterator[str]:
    """Lines of text: the sweep, status of the motions, ranges of the maps, and convergence."""
    definition = results.definition
    yield definition.title
    time = "" if seconds is None else f"; this run took {seconds:.3g} s"
    yield (
        f"{definition.motions:,} motions of {definition.extent}, "
        f"{load(definition.method).title}, {definition.form} form, rtol = {definition.rtol:g}{time}"
    )
    hints = {name: f" ({hint})" for name, hint in HINTS.items()}
    counts = (f"{name} {n:,}{hints.get(name, '')}" for name, n in results.count.items())
    yield f"status: {', '.join(counts)}"
    for name, records in results.records.items():
        yield from (
            f"{name} {record['number']}: {_attractor(results, record)}" for record in records
        )
    for name, values in ranges(results).items():
        if name in results.records:
            continue
        if not values["known"]:
            yield f"{name}: no values"
            continue
        low, middle, high = values["smallest"], values["median"], values["largest"]
        unit = values["unit"] and f" {values['unit']}"
        map_name, *parts = name.split(" ")  # `parts`: component, then extreme
        label = f"{map_name}, {' '.join(reversed(parts))}" if parts else map_name
        yield (
            f"{label}: {low:.6g} to {high:.6g}{unit}, median {middle:.6g}{unit}; "
            f"{values['known']:.1%} of the map has values"
        )
    for name, change in changes.items():
        one = definition.maps[name]
        unit = one.unit(definition.module)
        unit, name = unit and f" {unit}", f"states of {name}" if one.records else name
        lost = f"; {change.lost:.0%} exist with one tolerance only" if change.lost else ""
        yield (
            f"{name}: of {change.motions} motions repeated with rtol = "
            f"{tighter_rtol(definition):g}, half change by less than {change.median:.1g}{unit}, "
            f"90 % by less than {change.most:.1g}{unit}{lost}"
        )


def _attractor(results: Results, record: Mapping[str, Any]) -> str:
    """An attractor in words."""
    states = ", ".join(f"{name} = {value:.4g}" for name, value in record["states"][0].items())
    turns = "".join(f", {n} turns of {q}" for q, n in record["turns"].items() if n)
    share = record["motions"] / results.definition.motions
    return f"{record['kind']}{turns}, {states}; {share:.1%} of the motions"


def ranges(results: Results) -> dict[str, dict[str, Any]]:
    """Smallest, median and largest value of each map, or of each of its labelled parts."""
    statistics, module = {}, results.definition.module
    for name, one in results.definition.maps.items():
        rows = results.maps[name].reshape(-1, *one.shape)
        for index in np.ndindex(*map(len, one.labels)):
            labels = [part[k] for part, k in zip(one.labels, index, strict=True)]
            values = rows[(slice(None), *index)]
            finite = values[np.isfinite(values)]
            known = np.percentile(finite, (0, 50, 100)).tolist() if finite.size else [np.nan] * 3
            numbers = dict(zip(("smallest", "median", "largest"), known, strict=True))
            unit, share = one.unit(module, *labels[:1]), finite.size / values.size
            statistics[" ".join([name, *labels])] = {**numbers, "unit": unit, "known": share}
    return statistics


def as_json(results: Results, seconds: float, changes: Mapping[str, Convergence]) -> dict[str, Any]:
    """The same as `summary` for programs."""
    definition = results.definition
    return {
        "sweep": definition.name,
        "folder": str(results.folder),
        "definition": definition.as_json,
        "motions": definition.motions,
        "seconds": seconds,
        "status": results.count,
        "maps": ranges(results),
        "records": results.records,
        "convergence": changes,
    }
