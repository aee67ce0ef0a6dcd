"""Frequencies and periods of small motions, and the equations that determine them."""

import re
from collections.abc import Iterator, Sequence
from contextlib import suppress

import sympy as sp

from derive.formulas.expression import parse
from derive.formulas.syntax import ExpressionError
from derive.verification.documents.formula_translation import FormulaText
from derive.verification.documents.rules.consequences import WithVerdict
from derive.verification.documents.rules.known_values import DocumentNamespace
from derive.verification.documents.rules.roles import Roles
from derive.verification.documents.rules.side_verdict import SideVerdict, plain
from derive.verification.documents.rules.small_motions import MAX_INVERSE, SmallMotions
from derive.verification.documents.statements import SQUARE, DocumentFormula

#: Letters of angular frequencies, frequencies and periods: a factor and a power of the first.
FREQUENCY_LETTERS: dict[str, tuple[sp.Expr, int]] = {
    **dict.fromkeys(("omega", "Omega", "w"), (sp.S.One, 1)),
    **dict.fromkeys(("f", "nu"), (1 / (2 * sp.pi), 1)),
    **dict.fromkeys(("T", "P", "tau"), (2 * sp.pi, -1)),
}
#: Words of sentences about them.
ABOUT_FREQUENCIES = re.compile(
    "fre[qc]uen|fréquen|frequenz|pulsa|p[eé]riod|oscill|schwing|eigen|harmoni|natural|\\bSHM\\b|周期|频率"
    "|頻率|振動数",
    re.IGNORECASE,
)
OF_SMALL_MOTIONS = "it is that of small motions"
#: Letters of which the determinant of the equations of small motions is a function.
ROOTS = ("omega", "Omega", "w", "lambda", "lamda", "s")
OF_DETERMINANT = "it determines the frequencies of small motions"


class Frequencies:
    """Verdicts on frequencies by the linearised equations of motion about an equilibrium."""

    def __init__(self, namespace: DocumentNamespace, linear: SmallMotions, roles: Roles) -> None:
        self._namespace, self._linear, self._roles = namespace, linear, roles

    def verdict(
        self, formula: DocumentFormula, name: str, side: FormulaText, power: int
    ) -> SideVerdict | None:
        """The verdict on a power of a frequency or period; None if it can be another quantity."""
        system = self._namespace.derivation.system
        letter, _, index = name.partition("_")
        value = self._namespace.value(side.text)
        is_named = letter in FREQUENCY_LETTERS and not isinstance(value, sp.MatrixBase)
        has_place = 0 < len(system.q) <= MAX_INVERSE and not system.constraints
        if not is_named or not has_place or self._linear.place is None:
            return None
        if value == 0 or not value.free_symbols <= {*system.params}:
            return None
        M, D, K, _ = self._linear.matrices
        factor, sign = FREQUENCY_LETTERS[letter]
        square = (value ** sp.Rational(1, power) / factor) ** (2 * sign)
        is_zero = self._namespace.model.context.is_zero
        if is_zero((K - square * M).det()):
            return plain("verified", formula, OF_SMALL_MOTIONS)
        if len(system.q) > 1:
            return None
        required = K[0] / M[0]
        if is_zero(square - required + (D[0] / M[0]) ** 2 / 4):
            return plain("verified", formula, f"{OF_SMALL_MOTIONS} with friction")
        is_about = index in ("", "0", "n") and ABOUT_FREQUENCIES.search(formula.occurrence.prose)
        if not is_about or not self._is_only_one(required) or any(D):
            return None
        if sp.cancel(square).free_symbols != sp.cancel(required).free_symbols:
            return None  # that of another motion
        correct = factor * sp.sqrt(required) ** sign
        result = self._roles.value(side, name, correct**power)
        return result if result.verdict.verdict == "wrong" else None

    def contradicted(self, verdicts: Sequence[WithVerdict]) -> list[WithVerdict]:
        """The verdicts, with `wrong` for a frequency to which another formula gives its value.

        One term of it must be another one.
        """
        result, right = [*verdicts], dict[str, tuple[DocumentFormula, int]]()
        for formula, one in verdicts:
            if one.verdict.verdict == "verified" and OF_SMALL_MOTIONS in one.verdict.note:
                right.setdefault(*_named(formula))
        for number, (formula, one) in enumerate(verdicts):
            name, (_, power) = _named(formula)
            if one.verdict.verdict == "definition" and name and name in right:
                other, exponent = right[name]
                with suppress(ExpressionError, NotImplementedError):
                    value = self._namespace.value(other.sides[-1].text)
                    correct = value ** sp.Rational(power, exponent)
                    own = self._roles.value(formula.sides[-1], name, correct)
                    if own.verdict.verdict == "wrong" and len(own.verdict.corrections) == 1:
                        result[number] = formula, own
        return result

    def determining(self, formula: DocumentFormula, unknown: Sequence[str]) -> SideVerdict | None:
        """The verdict on an equation for frequencies, such as (2*k - m*omega**2)**2 - k**2 = 0.

        Each side is a factor of the determinant of the equations of small motions. None if it can
        be another equation: it must have the same powers, and one slip must explain it.
        """
        sides = [one for one in formula.sides if one.text != "0"]
        letter, system = unknown[0].partition("_")[0], self._namespace.derivation.system
        has_place = 0 < len(system.q) <= MAX_INVERSE and not system.constraints
        if letter not in ROOTS or len(unknown) > 1 or not has_place or self._linear.place is None:
            return None
        if not 0 < len(sides) < len(formula.sides):
            return None
        x = system.qdot[0]  # for any number: no side contains velocities
        names = {**self._namespace.all_names, unknown[0]: x}
        try:
            values = [sp.expand(parse(side.text, names)) for side in sides]
            polynomials = [
                sp.Poly(value, x) for value in values if value.free_symbols & {*system.params}
            ]
        except (ExpressionError, NotImplementedError, TypeError, ValueError, sp.PolynomialError):
            return None
        if len(polynomials) < len(sides) or any(
            one.free_symbols_in_domain - {*system.params} for one in polynomials
        ):
            return None
        for determinant in self._determinants(letter, x):
            wrong = [k for k, one in enumerate(polynomials) if not _divides(one, determinant)]
            if not wrong:
                return plain("verified", formula, OF_DETERMINANT)
            side, own = sides[wrong[0]], polynomials[wrong[0]]
            if own.monoms() == determinant.monoms():
                for first, second in ((own.LC(), determinant.LC()), (own.TC(), determinant.TC())):
                    required = sp.expand(determinant.as_expr() * first / second)
                    result = self._roles.value(side, "determinant", required, {unknown[0]: x})
                    if len(result.verdict.corrections) == 1:
                        return result
        return None

    def _determinants(self, letter: str, x: sp.Symbol) -> Iterator[sp.Poly]:
        """Yield the determinants of small motions as polynomials of a letter."""
        M, D, K, _ = self._linear.matrices
        if letter in FREQUENCY_LETTERS:
            matrices = [] if any(D) else [K - x**2 * M]
        else:
            matrices = [x**2 * M + x * D + K, *([] if any(D) else [K - x * M, K + x * M])]
        yield from (sp.Poly(sp.expand(one.det()), x) for one in matrices)

    def _is_only_one(self, square: sp.Expr) -> bool:
        """Whether motions about the origin are stable, and forces have no other equilibrium.

        These are forces that depend on the coordinate alone but for a factor, as g sin(θ)/l does.
        """
        d = self._namespace.derivation
        (q,), (v,) = d.system.q, d.system.qdot
        force = -d.lagrangian.subs(v, 0).diff(q)
        is_known = bool(force) and sp.simplify(force / force.diff(q).subs(q, 0)) in (q, sp.sin(q))
        return self._linear.is_origin and is_known and not square.could_extract_minus_sign()


def _named(formula: DocumentFormula) -> tuple[str, tuple[DocumentFormula, int]]:
    """The name to a power of which a formula gives a value, with the formula and the power."""
    square = SQUARE.fullmatch(formula.sides[0].text)
    return (square[1], (formula, 2)) if square else (formula.subject, (formula, 1))


def _divides(one: sp.Poly, other: sp.Poly) -> bool:
    """Whether a polynomial that is no number is a factor of another one."""
    return one.degree() > 0 and all(sp.simplify(c) == 0 for c in sp.rem(other, one).coeffs())
