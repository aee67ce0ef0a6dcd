"""Tests of the report's objectives (chapter 1.6) and recommendations (chapter 5)."""

from __future__ import annotations

from collections.abc import Mapping

from solvers.app.verdict.claim import CHART, STEPS, Claim, outcome
from solvers.app.verdict.evidence import Evidence

#: A method that competes with those of the report, and the errors of the comparison.
OURS, ERRORS = "verner87", (1e-3, 1e-6, 1e-9)


def objectives(evidence: Evidence, equations: Mapping[str, int]) -> list[Claim]:
    """Verdicts on the objectives of the report.

    Parameters
    ----------
    evidence : Evidence
        Runs of its scenes.
    equations : mapping of str to int
        Number of its equations for each verdict.

    Returns
    -------
    list of Claim
        In the order of the report.
    """
    euler, rk4 = evidence.error("RK1", 0.01), evidence.error("RK4", 0.01)
    calls = [(evidence.calls("rk4", e), evidence.calls(OURS, e)) for e in ERRORS]
    wrong = equations.get("wrong", 0)
    return [
        Claim("1.6-1", "Lagrange's equations are derived into Euler-Lagrange's, Hamilton's and "
              "Runge-Kutta's", outcome(wrong == 0),
              f"{equations['verified']} of its equations hold, {equations['misprint']} do once "
              "corrected; Runge-Kutta is no form of the equations but a way to integrate any of "
              "them"),
        Claim("1.6-2", "three methods are compared: Lagrange's equation, Euler's method, "
              "Runge-Kutta", "contradicted",
              "two of them are equations, whose motions are the same to "
              f"{evidence.disagreement:.1g} rad; methods differ: with h = 0.01 s "
              f"RK1 ends {euler:.2g} rad off, RK4 {rk4:.1g}", CHART),
        Claim("1.6-3", "the best solution is found by comparing", outcome(
              all(ours >= theirs for theirs, ours in calls)),
              "for errors of " + ", ".join(f"{e:.0e}" for e in ERRORS) + " RK4 takes "
              + ", ".join(str(theirs) for theirs, _ in calls) + f" right-hand sides, {OURS} "
              + ", ".join(str(ours) for _, ours in calls), CHART),
    ]  # fmt: skip


def recommendations(evidence: Evidence) -> list[Claim]:
    """Verdicts on the recommendations of the report."""
    steps = (0.01, 1e-3, 1e-4)
    euler = [evidence.error("RK1", h) for h in steps]
    rk4 = evidence.error("RK4", 0.02)
    equal, below, above = (evidence.exponent(**m) for m in ({}, {"m2": 3.0}, {"m1": 3.0}))
    return [
        Claim("5f", "Euler's method gives better results with short steps",
              outcome(euler[-1] < euler[0]),
              "off by " + ", ".join(f"{x:.1g}" for x in euler) + " rad with h = "
              + ", ".join(f"{h:g}" for h in steps) + f" s; RK4 is off by {rk4:.1g} with 0.02 s",
              STEPS),
        *(
            Claim(name, f"other masses can be used: {relation}",
                  outcome(abs(found.value - equal.value) > 3 * (found.error + equal.error)),
                  f"largest Lyapunov exponent {found.value:.2f} ± {found.error:.2f} per s with "
                  f"{masses} instead of {equal.value:.2f} ± {equal.error:.2f}: another motion, "
                  "chaotic, too", f"holonomic chart {scene}: work_precision_{scene}.png")
            for name, relation, masses, scene, found in (
                ("5g", "m1 < m2", "m2 = 3 kg", "light_above", below),
                ("5h", "m1 > m2", "m1 = 3 kg", "heavy_above", above),
            )
        ),
    ]  # fmt: skip
