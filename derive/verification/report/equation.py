"""One equation of the report, and how it is judged."""

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class Equation:
    """An equation as printed, in the language of formulas, and how it is judged."""

    id: str  # eq33 for equation (33), A9 for the ninth unnumbered display
    printed: str
    corrected: str = ""  # the correct equation, if the printed one does not hold
    # left minus right side as an identity: for equations of motion, a multiple of the
    # Euler–Lagrange residual; without it, the sides must be equal along every motion
    measure: str = ""
    check: str = ""  # the statement that defined quantities must fulfil
    using: tuple[str, ...] = ()  # other equations that define quantities used here
    stray: str = ""  # a printed letter without a meaning
    system: Literal["double", "single", "rigid", "method"] = "double"
    exempt: Literal["", "definition", "context"] = ""  # not judged by computation
    note: str = ""


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
