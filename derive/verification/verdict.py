"""The verdict on one equation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

VerdictName: TypeAlias = Literal[
    "verified", "equivalent", "misprint", "wrong", "definition", "context", "unreadable"
]


@dataclass(frozen=True)
class Verdict:
    """The verdict on one equation, as ``holonomic verify --json`` prints it.

    Attributes
    ----------
    id : str
        Identifier of the equation, such as ``eq33`` or ``accelerations.theta1``.
    verdict : {"verified", "equivalent", "misprint", "wrong", "definition", "context", "unreadable"}
        The equation holds; it gives the same equations of motion; it does not hold, but its
        correction is proved; it does not hold; it defines a quantity; it concerns another
        subject; it cannot be parsed.
    printed : str
        The equation as printed.
    correction : str
        The correct equation.
    residual : str
        Printed minus corrected form, where they first differ.
    wrong_term, correct_term : str
        The first wrong term as printed, empty if a term is missing, and its correction.
    witness : str
        Numbers at a generic state that show the error.
    note : str
        Further information.
    """

    id: str
    verdict: VerdictName
    printed: str
    correction: str = ""
    residual: str = ""
    wrong_term: str = ""
    correct_term: str = ""
    witness: str = ""
    note: str = ""
