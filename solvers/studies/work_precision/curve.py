"""A work-precision curve: what a smaller error costs."""

from __future__ import annotations

from dataclasses import dataclass

from solvers.integration.timing import work_at


@dataclass(frozen=True)
class Point:
    """One run.

    Attributes
    ----------
    setting : dict
        ``rtol``, for steps that are controlled, or ``h``.
    work_seconds : float
        Its time, without preparation.
    work_rhs : int or None
        Right-hand sides, where they are known.
    global_error : float
        Of the state at the end, in rad and rad/s: the largest component.
    energy_error : float
        At the end, in parts of the energy at the beginning above rest.
    """

    setting: dict[str, float]
    work_seconds: float
    work_rhs: int | None
    global_error: float
    energy_error: float


@dataclass(frozen=True)
class Curve:
    """Runs of one combination on one scene, from cheap to dear.

    Attributes
    ----------
    scene, method, form, backend : str
        Which.
    points : list of Point
        Its runs.
    """

    scene: str
    method: str
    form: str
    backend: str
    points: list[Point]

    def at(self, error: float, work: str = "work_seconds") -> float:
        """Work for this global error; NaN beyond the curve."""
        points = [p for p in self.points if getattr(p, work) is not None]
        return work_at(
            error, [p.global_error for p in points], [getattr(p, work) for p in points]
        )  # fmt: skip
