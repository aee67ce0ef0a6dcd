"""The full equations, integrated by one method and checked by others."""

from dataclasses import dataclass, field
from typing import ClassVar, Self

from solvers.integration.accuracy.checked_motion import Array
from solvers.integration.accuracy.checked_run import CheckedRun
from solvers.integration.accuracy.integration_run import IntegrationRun
from solvers.scenes.models.model_catalogue import Model


@dataclass(frozen=True)
class FullEquations(Model):
    """The full equations, integrated with one tolerance, step size or number of digits."""

    name: ClassVar[str] = "full equations"
    complexity: ClassVar[int] = 100
    applies_to: ClassVar[str] = "every motion"
    error_source: ClassVar[str] = "comparison with two methods in another form of the equations"

    run: IntegrationRun = field(kw_only=True)
    checked: CheckedRun = field(kw_only=True)

    @classmethod
    def key(cls) -> str:
        return "full"

    @classmethod
    def of(cls, checked: CheckedRun) -> Self:
        """The model of a run whose error is estimated."""
        why, error = checked.run.method_choice.why, checked.error_estimate
        return cls(run=checked.run, checked=checked, error_estimate=error, why=why)

    def states(self, t: Array) -> Array:
        return self.checked.states(t)

    def seconds(self, duration: float) -> float:
        return self.checked.seconds()
