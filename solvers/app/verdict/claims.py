"""Tests of the claims in chapters 3 to 5 of the report.

Each claim is ``supported`` or ``contradicted`` by a reproducible number, or ``untestable`` if no
number could decide it.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from solvers.app.verdict.claim import CHAOS, CHART, STEPS, TOLERANCES, Claim, outcome
from solvers.app.verdict.evidence import Evidence
from solvers.studies.work_precision.measurement import REPORT_METHODS


def claims(evidence: Evidence) -> list[Claim]:
    """Every claim with its verdict, in the order of the report."""
    return [*_chapter_3(evidence), *_chapter_4(evidence), *_chapter_5(evidence)]


def _chapter_3(e: Evidence) -> list[Claim]:
    shorter = np.abs(e.motion(e.first)[:2, -1] - e.end[:2]).max()
    faster = np.abs(e.motion(e.second)[:2, -1] - e.motion(e.first)[:2, -1]).max()
    steps = [0.2, 0.1, 0.08, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001, 5e-4]
    errors = [e.error("RK4", h) for h in steps]
    crossings = [int(np.sum(np.diff(np.sign(e.stepped("RK4", h)[0])) != 0)) for h in (0.01, 0.005)]
    methods = [e.error(name, 0.01) for name in REPORT_METHODS]
    ratios = [e.speed_ratio(setting) for setting in (e.first, e.prose)]
    return [
        Claim("3.1a", "the figure of the Lagrangian belongs to m = 1 kg, l = 2 m, g = 9.81",
              outcome(shorter < 1e-3),
              f"its program has other lengths; at 5 s its angles are {shorter:.2g} rad away"),
        Claim("3.1b", "there is less movement as time goes on", "untestable",
              "depends on what is meant: the angles' mean speed in the second half is "
              f"{ratios[0]:.2f} of the first half's in program 1, {ratios[1]:.2f} in the prose"),
        Claim("3.1c", "the Mathematica solution is the exact curve", "untestable",
              "Mathematica is not at hand, and no closed form is known; Taylor series and an "
              f"extrapolated midpoint rule differ by {e.references_apart:.1g} rad at 5 s"),
        Claim("3.2a", "the Euler-Lagrange run has the same data as the Lagrangian one",
              outcome(e.first == e.second),
              f"lengths and velocities differ; at 5 s the angles are {faster:.2g} rad apart"),
        Claim("3.2b", "the curve looks wavy because 5 s are short", "untestable",
              "the figure is lost, and no number is tied to 'wavy'"),
        Claim("3.3a", "the smaller the step, the smaller the error",
              outcome(all(a > b for a, b in pairwise(errors))),
              "RK4, in rad at 5 s: "
              + ", ".join(f"{x:.1g} (h = {h:g} s)" for h, x in zip(steps, errors, strict=True))
              + "; true for small steps, until rounding turns it, not for large ones", STEPS),
        Claim("3.3b", "with a smaller step the curves repeat more often",
              outcome(crossings[1] > crossings[0]),
              f"upper rod through the vertical: {crossings[0]} times with h = 0.01 s, "
              f"{crossings[1]} with 0.005 s"),
        Claim("3.3c", "RK1 to RK4 give the same pattern, but oscillate differently", "untestable",
              "the figures are lost and may be four plots of one run; with h = 0.01 s methods of "
              f"orders 1 to 4 end {', '.join(f'{x:.1g}' for x in methods)} rad from the motion",
              STEPS),
        Claim("3.3d", "Runge-Kutta is the best tool to measure the error", "untestable",
              "the rule (20) to (25) has no embedded weights and measures no error", TOLERANCES),
    ]  # fmt: skip


def _chapter_4(e: Evidence) -> list[Claim]:
    times = np.linspace(0.0, e.prose.duration, 5001)
    turns = float(np.ptp(e.motion(e.prose, times)[1]) / (2 * np.pi))
    euler, rough = e.error("RK1", 0.01), e.error("RK4", 0.1)
    change = 100 * e.energy_change(e.stepped("RK1", 0.01), e.prose)
    return [
        Claim("4.1", "the pendulum moves extremely for the whole 5 s", "untestable",
              f"'extremely' has no measure; the lower rod sweeps {turns:.2f} turns"),
        Claim("4.2", "Euler's method is unsuitable for as long as 5 s", outcome(euler > 0.1),
              f"h = 0.01 s: energy off by {change:.0f} %, angles by {euler:.2g} rad; yet what 4.2 "
              "shows are the Euler-Lagrange equations, which are no such method", STEPS),
        Claim("4.3", "Runge-Kutta is the best, for its curves are smooth", outcome(rough < 1e-3),
              f"RK4 with h = 0.1 s draws a smooth curve, too, and is {rough:.2g} rad off at 5 s",
              CHART),
    ]  # fmt: skip


def _chapter_5(e: Evidence) -> list[Claim]:
    growth = e.divergence(1e-9, 5.0), e.divergence(1e-9, 20.0)
    euler, rk4 = ([e.error(name, h) for h in (0.05, 1e-4)] for name in ("RK1", "RK4"))
    third = e.stepped("RK4", 0.01, e.third)
    third_error = np.abs(third[:2, -1] - e.motion(e.third)[:2, -1]).max()
    return [
        Claim("5a", "the motion depends sensitively on its start", outcome(growth[1] > 1e3),
              f"1e-9 rad has grown {growth[0]:.3g} times after 5 s, {growth[1]:.3g} after 20 s",
              CHAOS),
        Claim("5b", "Lagrange's and Hamilton's equations are related to each other",
              outcome(e.disagreement < 1e-8),
              f"both forms give one motion: {e.disagreement:.1g} rad apart at 5 s", CHART),
        Claim("5c", "with the same data, Runge-Kutta beats Lagrange's and Euler's method",
              "untestable",
              "the data differ (3.2a), and Lagrange's equations are what Runge-Kutta solves",
              CHART),
        Claim("5d", "Euler's method suits short steps only",
              outcome(euler[0] > 0.1 > euler[1]),
              f"off by {euler[0]:.2g} rad with h = 0.05 s, by {euler[1]:.2g} with 0.0001 s", STEPS),
        Claim("5e", "Runge-Kutta is better than Euler's method for long and for short steps",
              outcome(all(a < b for a, b in zip(rk4, euler, strict=True))),
              f"h = 0.05 s: {rk4[0]:.2g} against {euler[0]:.2g} rad; h = 0.0001 s: {rk4[1]:.1g} "
              f"against {euler[1]:.2g}; yet with h = 0.1 s it is off by {e.error('RK4', 0.1):.2g}",
              STEPS),
        Claim("B3", "5000 steps of 0.01 s are enough for program 3", outcome(third_error < 1e-3),
              f"its angles at 50 s are off by {third_error:.1g} rad, its energy by "
              f"{e.energy_change(third, e.third):.1g} of what is in play"),
    ]  # fmt: skip
