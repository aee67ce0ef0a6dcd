"""The verdicts on the double-pendulum report: equations, programs and claims.

Claims are its objectives (chapter 1.6), claims (3 to 5) and recommendations (5). Each is
``supported`` or ``contradicted`` by a reproducible number, or ``untestable`` if no number could
decide it.
"""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from derive.verification.judging.verdict import (
    Verdict,
    table_row,
    table_width,
    verdict_rows,
    wrapped,
)
from derive.verification.report.contexts import NUMBERS
from derive.verification.report.programs import PROSE, programs
from derive.verification.report.programs import ReportScene as ReportScene
from derive.verification.report.report_judgement import verdicts
from solvers.app.modules import load
from solvers.app.report_evidence import Evidence
from solvers.runge_kutta.order_conditions import order
from solvers.scenes.scene import Scene
from solvers.studies.work_precision.measured_curves import REPORT_METHODS

#: Plots, each after the command that writes it.
CHART = "holonomic chart: work_precision_report.png"
STEPS = "holonomic chart: steps_report.png"
CHAOS = "holonomic stability: failures_chaos.png"
TOLERANCES = "holonomic stability: failures_tolerances.png"
#: A method that competes with those of the report, and the errors of the comparison.
OURS, ERRORS = "verner853", (1e-3, 1e-6, 1e-9)


@dataclass(frozen=True)
class Claim:
    """A claim of the report, restated, with its verdict."""

    id: str  # section, and a letter
    claim: str
    verdict: str
    number: str  # the number that decides, or the reason why there is none
    figure: str = ""  # the plot that shows it, after the command that writes it


def outcome(holds: bool | np.bool) -> str:
    """``supported`` or ``contradicted``."""
    return "supported" if holds else "contradicted"


def claims(evidence: Evidence) -> list[Claim]:
    """Every claim with its verdict, in the order of the report."""
    return [*_chapter_3(evidence), *_chapter_4(evidence), *_chapter_5(evidence)]


def objectives(e: Evidence, equations: Mapping[str, int]) -> list[Claim]:
    """Verdicts on the objectives; `equations` counts the report's equations by verdict."""
    euler, rk4 = e.error("RK1", 0.01), e.error("RK4", 0.01)
    theirs, ours = ([e.calls(name, error) for error in ERRORS] for name in ("rk4", OURS))
    return [
        Claim("1.6-1", "Lagrange's equations are derived into Euler-Lagrange's, Hamilton's and "
              "Runge-Kutta's", outcome(equations.get("wrong", 0) == 0),
              f"{equations['verified']} of its equations hold, and {equations['misprint']} hold "
              "once corrected; Runge-Kutta is not a form of the equations but a method of "
              "integrating any form"),
        Claim("1.6-2", "three methods are compared: Lagrange's equation, Euler's method, "
              "Runge-Kutta", "contradicted",
              "two of them are equations, and their motions agree to "
              f"{e.disagreement:.1g} rad; methods differ: with h = 0.01 s the error of RK1 is "
              f"{euler:.2g} rad and that of RK4 {rk4:.1g} rad", CHART),
        Claim("1.6-3", "the best solution is found by comparing",
              outcome(all(a >= b for a, b in zip(ours, theirs, strict=True))),
              f"for errors of {_listed(ERRORS, '.0e')} RK4 takes {_listed(theirs)} right-hand "
              f"sides, {OURS} {_listed(ours)}", CHART),
    ]  # fmt: skip


def _chapter_3(e: Evidence) -> list[Claim]:
    shorter = np.abs(e.motion(e.first)[:2, -1] - e.end[:2]).max()
    faster = np.abs(e.motion(e.second)[:2, -1] - e.motion(e.first)[:2, -1]).max()
    steps = [0.2, 0.1, 0.08, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001, 5e-4]
    errors = [e.error("RK4", h) for h in steps]
    by_step = ", ".join(f"{x:.1g} (h = {h:g} s)" for h, x in zip(steps, errors, strict=True))
    crossings = [int(np.sum(np.diff(np.sign(e.stepped("RK4", h)[0])) != 0)) for h in (0.01, 0.005)]
    methods = [e.error(name, 0.01) for name in REPORT_METHODS]
    ratios = [e.speed_ratio(scene) for scene in (e.first, e.prose)]
    return [
        Claim("3.1a", "the figure of the Lagrangian belongs to m = 1 kg, l = 2 m, g = 9.81",
              outcome(shorter < 1e-3),
              f"its program has other lengths; at 5 s its angles differ by {shorter:.2g} rad"),
        Claim("3.1b", "there is less movement as time goes on", "untestable",
              "the report does not define movement: the mean angular speed of the second half is "
              f"{ratios[0]:.2f} of that of the first half in program 1, {ratios[1]:.2f} in the "
              "scene of the prose"),
        Claim("3.1c", "the Mathematica solution is the exact curve", "untestable",
              "Mathematica is not available, and no closed form is known; Taylor series and an "
              f"extrapolated midpoint rule differ by {e.references_apart:.1g} rad at 5 s"),
        Claim("3.2a", "the Euler-Lagrange run has the same data as the Lagrangian one",
              outcome(e.first == e.second),
              f"lengths and velocities differ; at 5 s the angles differ by {faster:.2g} rad"),
        Claim("3.2b", "the curve looks wavy because 5 s are short", "untestable",
              "the figure is lost, and the report does not define 'wavy'"),
        Claim("3.3a", "the smaller the step, the smaller the error",
              outcome(all(a > b for a, b in pairwise(errors))),
              f"errors of RK4 at 5 s, in rad: {by_step}; true for small steps until rounding "
              "errors dominate, not for large ones", STEPS),
        Claim("3.3b", "with a smaller step the curves repeat more often",
              outcome(crossings[1] > crossings[0]),
              f"the upper rod passes the vertical {crossings[0]} times with h = 0.01 s and "
              f"{crossings[1]} times with h = 0.005 s"),
        Claim("3.3c", "RK1 to RK4 give the same pattern, but oscillate differently", "untestable",
              "the figures are lost and may show one run four times; with h = 0.01 s the errors of "
              f"methods of orders 1 to 4 are {_listed(methods, '.1g')} rad at 5 s", STEPS),
        Claim("3.3d", "Runge-Kutta is the best tool to measure the error", "untestable",
              "the rule (20) to (25) has no embedded weights and estimates no error", TOLERANCES),
    ]  # fmt: skip


def _chapter_4(e: Evidence) -> list[Claim]:
    times = np.linspace(0.0, e.prose.duration, 5001)
    turns = float(np.ptp(e.motion(e.prose, times)[1]) / (2 * np.pi))
    euler, rough = e.error("RK1", 0.01), e.error("RK4", 0.1)
    change = 100 * e.energy_change(e.stepped("RK1", 0.01), e.prose)
    return [
        Claim("4.1", "the pendulum moves extremely for the whole 5 s", "untestable",
              f"the report does not define 'extremely'; the lower rod sweeps {turns:.2f} turns"),
        Claim("4.2", "Euler's method is unsuitable for as long as 5 s", outcome(euler > 0.1),
              f"with h = 0.01 s the error of the energy is {change:.0f} % and that of the angles "
              f"{euler:.2g} rad; but section 4.2 shows the Euler-Lagrange equations, not Euler's "
              "method", STEPS),
        Claim("4.3", "Runge-Kutta is the best, for its curves are smooth", outcome(rough < 1e-3),
              "the curve of RK4 with h = 0.1 s is also smooth, but its error at 5 s is "
              f"{rough:.2g} rad", CHART),
    ]  # fmt: skip


def _chapter_5(e: Evidence) -> list[Claim]:
    growth = e.divergence(1e-9, 5.0), e.divergence(1e-9, 20.0)
    euler, rk4 = ([e.error(name, h) for h in (0.05, 1e-4)] for name in ("RK1", "RK4"))
    third = e.stepped("RK4", 0.01, e.third)
    third_error = np.abs(third[:2, -1] - e.motion(e.third)[:2, -1]).max()
    return [
        Claim("5a", "the motion depends sensitively on its start", outcome(growth[1] > 1e3),
              f"a difference of 1e-9 rad grows by a factor of {growth[0]:.3g} in 5 s and of "
              f"{growth[1]:.3g} in 20 s", CHAOS),
        Claim("5b", "Lagrange's and Hamilton's equations are related to each other",
              outcome(e.disagreement < 1e-8),
              f"both forms give the same motion: at 5 s they differ by {e.disagreement:.1g} rad",
              CHART),
        Claim("5c", "with the same data, Runge-Kutta beats Lagrange's and Euler's method",
              "untestable",
              "the data differ (3.2a), and Lagrange's equations are those that Runge-Kutta solves",
              CHART),
        Claim("5d", "Euler's method suits short steps only",
              outcome(euler[0] > 0.1 > euler[1]),
              f"its error is {euler[0]:.2g} rad with h = 0.05 s and {euler[1]:.2g} rad with "
              "h = 0.0001 s", STEPS),
        Claim("5e", "Runge-Kutta is better than Euler's method for long and for short steps",
              outcome(all(a < b for a, b in zip(rk4, euler, strict=True))),
              f"errors of RK4 and Euler's method: {rk4[0]:.2g} and {euler[0]:.2g} rad with "
              f"h = 0.05 s, {rk4[1]:.1g} and {euler[1]:.2g} rad with h = 0.0001 s; with h = 0.1 s "
              f"that of RK4 is {e.error('RK4', 0.1):.2g} rad", STEPS),
        Claim("B3", "5000 steps of 0.01 s are enough for program 3", outcome(third_error < 1e-3),
              f"at 50 s the error of the angles is {third_error:.1g} rad, and that of the energy "
              f"{e.energy_change(third, e.third):.1g}, relative to the energy above rest"),
    ]  # fmt: skip


def recommendations(e: Evidence) -> list[Claim]:
    """Verdicts on the recommendations of the report."""
    steps = (0.01, 1e-3, 1e-4)
    euler, rk4 = [e.error("RK1", h) for h in steps], e.error("RK4", 0.02)
    equal, below, above = (e.exponent(**masses) for masses in ({}, {"m2": 3.0}, {"m1": 3.0}))
    return [
        Claim("5f", "Euler's method gives better results with short steps",
              outcome(euler[-1] < euler[0]),
              f"its errors are {_listed(euler, '.1g')} rad with h = {_listed(steps, 'g')} s; that "
              f"of RK4 is {rk4:.1g} rad with h = 0.02 s", STEPS),
        *(
            Claim(name, f"other masses can be used: {relation}",
                  outcome(abs(mean.value - equal.value) > 3 * (mean.error + equal.error)),
                  f"with {masses} the largest Lyapunov exponent is {mean.value:.2f} ± "
                  f"{mean.error:.2f} per s instead of {equal.value:.2f} ± {equal.error:.2f}: a "
                  "different motion, also chaotic",
                  f"holonomic chart {scene}: work_precision_{scene}.png")
            for name, relation, masses, scene, mean in (
                ("5g", "m1 < m2", "m2 = 3 kg", "light_above", below),
                ("5h", "m1 > m2", "m1 = 3 kg", "heavy_above", above),
            )
        ),
    ]  # fmt: skip


def _listed(numbers: Iterable[float], spec: str = "") -> str:
    return ", ".join(f"{number:{spec}}" for number in numbers)


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
