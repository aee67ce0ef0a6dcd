"""One equation of the report as printed, and how it is judged."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal

from derive.verification.report.report_latex import translation


@dataclass(frozen=True, kw_only=True)
class Details:
    """What the text does not state: the meaning of an equation, and its corrections."""

    # of a misprint: the incorrect parts of the LaTeX, each printed once, and the correct ones
    changes: tuple[tuple[str, str], ...] = ()
    # left minus right side as an identity: for equations of motion, a multiple of the
    # Euler–Lagrange residual; without it, the sides must be equal along every motion
    measure: str = ""
    check: str = ""  # the statement that defined quantities must fulfil
    using: tuple[str, ...] = ()  # other equations that define quantities used here
    stray: str = ""  # a printed letter without a meaning
    # meanings of letters that differ from the usual ones
    letters: Mapping[str, str] = field(default_factory=dict, hash=False)
    equation: str = "{}"  # the equation that a printed expression stands for
    system: Literal["double", "single", "rigid", "method"] = "double"
    exempt: Literal["", "definition", "context"] = ""  # not judged by computation
    note: str = ""


@dataclass(frozen=True)
class ReportEquation(Details):
    """An equation of the report."""

    id: str  # eq33 for equation (33), A9 for the ninth unnumbered display
    latex: str  # as printed

    def __post_init__(self) -> None:
        for incorrect, _ in self.changes:
            if (count := self.latex.count(incorrect)) != 1:
                part = f"the incorrect part {incorrect!r}"
                raise ValueError(f"{self.id}: {part} is printed {count} times, not once")

    @property
    def number(self) -> str:
        """The id as the report prints it: 33, or A9."""
        return self.id.removeprefix("eq")

    @cached_property
    def printed(self) -> str:
        """The equation as printed, in the syntax of formulas."""
        return self.formula(translation(self.latex))

    @cached_property
    def corrected(self) -> str:
        """The equation with its changes; empty if it has none."""
        return self.formula(translation(self.corrected_latex)) if self.changes else ""

    @property
    def corrected_latex(self) -> str:
        """The LaTeX with its changes."""
        latex = self.latex
        for incorrect, correct in self.changes:
            latex = latex.replace(incorrect, correct)
        return latex

    def formula(self, text: str) -> str:
        """The equation that a translated text stands for, with the meanings of its letters."""
        words = re.sub(r"\w+", lambda word: self.letters.get(word[0], word[0]), text)
        return self.equation.format(words)
