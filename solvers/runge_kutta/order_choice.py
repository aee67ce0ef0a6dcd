"""The order of the next step, by the contraction of Newton's iteration.

A method of higher order has more stages, and its iteration converges in shorter steps only. Where
the iteration contracts fast, steps of a higher order are worth their stages; where it contracts
slowly or not at all, a lower order takes longer steps (E. Hairer, G. Wanner, Journal of
Computational and Applied Mathematics 111 (1999) 93-111). Other than there, the first step has the
highest order: smooth solutions would take many short steps before it is reached.
"""

from dataclasses import dataclass

#: A contraction up to which the order rises, and from which on it falls.
FAST, SLOW = 0.002, 0.8
#: The order rises where the factor of the step size is between these.
STEADY = 0.8, 1.2


@dataclass
class OrderChoice:
    """The choice of one of `count` methods, of decreasing order, for each step."""

    count: int
    index: int = 0  # of the next step's method
    last: int = 0  # of the last step's method
    _contraction: float = 0.0

    def lower(self) -> None:
        """Choose a lower order, as after a step that failed."""
        self.index = min(self.index + 1, self.count - 1)

    def advance(self, contraction: float, factor: float) -> None:
        """Choose the order after a step of this contraction; `factor` changes the step size.

        In each following step a contraction counts by half: after a slow one the order does not
        rise for nine steps.
        """
        self.last = self.index
        self._contraction = max(contraction, self._contraction / 2)
        if self._contraction >= SLOW:
            self.lower()
        elif self._contraction <= FAST and STEADY[0] < factor < STEADY[1]:
            self.index = max(self.index - 1, 0)
