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
