"""A work-precision curve: cost against global error."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from solvers.integration.timing import work_at

#: Names of a method, a form and a backend.
Combination = tuple[str, str, str]


@dataclass(frozen=True)
class Point:
    """One run.

    Attributes
    ----------
    setting : dict
        ``rtol`` for controlled steps, else ``h``.
    work_seconds : float
        Its time, without preparation.
    work_rhs : int or None
        Evaluations of the right-hand side, where they are known.
    global_error : float
        Largest component of the error of the final state, in rad and rad/s.
    energy_error : float
        At the end, relative to the initial energy above that of the equilibrium.
    """

    setting: dict[str, float]
    work_seconds: float
    work_rhs: int | None
    global_error: float
    energy_error: float


@dataclass(frozen=True)
class Curve:
    """Runs of one combination on one scene, by rising cost.

    Attributes
    ----------
    scene, method, form, backend : str
        Names.
    points : list of Point
        The runs.
    """

    scene: str
    method: str
    form: str
    backend: str
    points: list[Point]

    @property
    def combination(self) -> Combination:
        """Method, form and backend."""
        return self.method, self.form, self.backend

    def costs(self, work: str) -> tuple[list[float], list[float]]:
        """Work and global errors of the runs whose work is known."""
        known = [p for p in self.points if getattr(p, work) is not None]
        return [getattr(p, work) for p in known], [p.global_error for p in known]

    def at(self, error: float, work: str = "work_seconds") -> float:
        """Work for this global error; NaN beyond the curve."""
        works, errors = self.costs(work)
        return work_at(error, errors, works)


def select(curves: Iterable[Curve], *combinations: Combination) -> Iterator[Curve]:
    """The curves of these combinations, in the order of the combinations."""
    by_combination = {curve.combination: curve for curve in curves}
    return (by_combination[one] for one in combinations if one in by_combination)
