"""The verdicts on the report, for the terminal and for the page."""

from collections import Counter
from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

from derive.verification.judging.verdict import Verdict
from derive.verification.report.derivation_beside_report import verdict_html
from solvers.app.demo.stage import ReportedNumber, Stage, details, table
from solvers.app.verdict.report import counted, report_verdicts

Rows = Sequence[Mapping[str, Any]]

DESCRIPTIONS = {
    "verified": "hold as printed",
    "misprint": "are misprints, each with a proved correction",
    "definition": "are definitions",
    "context": "concern fluids",
    "wrong": "are wrong",
    "supported": "hold",
    "contradicted": "do not hold",
    "untestable": "cannot be tested",
}


def verification() -> Stage:
    """Verify the report's equations, programs and claims."""
    verdicts = report_verdicts()
    equations, claims = counted(verdicts["equations"]), counted(verdicts["claims"])
    stopped = sum(bool(program["stops"]) for program in verdicts["programs"])
    proof = "proved or refuted symbolically, and with numbers of 40 digits"
    return Stage(
        (
            f"equations of the report: {equations}",
            f"objectives, claims and recommendations: {claims}",
            f"programs: {len(verdicts['programs'])}; {stopped} do not run as printed",
            "details and corrections: holonomic verify",
        ),
        _section(verdicts["equations"], verdicts["programs"], verdicts["claims"]),
        (
            ReportedNumber("equations of the report", equations, proof, "holonomic verify"),
            ReportedNumber("claims of the report", claims, "computed", "holonomic verify"),
        ),
    )


def _section(equations: Rows, programs: Rows, claims: Rows) -> str:
    """Counts, and collapsed lists of all misprints, claims and programs, as HTML."""
    misprints = [verdict_html(Verdict(**row)) for row in equations if row["verdict"] == "misprint"]
    reasons = [(row["id"], row["claim"], row["verdict"], row["number"]) for row in claims]
    stops = [
        (f"program {k}", "; ".join(program["stops"]) or "runs as printed")
        for k, program in enumerate(programs, 1)
    ]
    return (
        f"<p>Of {len(equations)} equations, {_described(equations)}. Of {len(claims)} "
        f"objectives, claims and recommendations, {_described(claims)}.</p>"
        + details("All misprints and their corrections", "".join(misprints))
        + details("All claims", table(("", "claim", "verdict", "reason"), reasons))
        + details("The three programs", table(("", "as printed"), stops))
    )


def _described(rows: Rows) -> str:
    counts = Counter(row["verdict"] for row in rows).most_common()
    return ", ".join(
        f"<strong>{n}</strong> {escape(DESCRIPTIONS[verdict])}" for verdict, n in counts
    )
