"""Frontiers and findings as text."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import isfinite

from solvers.studies.work_precision.findings import Charted, Turning
from solvers.studies.work_precision.frontier import Best

#: What the frontier is compared with, where it is not chosen itself, and short words for it.
COMPARED = {
    ("method", "rk4"): "rk4",
    ("form", "lagrangian"): "lagr.",
    ("form", "hamiltonian"): "hamilt.",
    ("backend", "compiled"): "compiled",
    ("backend", "python"): "python",
    ("backend", "scipy"): "scipy",
    ("backend", "heyoka"): "heyoka",
    ("backend", "numbalsoda"): "nsoda",
    ("backend", "numba"): "numba",
    ("backend", "diffrax"): "diffrax",
}


def told(charted: Charted) -> Iterator[str]:
    """A scene's reference, frontier and findings."""
    truth, rows = charted.reference, charted.frontier
    yield f"{charted.scene.title}, {charted.scene.duration:g} s"
    others = "; ".join(f"{name} {apart:.1e}" for name, apart in truth.apart.items())
    yield f"reference: {truth.METHOD}, own error {truth.global_error:.1e}; apart from it: {others}"
    shown = [c for c in COMPARED if any(c[1] in row.worth[c[0]] for row in rows)]
    yield "the cheapest for each error, and how many times as long the best with ... takes:"
    heads = "".join(f"{COMPARED[choice]:>9}" for choice in shown)
    yield f"{'error':>6} {'seconds':>9}{'calls':>7}  {'cheapest':<20}{heads}"
    for row in rows:
        yield _row(row, shown)
    calls = [row for row in charted.frontier_rhs if row.backend != "numba"]
    yield "in calls of the right-hand side: " + ", ".join(
        f"{row.global_error:.0e}: {row.work_rhs:.0f} ({row.method})" for row in calls[::3]
    )
    for turning in charted.turnings:
        yield _turning(turning)
    found = charted.misled
    if found:
        setting = ", ".join(f"{name} = {value:.2g}" for name, value in found.setting.items())
        yield (
            f"energy is no proof: {found.method}, {found.form}, {setting}: energy kept to "
            f"{found.energy_error:.0e}, end wrong by {found.global_error:.2g} rad or rad/s"
        )


def _turning(turning: Turning) -> str:
    if not isfinite(turning.order):
        return f"{turning.method}: no order to be seen, least error {turning.global_error:.1e}"
    falls = f"{turning.method}: error falls as h^{turning.order:.2f} to {turning.global_error:.1e}"
    if turning.finest_error < 2 * turning.global_error:
        return f"{falls} at the shortest step, {turning.finest:.1e} s"
    return (
        f"{falls} at h = {turning.h:.1e} s; rounding makes it {turning.finest_error:.1e} at "
        f"{turning.finest:.1e} s"
    )


def _row(row: Best, shown: Sequence[tuple[str, str]]) -> str:
    factors = (row.worth[choice].get(value) for choice, value in shown)
    cells = "".join(f"{'-' if f is None else f'{f:.3g}':>9}" for f in factors)
    seconds = f"{row.work_seconds * 1e6:.1f} us"
    calls = f"{row.work_rhs:.0f}" if row.work_rhs == row.work_rhs else "-"
    name = f"{row.method}, {row.form if row.backend == 'compiled' else row.backend}"
    return f"{row.global_error:>6.0e} {seconds:>9}{calls:>7}  {name:<20}{cells}"
