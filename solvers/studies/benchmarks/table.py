"""The benchmark's figures as a table or JSON."""

from __future__ import annotations

import platform
from collections.abc import Callable, Mapping
from typing import Any

from solvers.equations.module import GeneratedModule
from solvers.studies.benchmarks import curves, rates

#: Global errors at which both sides are compared.
ERRORS = (1e-3, 1e-6, 1e-9, 1e-12)


def figures(module: GeneratedModule, lambdified: Callable[..., object], hy: Any) -> dict[str, Any]:
    """All figures, in seconds and operations a second."""
    return {
        "machine": f"{platform.machine()}, Python {platform.python_version()}",
        "peers": {"heyoka": hy.__version__},
        "one motion": _compared(curves.one_motion(module, hy)),
        "many motions": _compared(curves.many_motions(module, hy)),
        "right-hand side in Python": rates.calls(module, lambdified),
        "operations a second": rates.peak_share(module),
        "preparation": rates.preparation(module, hy),
    }


def _compared(found: Mapping[str, curves.Curve]) -> list[dict[str, Any]]:
    """At each error the cheapest of our methods, and by what factor others take longer."""
    rows = []
    for error in ERRORS:
        ours = {name: found[name].at(error) for name in curves.METHODS}
        method = min((name for name in ours if ours[name] > 0), key=ours.__getitem__)
        peers = {name: curve.at(error) for name, curve in found.items() if name not in ours}
        rows.append({
            "global_error": error, "method": method, "seconds": ours[method],
            "peers": {name: seconds for name, seconds in peers.items() if seconds > 0},
            "ratios": {name: seconds / ours[method] for name, seconds in peers.items()
                       if seconds > 0},
        })  # fmt: skip
    return rows


def text(found: Mapping[str, Any]) -> str:
    """The figures as tables."""
    lines = [f"{found['machine']}; heyoka {found['peers']['heyoka']}", ""]
    for title, part in (
        ("One motion: the report's scene, 5 s", "one motion"),
        (f"{curves.MOTIONS} motions from rest, 5 s: one of them, on one core", "many motions"),
    ):
        names = list(dict.fromkeys(name for row in found[part] for name in row["ratios"]))
        lines.append(f"{title}. Times as long as holonomic, at equal global error:")
        parts = [(*name.split(", "), "")[:2] for name in names]
        lines.append(" " * 29 + "".join(f"{first:>11}" for first, _ in parts))
        lines.append(f"{'error':>8}  {'holonomic':<19}" + "".join(f"{n:>11}" for _, n in parts))
        for row in found[part]:
            ours = f"{row['seconds'] * 1e6:5.1f} us {row['method']}"
            others = "".join(f"{_ratio(row['ratios'].get(name)):>11}" for name in names)
            lines.append(f"{row['global_error']:>8.0e}  {ours:<19}{others}")
        lines.append("")
    call = found["right-hand side in Python"]
    lines.append(
        f"Right-hand side in Python, one state: {call['holonomic'] * 1e6:.2f} us; "
        f"lambdify with NumPy takes {call['lambdify'] / call['holonomic']:.1f} times as long."
    )
    speeds = dict(found["operations a second"])
    peak = speeds.pop("peak")
    lines.append(f"Multiply-add peak of one core: {peak / 1e9:.0f}e9 operations a second.")
    lines += [
        f"  {name}: {rate / 1e9:.0f}e9, {rate / peak:.0%} of it" for name, rate in speeds.items()
    ]
    lines.append("Left out above, once for each system and method:")
    lines += [f"  {name}: {seconds:.2f} s" for name, seconds in found["preparation"].items()]
    return "\n".join(lines) + "\n"


def _ratio(ratio: float | None) -> str:
    return "-" if ratio is None else f"{ratio:.3g}"
