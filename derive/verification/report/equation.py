"""One equation of the report, and how it is judged."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class Equation:
    """An equation as printed, in the language of formulas, and how it is judged."""

    #: ``eq33`` for equation (33), ``A9`` for the ninth unnumbered display.
    id: str
    printed: str
    #: The correct equation, if the printed one does not hold.
    corrected: str = ""
    #: The value of left minus right side, as an identity: for equations of motion a multiple of
    #: the Euler–Lagrange residual. Without it, the sides must be equal along every motion.
    measure: str = ""
    #: For an equation that defines quantities: the statement that they must fulfil.
    check: str = ""
    #: Other equations that define quantities used here.
    using: tuple[str, ...] = ()
    #: A printed letter without a meaning.
    stray: str = ""
    #: The system to which it belongs, or the Runge–Kutta method.
    system: Literal["double", "single", "rigid", "method"] = "double"
    #: The verdict on an equation that cannot be judged by computation.
    exempt: Literal["", "definition", "context"] = ""
    #: Remarks for the reader.
    note: str = ""
