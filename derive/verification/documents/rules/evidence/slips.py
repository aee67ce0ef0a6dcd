"""Corrections that a slip of the pen explains.

A slip changes a sign, a numerical factor, one factor, power or function, one letter for another, or
omits a term. A formula that only other changes reconcile with a system is as likely one of another
system, or misread, as it is wrong. So is one with a term too many, which can be another effect.
"""

from collections.abc import Sequence

import sympy as sp

from derive.formulas.expression import FUNCTIONS, parse
from derive.formulas.syntax import ExpressionError
from derive.verification.documents.statements import OWN_CONSTANT, WORD
from derive.verification.judging.verdict import Correction

#: The largest numerator and denominator of a numerical factor.
MAX_NUMBER = 9
#: The largest change of the power of a factor.
MAX_POWER = 2


def is_slip(corrections: Sequence[Correction]) -> bool:
    """Whether the corrections of a formula are those of one slip, perhaps in several terms."""
    changes = {factor_of(one) for one in corrections}
    return len(changes) == 1 and None not in changes


def is_change(corrections: Sequence[Correction]) -> bool:
    """Whether the corrections are those of one slip that changes one term."""
    return len(corrections) == 1 and corrections[0].wrong != "" and is_slip(corrections)


def factor_of(correction: Correction) -> sp.Expr | None:
    """The factor by which a slip changes a term, or the missing term; None if it is no slip."""
    try:
        wrong, correct = _values(correction)
    except ExpressionError:
        return None
    if wrong == 0:
        return correct if _is_missing(correct) else None
    if correct == 0:
        return None
    if (factor := _factor(wrong, correct)) is not None:
        return factor
    # one of several terms in brackets
    terms, others = ({*sp.Add.make_args(sp.expand(one))} for one in (wrong, correct))
    constants = {
        term for term in others if any(map(OWN_CONSTANT.fullmatch, map(str, term.free_symbols)))
    }
    if constants:  # the term is known up to one
        terms = {term for term in terms if term.free_symbols}
    lost, new = terms - others, others - terms - constants
    if len(lost) > 1 or len(new) != 1:
        return None
    if not lost:
        return correct - wrong if _is_missing(*new) else None
    return _factor(*lost, *new)


def _values(correction: Correction) -> tuple[sp.Expr, sp.Expr]:
    """A wrong and a correct term; equal parts that are no scalars are one letter."""
    wrong, correct = correction.wrong, correction.correct
    try:
        return _value(wrong), _value(correct)
    except ExpressionError:
        if not wrong:
            raise
        return sp.Symbol("term"), _value(correct.replace(wrong, "term"))


def _value(text: str) -> sp.Expr:
    letters = {word: sp.Symbol(word, positive=True) for word in WORD.findall(text)}
    value = parse(text or "0", {**letters, **FUNCTIONS})
    if isinstance(value, sp.MatrixBase) or not isinstance(value, sp.Expr):
        raise ExpressionError(f"{text!r} is no number")
    return value


def _is_missing(value: sp.Expr) -> bool:
    """Whether a term can have been forgotten: one product with a usual numerical factor."""
    return not sp.expand(value).is_Add and _is_number(value.as_coeff_Mul()[0])


def _factor(wrong: sp.Expr, correct: sp.Expr) -> sp.Expr | None:
    """The factor between two terms, if a slip explains it.

    It is a sign or a number, a power, or a letter or function for another one. A sum in brackets is
    a factor if it stands in the term already.
    """
    for ratio in (correct / wrong, sp.cancel(correct / wrong)):
        number, rest = ratio.as_coeff_Mul()
        powers = {base: power for base, power in rest.as_powers_dict().items() if base != 1}
        is_own = len(powers) == 1 and wrong.has(*powers)
        are_usual = all(
            power.is_number and abs(power) <= MAX_POWER and (is_own or not base.is_Add)
            for base, power in powers.items()
        )
        is_exchange = len(powers) == 2 and sum(powers.values()) == 0
        if _is_number(number) and are_usual and (len(powers) < 2 or is_exchange):
            return ratio
    return None


def _is_number(value: sp.Expr) -> bool:
    is_rational = isinstance(value, sp.Rational)
    return is_rational and max(abs(value.p), value.q) <= MAX_NUMBER
