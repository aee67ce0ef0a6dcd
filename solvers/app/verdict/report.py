"""The verdicts on the double-pendulum report: equations, programs and claims."""

from __future__ import annotations

from collections import Counter
from dataclasses import asdict
from typing import Any

import generated.double_pendulum as double_pendulum
from derive.verification.report.contexts import NUMBERS
from derive.verification.report.judgement import verdicts
from derive.verification.report.programs import PROSE, programs
from solvers.app.verdict.claims import claims
from solvers.app.verdict.evidence import Evidence, Setting
from solvers.app.verdict.objectives import objectives, recommendations
from solvers.runge_kutta.order_conditions import order


def report_verdicts() -> dict[str, Any]:
    """Verify the report's equations, programs and claims.

    Returns
    -------
    dict
        ``state``, the values for which residuals are evaluated; ``equations``, ``programs`` and
        ``claims``, as ``holonomic verify --json`` prints them.

    Examples
    --------
    >>> verdicts = report_verdicts()
    >>> len(verdicts["equations"]), len(verdicts["programs"])
    (150, 3)
    """
    printed = programs()
    settings = [_setting(PROSE), *(_setting(program.scene) for program in printed)]
    evidence = Evidence(double_pendulum, *settings)
    equations = verdicts(order)
    counts = Counter(str(verdict.verdict) for verdict in equations)
    tested = [*objectives(evidence, counts), *claims(evidence), *recommendations(evidence)]
    return {
        "state": NUMBERS,
        "equations": [asdict(verdict) for verdict in equations],
        "programs": [_without_scene(asdict(program)) for program in printed],
        "claims": [asdict(claim) for claim in tested],
    }


def _setting(scene: Any) -> Setting:
    values = [*scene.masses, *scene.lengths, scene.gravity]
    initial = [*scene.angles, *scene.velocities]
    return Setting(tuple(map(float, values)), tuple(map(float, initial)), float(scene.duration))


def _without_scene(program: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in program.items() if key != "scene"}
