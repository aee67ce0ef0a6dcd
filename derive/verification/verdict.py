"""The verdict on one equation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

VerdictName: TypeAlias = Literal[
    "verified",  # it holds
    "equivalent",  # it differs from the derived formula, but gives the same equations of motion
    "misprint",  # it does not hold, but its correction is proved
    "wrong",  # it does not hold
    "definition",  # it defines a quantity
    "context",  # it concerns another subject
    "unreadable",  # it cannot be parsed
]


@dataclass(frozen=True)
class Verdict:
    """The verdict on one equation, as ``holonomic verify --json`` prints it."""

    id: str  # such as eq33 or accelerations.theta1
    verdict: VerdictName
    printed: str
    correction: str = ""
    residual: str = ""  # printed minus corrected form, where they first differ
    wrong_term: str = ""  # the first one as printed; empty if a term is missing
    correct_term: str = ""
    witness: str = ""  # numbers at a generic state that show the error
    note: str = ""
