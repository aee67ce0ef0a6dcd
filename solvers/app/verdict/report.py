"""The verdicts on the double-pendulum report: equations, programs and claims."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

from derive.verification.report.contexts import NUMBERS
from derive.verification.report.programs import PROSE, programs
from derive.verification.report.programs import ReportScene as ReportScene
from derive.verification.report.report_judgement import verdicts
from derive.verification.verdict import Verdict, table_row, table_width, verdict_rows, wrapped
from solvers.app.modules import load
from solvers.app.verdict.claims import claims, objectives, recommendations
from solvers.app.verdict.evidence import Evidence
from solvers.runge_kutta.order_conditions import order
from solvers.scenes.scene import Scene

#: Column where the details of a program start.
MARGIN = 20


def report_verdicts() -> dict[str, Any]:
    """Verdicts on the report's equations, programs and claims, as in ``holonomic verify --json``.

    ``state`` holds the values for which residuals are evaluated.
    """
    printed = programs()
    evidence = Evidence(*map(_scene, (PROSE, *(program.scene for program in printed))))
    equations = verdicts(order)
    counts = Counter(str(verdict.verdict) for verdict in equations)
    tested = [*objectives(evidence, counts), *claims(evidence), *recommendations(evidence)]
    rows = [asdict(program) for program in printed]
    return {
        "state": NUMBERS,
        "equations": [asdict(verdict) for verdict in equations],
        "programs": [{k: v for k, v in row.items() if k != "scene"} for row in rows],
        "claims": [asdict(claim) for claim in tested],
    }


def _scene(values: ReportScene) -> Scene:
    params = [*values.masses, *values.lengths, values.gravity]
    y0 = [*values.angles, *values.velocities]
    floats = tuple(map(float, params)), tuple(map(float, y0)), float(values.duration)
    return Scene(load("double_pendulum"), *floats)


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
        lines += table_row((claim["id"], claim["verdict"], claim["claim"], *details), width)
    lines += ["", "Lines that end in ... are complete in: holonomic verify --json"]
    lines += [f"equations: {counted(verdicts['equations'])}"]
    lines += [f"claims:    {counted(verdicts['claims'])}"]
    return "\n".join(lines) + "\n"


def counted(rows: Sequence[Mapping[str, Any]]) -> str:
    """Count the verdicts: ``150 (119 verified, …)``."""
    counts = Counter(row["verdict"] for row in rows).most_common()
    return f"{len(rows)} ({', '.join(f'{n} {name}' for name, n in counts)})"
