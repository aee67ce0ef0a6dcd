"""One equation of the report, and how it is judged."""

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class Equation:
    """An equation as printed, in the language of formulas, and how it is judged."""

    id: str  # eq33 for equation (33), A9 for the ninth unnumbered display
    printed: str
    # of a misprint: the incorrect parts, each of which is printed once, and the correct ones
    changes: tuple[tuple[str, str], ...] = ()
    # left minus right side as an identity: for equations of motion, a multiple of the
    # Euler–Lagrange residual; without it, the sides must be equal along every motion
    measure: str = ""
    check: str = ""  # the statement that defined quantities must fulfil
    using: tuple[str, ...] = ()  # other equations that define quantities used here
    stray: str = ""  # a printed letter without a meaning
    system: Literal["double", "single", "rigid", "method"] = "double"
    exempt: Literal["", "definition", "context"] = ""  # not judged by computation
    note: str = ""

    def __post_init__(self) -> None:
        for incorrect, _ in self.changes:
            if (count := self.printed.count(incorrect)) != 1:
                part = f"the incorrect part {incorrect!r}"
                raise ValueError(f"{self.id}: {part} is printed {count} times, not once")

    @property
    def corrected(self) -> str:
        """The printed equation with its changes; empty if it has none."""
        text = self.printed
        for incorrect, correct in self.changes:
            text = text.replace(incorrect, correct)
        return text if self.changes else ""


def fourth_order_rule(first: int) -> tuple[Equation, ...]:
    """The six equations of the fourth-order method, which the report prints four times."""
    initial = Equation(f"eq{first}", "w_0 = alpha", exempt="definition", note="the initial value")
    lines = (
        "m_1 = h*f(t_i, w_i)",
        "m_2 = h*f(t_i + h/2, w_i + m_1/2)",
        "m_3 = h*f(t_i + h/2, w_i + m_2/2)",
        "m_4 = h*f(t_i + h, w_i + m_3)",
        "w_next = w_i + 1/6*(m_1 + 2*m_2 + 2*m_3 + m_4)",
    )
    stages = (Equation(f"eq{n}", line, system="method") for n, line in enumerate(lines, first + 1))
    return (initial, *stages)
