"""``holonomic demo``: the whole way, on one screen and on one page."""

from __future__ import annotations

import argparse
import platform
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from datetime import date
from importlib.metadata import version
from itertools import zip_longest
from pathlib import Path
from textwrap import wrap

from solvers.app.demo.cost import cost
from solvers.app.demo.flips import flips
from solvers.app.demo.limits import limits
from solvers.app.demo.motion import motion
from solvers.app.demo.page import write_demo
from solvers.app.demo.station import Station
from solvers.equations.module import GeneratedModule
from solvers.integration.prepare import no_compiler
from solvers.io.progress import Progress
from solvers.scenes import shipped
from solvers.sweeps import reading

#: How wide the screen is, and where its lines begin.
COLUMNS, MARGIN = 80, 13
WIDTH = COLUMNS - MARGIN
#: What the page is made with.
PACKAGES = ("holonomic", "sympy", "numpy", "scipy", "matplotlib")


def main(
    argv: Sequence[str], module: Callable[[str], GeneratedModule],
    derived: Mapping[str, Callable[[], Station]], style: str,
) -> int:  # fmt: skip
    """Do everything once, print what comes of it and write the page.

    Parameters
    ----------
    argv : sequence of str
        Options.
    module : callable
        Gives a generated module by its name.
    derived : mapping of str to callables
        The stations before there is code.
    style : str
        How their part of the page looks, as CSS.

    Returns
    -------
    int
        Exit code 0; what goes wrong is raised.
    """
    parser = argparse.ArgumentParser(
        prog="holonomic demo",
        description="Derive, verify, generate, integrate and measure the double pendulum; show "
        "each step, and all of them on one page.",
        epilog="example:\n  holonomic demo --output out",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--output", type=Path, default=Path("out"), metavar="DIR",
        help="folder for the page (default: out)",
    )  # fmt: skip
    output = parser.parse_args(argv).output
    output.mkdir(parents=True, exist_ok=True)  # before the work, not after it
    print("Double pendulum: from the positions of two bobs to their motion.\n")
    scene = shipped.find("report", module)
    stations: dict[str, Callable[[], Station]] = {
        **derived,
        "integrate": lambda: motion(scene),
        "chart": lambda: cost(scene),
        "stability": lambda: limits(scene),
        "map": lambda: flips(reading.find("flips", module), output / "flips"),
    }
    found = {}
    for number, (name, station) in enumerate(stations.items(), 1):
        start = time.perf_counter()
        with Progress() as tell:
            tell(name)
            if name == "map" and (missing := no_compiler(scene.module)):
                print(f"{number} {name:<11}left out: {missing}")
                continue
            found[name] = station()
        print(*_beside(f"{number} {name}", time.perf_counter() - start, found[name].lines),
              sep="\n", flush=True)  # fmt: skip
    page = output / "demo.html"
    write_demo(page, found, made(), style)
    print(f"\nall of it on one page: {page}")
    return 0


def _beside(name: str, seconds: float, words: Sequence[str]) -> Iterator[str]:
    """Lines no wider than a screen, with a name and a time to the left of them."""
    lines = [part for line in words for part in _wrapped(line)]
    for left, line in zip_longest((name, f"{seconds:7.1f} s"), lines, fillvalue=""):
        yield f"{left:<{MARGIN}}{line}".rstrip()


def _wrapped(line: str) -> list[str]:
    return wrap(line, WIDTH, subsequent_indent="  ", break_long_words=False,
                break_on_hyphens=False)  # fmt: skip


def made() -> dict[str, str]:
    """When, where and with what."""
    return {
        "date": date.today().isoformat(),
        "machine": f"{platform.system()} {platform.machine()}",
        "Python": platform.python_version(),
        **{name: version(name) for name in PACKAGES},
    }
