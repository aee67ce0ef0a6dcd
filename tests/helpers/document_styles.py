"""Styles in which documents are written: letters, notations, steps, conventions, markup."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import sympy as sp

from derive.formulas.typeset.lettering import GREEK as UNICODE
from derive.reading.latex.display_reader import formulas
from derive.reading.latex.tree import (
    Application,
    Call,
    Derivative,
    Letter,
    Node,
    Number,
    Power,
    Product,
    Quotient,
    Statement,
    Sum,
)

#: Greek letters, and indices, as LaTeX has them.
COMMON = {
    **{name: rf"\{name}" for name in ("theta", "phi", "alpha", "Omega")},
    **{f"{letter}{i}": f"{letter}_{i}" for letter in "mlkx" for i in (1, 2, 3)},
    **{f"theta{i}": rf"\theta_{i}" for i in (1, 2)},
}
ANGLES_PHI = {"theta": r"\varphi", "theta1": r"\varphi_1", "theta2": r"\varphi_2", "phi": r"\psi"}
WORDS = {
    "en": {
        "positions": "The positions are", "velocities": "The square of the speed is",
        "kinetic": "The kinetic energy is", "potential": "The potential energy is",
        "lagrangian": "Hence the Lagrangian", "partials": "Its derivatives are",
        "rates": "Their rates are", "equations": "The equations of motion are",
        "accelerations": "Solved for the accelerations,", "momenta": "The momenta are",
        "hamiltonian": "The Hamiltonian is", "canonical": "Hamilton's equations read",
        "energy": "The energy is conserved:", "abbreviations": "We abbreviate",
    },
    "de": {
        "positions": "Die Koordinaten lauten", "velocities": "Die Geschwindigkeiten sind",
        "kinetic": "Kinetische Energie:", "potential": "Potentielle Energie:",
        "lagrangian": "Lagrangefunktion:", "partials": "Ableitungen:", "rates": "Zeitlich:",
        "equations": "Bewegungsgleichungen:", "accelerations": "Aufgelöst:",
        "momenta": "Impulse:", "hamiltonian": "Hamiltonfunktion:", "canonical": "Kanonisch:",
        "energy": "Energie:", "abbreviations": "Mit der Abkürzung",
    },
    "fr": {
        "positions": "Les positions :", "velocities": "Les vitesses :",
        "kinetic": "L'énergie cinétique vaut", "potential": "L'énergie potentielle vaut",
        "lagrangian": "Le lagrangien s'écrit", "partials": "Ses dérivées partielles :",
        "rates": "Puis", "equations": "Les équations du mouvement sont",
        "accelerations": "D'où les accélérations :", "momenta": "Les moments conjugués :",
        "hamiltonian": "Le hamiltonien :", "canonical": "Les équations canoniques :",
        "energy": "L'énergie totale", "abbreviations": "On pose",
    },
}  # fmt: skip

BY_POSITIONS = ("positions", "kinetic", "potential", "lagrangian", "equations")
BY_ENERGIES = ("kinetic", "potential", "lagrangian", "equations")
BY_STEPS = ("kinetic", "potential", "lagrangian", "partials", "rates", "equations")
BY_HAMILTON = ("lagrangian", "momenta", "hamiltonian", "canonical")


@dataclass(frozen=True)
class Style:
    """How an author writes."""

    steps: tuple[str, ...]
    markup: str = "md"  # md, tex, html, rst, ipynb, or txt for formulas in plain text
    letters: Mapping[str, str] = field(default_factory=dict)  # beside those that are common
    rates: str = "dot"  # dot, time (functions of t), leibniz, prime, or words in plain text
    energies: Sequence[str] = ("T", "V", "L", "H")
    shift: sp.Expr = sp.S.Zero  # of angles, from hanging
    is_down: bool = False  # the axis of heights points downwards
    abbreviated: tuple[str, ...] = ()  # products, sums or differences of parameters and angles
    brackets: bool = False  # sin(x)
    halves: bool = False  # a fraction before its product
    times: str = " "  # between factors
    is_chained: bool = False  # L = T - V = ...
    is_aligned: bool = False  # all formulas of a step in one display
    moves_right: bool = False  # the equations have terms on both sides
    is_rearranged: bool = False  # each formula in an equal form, drawn at random
    language: str = "en"
    is_held_out: bool = False  # not used in development

    def written(self, steps: Sequence[tuple[str, Sequence[str]]]) -> str:
        """The text of a document from the formulas of its steps."""
        pieces = []
        for step, statements in steps:
            words = WORDS[self.language][step]
            if self.is_aligned and len(statements) > 1:
                rows = " \\\\\n".join(one.replace(" = ", " &= ", 1) for one in statements)
                statements = [f"\\begin{{aligned}}\n{rows}\n\\end{{aligned}}"]
            pieces.append("\n\n".join([words, *map(self._display, statements)]))
        text = "\n\n".join(pieces)
        if self.markup == "tex":
            return f"\\documentclass{{article}}\n\\begin{{document}}\n{text}\n\\end{{document}}\n"
        if self.markup == "html":
            return f"<html><body>\n<p>{text}</p>\n</body></html>\n"
        if self.markup == "ipynb":
            cells = [{"cell_type": "markdown", "metadata": {}, "source": one} for one in pieces]
            return json.dumps({"cells": cells, "metadata": {}, "nbformat": 4, "nbformat_minor": 5})
        return text + "\n"

    def source(self, formula: str) -> str:
        """A formula as the document contains it."""
        if self.markup != "txt":
            return formula
        (statement,) = formulas(formula)
        assert isinstance(statement, Statement)
        return " = ".join(plain_text(side, self.rates) for side in statement.sides)

    def _display(self, formula: str) -> str:
        if self.markup == "txt":
            return f"    {self.source(formula)}"
        if self.markup == "tex":
            return f"\\begin{{equation}}\n{formula}\n\\end{{equation}}"
        if self.markup == "rst":
            return ".. math::\n\n" + "\n".join(f"   {line}" for line in formula.splitlines())
        if self.markup == "html":
            formula = formula.replace("&", "&amp;").replace("<", "&lt;")
            return f"\\[ {formula} \\]"
        return f"$$\n{formula}\n$$"


LOWERED = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")


def plain_text(node: Node, rates: str) -> str:
    """A formula in plain text: with words for dots if these are ``words``."""

    def factor(one: Node) -> str:
        text = plain_text(one, rates)
        return f"({text})" if isinstance(one, Sum | Quotient | Product | Application) else text

    match node:
        case Number():
            return node.digits
        case Letter() if rates == "words":
            dots = f"_{'d' * node.dots}ot" if node.dots else ""
            return f"{node.name}{node.index}{dots}"
        case Letter():
            letter = UNICODE.get(node.name, node.name)
            return letter + ("", "\u0307", "\u0308")[node.dots] + node.index.translate(LOWERED)
        case Sum():
            signs = ("-" if sign < 0 else "+" for sign, _ in node.terms)
            texts = (plain_text(term, rates) for _, term in node.terms)
            whole = " ".join(f"{sign} {text}" for sign, text in zip(signs, texts, strict=True))
            return whole.removeprefix("+ ")
        case Product():
            return ("*" if rates == "words" else " ").join(map(factor, node.factors))
        case Quotient():
            return f"{factor(node.numerator)}/{factor(node.denominator)}"
        case Power(base=Call() as call):
            return f"{call.function}({plain_text(call.argument, rates)})^{factor(node.exponent)}"
        case Power():
            return f"{factor(node.base)}^{factor(node.exponent)}"
        case Call():
            return f"{node.function}({plain_text(node.argument, rates)})"
        case Application(head=head, arguments=(argument,)):  # a product, as no letter is a function
            return plain_text(Product((head, argument), node.span), rates)
        case Derivative(operand=operand, variables=(variable,)):
            sign = "∂" if node.is_partial else "d"
            if isinstance(operand, Letter):
                return f"{sign}{operand.name}/{sign}{plain_text(variable, rates)}"
            return f"{sign}/{sign}{plain_text(variable, rates)}({plain_text(operand, rates)})"
    raise AssertionError(node)


STYLES: dict[str, Style] = {
    "lecture": Style(BY_POSITIONS, is_chained=True),
    "notes": Style(BY_STEPS, halves=True, energies=("T", "U", r"\mathcal{L}", "H")),
    "thesis": Style(
        (*BY_POSITIONS, "accelerations"), "tex", is_aligned=True, brackets=True, rates="time"
    ),
    "german": Style(
        BY_ENERGIES, "tex", ANGLES_PHI, language="de", energies=("T", "U", "L", "H"), halves=True
    ),
    "upright": Style(BY_POSITIONS, shift=sp.pi, is_aligned=True),
    "downwards": Style((*BY_POSITIONS, "energy"), is_down=True, times=r" \, "),
    "canonical": Style(BY_HAMILTON, "html", halves=True),
    "lagrangian_alone": Style(
        ("lagrangian", "partials", "equations"), "md", {"l": "L", "l1": "L_1", "l2": "L_2"},
        energies=("T", "V", r"\mathcal{L}", "H"),
    ),
    "abbreviating": Style(
        ("abbreviations", *BY_STEPS), abbreviated=("inertia", "difference", "total"), halves=True
    ),
    "notebook": Style(
        ("kinetic", "potential", "equations", "accelerations"), "ipynb", rates="leibniz",
        moves_right=True,
    ),
    "primes": Style(BY_ENERGIES, rates="prime", brackets=True),
    "blog": Style(
        BY_STEPS, "html", {"l": r"\ell", "l1": r"\ell_1", "l2": r"\ell_2", **ANGLES_PHI},
        brackets=True, is_chained=True, times=r" \cdot ",
    ),
    "mechanics_exam": Style(
        ("energy", "equations"), "tex", {"J": "I", "k": "c", "m": "M", "a": "d"}, halves=True,
        moves_right=True,
    ),
    "plain_text": Style(BY_STEPS, "txt", halves=True, brackets=True),
    "readme": Style((*BY_POSITIONS, "accelerations"), "txt", rates="words", is_chained=True),
    "horizontal": Style(BY_POSITIONS, shift=sp.pi / 2, is_chained=True),
    "leibniz": Style(
        (*BY_ENERGIES, "energy"), "tex", rates="leibniz", energies=("K", "U", "L", "H"),
    ),
    "long_hamilton": Style(
        ("kinetic", "potential", "momenta", "hamiltonian", "canonical"), "ipynb", ANGLES_PHI,
        rates="time", brackets=True,
    ),
    "speeds": Style(
        ("positions", "velocities", "kinetic", "potential", "equations"), is_down=True,
        letters={"theta": r"\alpha", "theta1": r"\alpha", "theta2": r"\beta", "alpha": "b",
                 "l": "R", "R": "D", "phi": r"\gamma"},
        energies=("T", "U", "L", "H"),
    ),
    "abbreviated_late": Style(
        ("kinetic", "potential", "abbreviations", "lagrangian", "partials", "equations"), "tex",
        abbreviated=("inertia", "total", "difference"), is_aligned=True,
    ),
    "accelerations_first": Style(
        ("equations", "accelerations", "energy"), letters=ANGLES_PHI, halves=True,
    ),
    "german_hamilton": Style(
        ("positions", "lagrangian", "momenta", "hamiltonian", "canonical"), "html", language="de",
        is_chained=True,
    ),
    "robotics": Style(
        ("positions", "velocities", "kinetic", "potential", "equations", "accelerations"), "rst",
        {"theta": "q", "theta1": "q_1", "theta2": "q_2", "l": "L", "l1": "L_1", "l2": "L_2"},
        energies=("K", "P", r"\mathcal{L}", "H"),
    ),
    "rearranged": Style((*BY_STEPS, "accelerations", "energy"), is_rearranged=True),
    "rearranged_hamilton": Style(
        ("kinetic", "potential", "momenta", "hamiltonian", "canonical"), "tex", ANGLES_PHI,
        energies=("K", "U", "L", "H"), is_rearranged=True,
    ),
    "french": Style(
        (*BY_STEPS, "energy"), "tex", {"theta": r"\alpha", "alpha": r"\beta", "l": r"\ell"},
        energies=("E_c", "E_p", "L", "H"), language="fr", halves=True, is_held_out=True,
    ),
    "hamilton_first": Style(
        ("hamiltonian", "canonical", "energy"), "rst", times=r" \, ", is_held_out=True,
    ),
    "horizontal_in_time": Style(
        (*BY_STEPS, "accelerations"), "ipynb", ANGLES_PHI, rates="time", shift=sp.pi / 2,
        brackets=True, moves_right=True, is_held_out=True,
    ),
    "downwards_chained": Style(
        ("positions", "potential", "kinetic", "lagrangian", "momenta", "equations"), "html",
        {"g": r"\gamma", "m": r"\mu", "m1": r"\mu_1", "m2": r"\mu_2"}, is_down=True,
        is_chained=True, halves=True, is_held_out=True,
    ),
}  # fmt: skip
