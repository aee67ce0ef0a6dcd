"""Verdicts on the report as plain text."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

from derive.verification.table import table_row, table_width, verdict_rows, wrapped
from derive.verification.verdict import Verdict

Rows = Sequence[Mapping[str, Any]]

MARGIN = 20


def tables(verdicts: Mapping[str, Any]) -> str:
    """Format the verdicts of ``holonomic verify --json`` for the width of the terminal."""
    width = table_width()
    state = ", ".join(f"{name} = {value}" for name, value in verdicts["state"].items())
    lines = [*verdict_rows([Verdict(**row) for row in verdicts["equations"]], width), ""]
    lines += [wrapped(f"Residuals are evaluated at {state}.", width, 0), ""]
    for program in verdicts["programs"]:
        details = [f"solves: {program['solves']}"]
        details += [f"does not run: {reason}" for reason in program["stops"]]
        details += [f"differs: {reason}" for reason in program["differs"]]
        lines += [f"{program['id']:<{MARGIN}}{program['title']}"]
        lines += [*(wrapped(detail, width, MARGIN) for detail in details), ""]
    for claim in verdicts["claims"]:
        details = [claim["number"], *([f"see {claim['figure']}"] if claim["figure"] else [])]
        lines += table_row((claim["id"], claim["verdict"], claim["claim"]), details, width)
    lines += ["", "Lines that end in ... are complete in: holonomic verify --json"]
    lines += [f"equations: {counted(verdicts['equations'])}"]
    lines += [f"claims:    {counted(verdicts['claims'])}"]
    return "\n".join(lines) + "\n"


def counted(rows: Rows) -> str:
    """Count the verdicts: ``150 (119 verified, …)``."""
    counts = Counter(row["verdict"] for row in rows).most_common()
    return f"{len(rows)} ({', '.join(f'{n} {name}' for name, n in counts)})"
