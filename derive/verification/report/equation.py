"""One equation of the report, and the verdict on it."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True)
class Equation:
    """An equation as it is printed, and what it is judged by.

    Attributes
    ----------
    id : str
        ``eq33`` for equation (33), ``A9`` for the ninth display without a number.
    printed : str
        The equation as printed, in the language of `derive.formulas.expression`.
    corrected : str
        What it should say, where the printed form does not hold.
    measure : str
        What left minus right side must be equal to, identically: for equations
        of motion, a multiple of the Euler–Lagrange residual. Without one,
        the sides must be equal along every motion.
    check : str
        For an equation that defines quantities: the statement that these must fulfil.
    using : tuple of str
        Other equations that define quantities used here.
    stray : str
        A letter of the printed form that has no meaning there, if one has.
    system : {"double", "single", "rigid", "method"}
        What it is about.
    note : str
        What a reader should know.
    """

    id: str
    printed: str
    corrected: str = ""
    measure: str = ""
    check: str = ""
    using: tuple[str, ...] = ()
    stray: str = ""
    system: str = "double"
    note: str = ""


@dataclass(frozen=True)
class Stated:
    """An equation that nothing here can decide: a definition, or a matter of its own."""

    id: str
    printed: str
    verdict: str
    reason: str


@dataclass(frozen=True)
class Verdict:
    """The judgement of one equation, as ``holonomic verify`` prints it."""

    id: str
    verdict: str
    printed: str
    correction: str = ""
    residual: str = ""
    witness: str = ""
    note: str = field(default="")
