"""The studies' numbers as text."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from math import inf, isfinite
from typing import Any

from solvers.studies.failure_modes.chaos import Horizon, Mean
from solvers.studies.failure_modes.drift import Drift
from solvers.studies.failure_modes.oscillation import Growth
from solvers.studies.failure_modes.singular import Loss
from solvers.studies.failure_modes.stiffness import EXPLICIT, IMPLICIT, Cost, crossover
from solvers.studies.failure_modes.tolerances import Honesty

Lines = Iterator[str]


def oscillation(found: Sequence[Growth]) -> Lines:
    """Growth per period."""
    yield "Small oscillations of the single pendulum: logarithm of the growth per period"
    yield f"{'method':<10}{'steps/period':>13}{'predicted':>13}{'measured':>13}"
    for g in found:
        yield (
            f"{g.method:<10}{g.steps_per_period:>13.4g}"
            f"{g.predicted:>13.4e}{g.measured:>13.4e}"
        )  # fmt: skip


def stiffness(found: Sequence[Cost]) -> Lines:
    """The best explicit and implicit method at each ratio, and where they cross."""
    yield "Stiff scenes: the cheapest run whose slow angle is right to 1e-3 rad after 6 s"
    yield f"{'family':<19}{'fast/slow':>9}   {'explicit':<26}{'implicit':<26}"
    for family in dict.fromkeys(cost.family for cost in found):
        for ratio in sorted({cost.ratio for cost in found if cost.family == family}):
            here = [c for c in found if (c.family, c.ratio) == (family, ratio)]
            best = [
                min((c for c in here if c.method in kind), key=lambda c: c.work_seconds)
                for kind in (EXPLICIT, IMPLICIT)
            ]
            told = (f"{c.steps} steps, {1e6 * c.work_seconds:.0f} us, {c.method}" for c in best)
            yield f"{family:<19}{ratio:>9.4g}   " + "".join(f"{text:<26}" for text in told)
        crossings = [crossover(found, family, work) for work in ("work_rhs", "work_seconds")]
        if all(map(isfinite, crossings)):
            yield (
                f"{family:<19}implicit methods cost less from a ratio of {crossings[0]:.0f} "
                f"(right-hand sides), {crossings[1]:.0f} (seconds)"
            )
        else:
            yield f"{family:<19}implicit methods do not become cheaper"


def drift(found: Sequence[Drift]) -> Lines:
    """Energy errors of long runs."""
    periods = max(d.periods[-1] for d in found)
    yield f"Energy of the double pendulum over {periods:.3g} periods, in parts of what is in play"
    yield (
        f"{'method':<10}{'form':<13}{'steps/period':>12}{'after 1 %':>12}{'in the end':>12}"
        f"{'per period':>12}{'exponent':>9}"
    )
    for d in found:
        yield (
            f"{d.method:<10}{d.form:<13}{d.steps_per_period:>12}{d.first:>12.1e}"
            f"{d.whole:>12.1e}{d.rate:>12.1e}{d.exponent:>9.2f}"
        )


def singular(found: Sequence[Loss]) -> Lines:
    """Accuracy beside the condition number."""
    yield "Aligned rods, m1 -> 0, m2 = 1 kg: relative errors of one evaluation; of a motion's end"
    yield (
        f"{'m1/kg':>8}{'condition':>11}{'Lagrange qdd':>14}{'Hamilton qd':>13}"
        f"{'Lagrange end':>14}{'Hamilton end':>14}"
    )
    for s in found:
        ends = "".join(f"{x:>14.1e}" if isfinite(x) else f"{'-':>14}"
                       for x in (s.lagrangian, s.hamiltonian))  # fmt: skip
        yield f"{s.m1:>8.0e}{s.condition:>11.1e}{s.acceleration:>14.1e}{s.velocity:>13.1e}{ends}"


def chaos(found: Mapping[str, Any]) -> Lines:
    """Exponent, horizons and means."""
    exponent, apart = found["exponent"], found["separation"]
    yield f"Chaos, the report's motion: largest Lyapunov exponent {_mean(exponent)} per s"
    grown = apart.distance < 1e-2
    yield (
        f"a difference of 1e-12 grows by e^({apart.rate:.3f} t) until it is no longer small, after "
        f"{apart.t[grown][-1]:.1f} s; variational equations say so to "
        f"{abs(apart.distance[grown] / apart.predicted[grown] - 1).max():.1g}"
    )
    rows: Sequence[Horizon] = found["horizons"]
    yield "horizon ln(1/tolerance)/exponent, and when the error reached 1, in s:"
    by_tolerance = dict.fromkeys(row.tolerance for row in rows)
    methods = dict.fromkeys(row.method for row in rows)
    yield f"{'tolerance':>10}{'predicted':>10}" + "".join(f"{m:>10}" for m in methods)
    for tolerance in by_tolerance:
        here = {row.method: row for row in rows if row.tolerance == tolerance}
        first = next(iter(here.values()))
        seen = "".join(
            f"{here[m].seen:>10.1f}" if here[m].seen < inf else f"{'later':>10}" for m in methods
        )
        yield f"{tolerance:>10.0e}{first.predicted:>10.1f}{seen}"
    yield "beyond it: energy error at the end, mean kinetic energy in J, part of time with bob 2 up"
    for s in found["statistics"]:
        yield f"{s.run:<52}{s.energy_error:>9.0e}  {_mean(s.kinetic):<17}{_mean(s.upright)}"


def separatrix(found: Mapping[str, Any]) -> Lines:
    """Sensitivity, and runs that should arrive upright."""
    yield "Single pendulum released near upright, 10 s: by how much errors grow, and verner87's"
    yield f"{'from upright/rad':>17}{'one fall':>11}{'motion':>11}{'error, rtol 1e-10':>19}"
    for s in found["sensitivity"]:
        yield f"{s.distance:>17.0e}{s.predicted:>11.1e}{s.amplification:>11.1e}{s.error:>19.1e}"
    yield "sent off with just the speed to arrive upright: it turns back (-) or over (+) after"
    yield f"{'method':<10}{'tolerance':>10}{'energy defect':>15}{'predicted/s':>12}{'seen/s':>9}"
    for f in found["falls"]:
        yield (
            f"{f.method:<10}{f.tolerance:>10.0e}{f.defect:>+15.1e}{f.predicted:>12.3f}"
            f"{f.seen:>9.3f}"
        )
    upright = found["upright"]
    yield (
        f"released upright, where the float misses pi by {upright.offset:.1e}: horizontal after "
        f"{upright.seen:.6f} s (predicted {upright.predicted:.6f})"
    )


def tolerances(found: Sequence[Honesty]) -> Lines:
    """Achieved over asked."""
    yield "Achieved over asked error, many double pendulums, 3 s: median, worst; SciPy in capitals"
    columns = dict.fromkeys(h.tolerance for h in found)
    yield f"{'method':<10}" + "".join(f"{f'tolerance {t:.0e}':>20}" for t in columns)
    for method in dict.fromkeys(h.method for h in found):
        cells = {h.tolerance: f"{h.median:.3g}, {h.worst:.3g}" for h in found if h.method == method}
        yield f"{method:<10}" + "".join(f"{cells[t]:>20}" for t in columns)


def _mean(mean: Mean) -> str:
    return f"{mean.value:.4g} ± {mean.error:.1g}"


#: How each study is told.
TELL: dict[str, Callable[[Any], Iterable[str]]] = {
    "oscillation": oscillation,
    "stiffness": stiffness,
    "drift": drift,
    "singular": singular,
    "chaos": chaos,
    "separatrix": separatrix,
    "tolerances": tolerances,
}
