"""Verdicts as plain text, for people."""

from __future__ import annotations

import shutil
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from textwrap import fill, shorten
from typing import Any

Rows = Sequence[Mapping[str, Any]]

COLUMN = 20


def tables(verdicts: Mapping[str, Any]) -> str:
    """The verdicts on equations, programs and claims as three tables.

    Parameters
    ----------
    verdicts : mapping
        ``equations``, ``programs`` and ``claims`` as ``holonomic verify --json`` prints
        them, and ``state``, where the witnesses were computed.

    Returns
    -------
    str
        Wrapped to the width of the terminal, and to 120 characters at most.
    """
    width = min(shutil.get_terminal_size((100, 24)).columns, 120)
    lines = [*_equations(verdicts["equations"], width), ""]
    state = ", ".join(f"{name} = {value}" for name, value in verdicts["state"].items())
    lines += [_wrapped(f"Residuals as numbers: at {state}.", width, 0), ""]
    for program in verdicts["programs"]:
        lines.append(f"{program['id']:<{COLUMN}}{program['title']}")
        lines.append(_wrapped(f"solves: {program['solves']}", width))
        lines += [_wrapped(f"stops on: {reason}", width) for reason in program["stops"]]
        lines += [_wrapped(f"differs: {reason}", width) for reason in program["differs"]]
        lines.append("")
    for claim in verdicts["claims"]:
        lines.append(_row(claim["id"], claim["verdict"], claim["claim"], width))
        lines.append(_wrapped(claim["number"], width))
        if claim["figure"]:
            lines.append(_wrapped(f"see {claim['figure']}", width))
    lines += ["", "Lines that end in ... are whole in: holonomic verify --json"]
    lines += [f"equations: {counted(verdicts['equations'])}"]
    lines += [f"claims:    {counted(verdicts['claims'])}"]
    return "\n".join(lines) + "\n"


def counted(rows: Rows) -> str:
    """How many rows have which verdict: ``150, of them 119 verified, …``."""
    counts = Counter(row["verdict"] for row in rows)
    return f"{len(rows)}, of them " + ", ".join(f"{n} {name}" for name, n in counts.most_common())


def _equations(rows: Rows, width: int) -> Iterable[str]:
    for row in rows:
        if not row["correction"]:
            yield _row(row["id"], row["verdict"], row["printed"], width)
        else:
            yield (
                f"{row['id']:<7}{row['verdict']:<{COLUMN - 7}}"
                + _wrapped(f"printed: {row['printed']}", width).lstrip()
            )
            yield _wrapped(f"should be: {row['correction']}", width)
            yield _wrapped(f"residual: {row['residual']} = {row['witness']}", width)
        if row["note"]:
            yield _wrapped(f"note: {row['note']}", width)


def _row(name: str, verdict: str, text: str, width: int) -> str:
    return f"{name:<7}{verdict:<{COLUMN - 7}}" + shorten(text, width - COLUMN, placeholder=" ...")


def _wrapped(text: str, width: int, margin: int = COLUMN) -> str:
    return fill(
        text, width, initial_indent=" " * margin, subsequent_indent=" " * (margin + 2),
        break_long_words=False, break_on_hyphens=False,
    )  # fmt: skip
