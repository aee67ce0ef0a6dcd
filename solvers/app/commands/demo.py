"""``holonomic demo``."""

import time
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Sequence
from itertools import zip_longest
from textwrap import TextWrapper

from solvers.app.commands import options

SUMMARY = "all stages for the double pendulum, on one page"
#: Width of the terminal text, and of its left column.
COLUMNS, MARGIN = 80, 13


def add_arguments(parser: ArgumentParser) -> None:
    """Describe the command and its arguments."""
    parser.description = (
        "Derive, verify, generate, integrate and measure the double pendulum; print the results "
        "of each stage and write all of them to one page."
    )
    options.add_output(parser, "the page")
    options.add_examples(parser, "holonomic demo --output out")


def run(arguments: Namespace) -> int:
    """Run every stage once, print its results and write the page."""
    from solvers.app.demo.demo_page import LIVE_PAGE, stages, versions, write_page
    from solvers.app.live_page import LivePage
    from solvers.io.terminal import Progress

    arguments.output.mkdir(parents=True, exist_ok=True)  # before the work, not after it
    print("Double pendulum: from the positions of two bobs to their motion.\n")
    results = {}
    for number, (name, stage) in enumerate(stages(arguments.output).items(), 1):
        start = time.perf_counter()
        with Progress() as report:
            report(name)
            results[name] = stage()
        seconds = time.perf_counter() - start
        lines = _in_two_columns(f"{number} {name}", f"{seconds:7.1f} s", results[name].lines)
        print(*lines, sep="\n", flush=True)
    page = arguments.output / "demo.html"
    write_page(page, results, versions())
    LivePage("report").write(arguments.output / LIVE_PAGE)
    print(f"\npage: {page}, and {LIVE_PAGE}, which integrates while it is open")
    return 0


def _in_two_columns(name: str, seconds: str, paragraphs: Sequence[str]) -> Iterator[str]:
    """Lines of text, with a name and a time to the left of them."""
    wrapper = TextWrapper(COLUMNS - MARGIN, subsequent_indent="  ")
    wrapper.break_long_words = wrapper.break_on_hyphens = False
    lines = [line for paragraph in paragraphs for line in wrapper.wrap(paragraph)]
    for left, line in zip_longest((name, seconds), lines, fillvalue=""):
        yield f"{left:<{MARGIN}}{line}".rstrip()
