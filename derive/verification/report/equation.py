"""One equation of the report, and how it is judged."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class Equation:
    """An equation as printed, and how it is judged.

    Attributes
    ----------
    id : str
        ``eq33`` for equation (33), ``A9`` for the ninth unnumbered display.
    printed : str
        The equation as printed, in the language of `derive.formulas.expression`.
    corrected : str
        The correct equation, where the printed one does not hold.
    measure : str
        The value of left minus right side, as an identity: for equations of motion
        a multiple of the Euler–Lagrange residual. Without it, the sides must be
        equal along every motion.
    check : str
        For an equation that defines quantities: the statement that they must fulfil.
    using : tuple of str
        Other equations that define quantities used here.
    stray : str
        A printed letter without a meaning.
    system : {"double", "single", "rigid", "method"}
        The system to which it belongs, or the Runge–Kutta method.
    exempt : {"", "definition", "context"}
        The verdict on an equation that cannot be judged by computation.
    note : str
        Remarks for the reader.
    """

    id: str
    printed: str
    corrected: str = ""
    measure: str = ""
    check: str = ""
    using: tuple[str, ...] = ()
    stray: str = ""
    system: Literal["double", "single", "rigid", "method"] = "double"
    exempt: Literal["", "definition", "context"] = ""
    note: str = ""
