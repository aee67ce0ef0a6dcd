"""The benchmark's figures as a table or JSON."""

from __future__ import annotations

import argparse
import json
import platform
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from solvers.equations.module import GeneratedModule
from solvers.io.figures import save
from solvers.io.json_values import jsonable
from solvers.studies.benchmarks import chains_summary, curves, maps, pipeline, rates
from solvers.studies.benchmarks.growth import Maker, drawn

#: What can be timed.
PARTS = ("pendulum", "way", "chains", "maps")
#: Global errors at which both sides are compared.
ERRORS = (1e-3, 1e-6, 1e-9, 1e-12)


def main(
    argv: Sequence[str],
    module: Callable[[str], GeneratedModule],
    lambdify: Callable[[], Any],
    peer: Callable[[str], GeneratedModule],
    made: Maker,
    rival: Callable[[int], float],
    mechanics: Callable[[int], Any],
) -> int:
    """Measure and print.

    Parameters
    ----------
    argv : sequence of str
        Options.
    module : callable
        Gives the generated module of a system.
    lambdify : callable
        Gives SymPy's function for the double pendulum's right-hand side.
    peer : callable
        Gives another program's package.
    made, rival : callable
        Derive a chain of pendulums here, and with SymPy's own mechanics.
    mechanics : callable
        Gives its equations.

    Returns
    -------
    int
        The exit code, 0.
    """
    parser = argparse.ArgumentParser(
        prog="holonomic bench",
        description="Time compiled loops beside other programs, at equal global error. "
        "Leave the machine alone meanwhile: it takes about ten minutes.",
        epilog="examples:\n  holonomic bench --json > figures.json\n  holonomic bench chains",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--json", action="store_true", help="print figures for programs")
    parser.add_argument(
        "--output", type=Path, default=Path("out"), metavar="DIR",
        help="folder for the picture of growth (default: out)",
    )  # fmt: skip
    parser.add_argument(
        # argparse compares an empty list, too, with the choices
        "parts", nargs="*", choices=[*PARTS, []], metavar="PART",
        help=f"what to time, of {', '.join(PARTS)}; default: all",
    )  # fmt: skip
    arguments = parser.parse_args(argv)
    hy, found = peer("heyoka"), {}
    if "pendulum" in (arguments.parts or PARTS):
        found["pendulum"] = figures(module("double_pendulum"), lambdify(), hy)
        if not arguments.json:
            print(text(found["pendulum"]))
    if "way" in (arguments.parts or PARTS):
        ways = pipeline.ways(module("double_pendulum"), peer, made, mechanics)
        found["way"] = jsonable(ways)
        if not arguments.json:
            print(*pipeline.told(ways), "", sep="\n")
    if "chains" in (arguments.parts or PARTS):
        found["chains"] = chains_summary.figures(made, rival, module, hy)
        save(drawn(found["chains"]["growth"]), arguments.output / "growth.png")
        if not arguments.json:
            print(*chains_summary.told(found["chains"]), sep="\n")
            print(f"picture: {arguments.output / 'growth.png'}")
    if "maps" in (arguments.parts or PARTS):
        found["maps"] = maps.figures(module("double_pendulum"), hy, peer("numba"))
        if not arguments.json:
            print(*maps.told(found["maps"]), sep="\n")
    if arguments.json:
        print(json.dumps(found, indent=2))
    return 0


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
