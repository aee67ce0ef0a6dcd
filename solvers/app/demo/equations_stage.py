"""Stages on equations: their derivation, their code, and verdicts on those of the report."""

import inspect
from collections import Counter
from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

from derive import Derivation, load
from derive.codegen.module_summary import broken_sum
from derive.commands.regenerate import planned
from derive.verification.judging.verdict import Verdict
from derive.verification.report.derivation_beside_report import compare_steps, verdict_html
from derive.verification.report.report_judgement import equation_by_id, verdict
from solvers.app.demo.stage import ReportedNumber, Stage, details, table
from solvers.app.report_verdicts import counted, report_verdicts
from solvers.equations.module import GeneratedModule
from solvers.runge_kutta.order_conditions import order

#: Columns of a formula on the terminal.
WIDTH = 67
#: Functions whose costs the page lists, with descriptions.
FUNCTIONS = {
    "rhs": "Lagrangian form",
    "rhs_hamiltonian": "Hamiltonian form",
    "rhs_rational": "rational form, in sines and cosines",
    "rhs_variational": "rational form with a small perturbation",
    "jacobian": "derivatives of the Lagrangian form by the state",
    "energy": "energy",
}
#: Functions whose costs the terminal text lists, and functions whose text the page shows.
COUNTED = ("rhs", "rhs_hamiltonian", "jacobian", "energy")
LISTED = ("rhs", "rhs_rational")


def derivation() -> Stage:
    """Derive the equations of motion, and show them beside the equations of the report."""
    double = Derivation(load("double_pendulum"))
    rows = double.mass_matrix.tolist()
    first, second = double.forcing
    steps = compare_steps(double, lambda name: verdict(equation_by_id(name), order))
    lines = (
        *broken_sum(f"L = {double.lagrangian}", WIDTH).splitlines(),
        f"M = {rows[0]}",
        f"    {rows[1]}",
        "and M qddot = (f1, f2) with",
        *broken_sum(f"f1 = {first}", WIDTH).splitlines(),
        *broken_sum(f"f2 = {second}", WIDTH).splitlines(),
    )
    return Stage(lines, "".join(step.section for step in steps))


def generation(module: GeneratedModule) -> Stage:
    """Compare the generated files with the generator's output and count operations."""
    changed = planned([module.SYSTEM], None).differences()
    state = "differs: run holonomic derive" if changed else "up to date"
    counts = {name: str(module.OPERATIONS[name][0]) for name in FUNCTIONS}
    operations = ", ".join(f"{name} {counts[name]}" for name in COUNTED)
    rows = [(name, FUNCTIONS[name], count) for name, count in counts.items()]
    html = table(("function", "", "operations a call"), rows)
    for name in LISTED:
        source = escape(inspect.getsource(getattr(module, name)))
        html += details(f"{name}, as generated", f"<pre>{source}</pre>")
    quantity, method = "operations of a right-hand side", "counted in the generated function"
    return Stage(
        (f"generated/{module.SYSTEM}.py: {state}", f"operations: {operations}"),
        html,
        (ReportedNumber(quantity, counts["rhs"], method, "holonomic derive"),),
    )


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
