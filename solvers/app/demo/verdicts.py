"""The verdicts on the report, as a part of the page."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

from solvers.app.demo.html import opened, table

WORDS = {
    "verified": "hold as printed", "misprint": "are misprints, each with a proved correction",
    "definition": "are definitions", "context": "concern fluids", "wrong": "are wrong",
    "supported": "hold", "contradicted": "do not", "untestable": "cannot be tested",
}  # fmt: skip


def verdicts(judged: Mapping[str, Any], misprints: Sequence[str]) -> str:
    """Counts, and on demand every misprint and every claim.

    Parameters
    ----------
    judged : mapping
        As ``holonomic verify --json`` prints it.
    misprints : sequence of str
        HTML of each wrong line and its correction.

    Returns
    -------
    str
        HTML, a part of the page.
    """
    claims = [(c["id"], c["claim"], c["verdict"], c["number"]) for c in judged["claims"]]
    programs = [
        (f"program {k}", "; ".join(program["stops"]) or "runs as printed")
        for k, program in enumerate(judged["programs"], 1)
    ]
    return (
        f"<p>Of {len(judged['equations'])} equations {_counted(judged['equations'])}. Of "
        f"{len(claims)} objectives, claims and recommendations {_counted(judged['claims'])}.</p>"
        + opened("Every misprint, and what should be there", "".join(misprints))
        + opened("Every claim", table(("", "claim", "verdict", "because"), claims))
        + opened("The three programs", table(("", "as printed"), programs))
    )


def _counted(rows: Sequence[Mapping[str, Any]]) -> str:
    counts = Counter(row["verdict"] for row in rows).most_common()
    return ", ".join(f"<strong>{n}</strong> {escape(WORDS[verdict])}" for verdict, n in counts)
