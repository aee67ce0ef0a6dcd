"""Advice on wrong formulas: the first wrong term, its correction, and a numeric witness."""

from contextlib import suppress
from dataclasses import replace

import sympy as sp

from derive.formulas.expansion import is_expandable
from derive.formulas.expression import ExpressionError
from derive.verification.model import Model, depends_on, variables
from derive.verification.terms import (
    Term,
    Terms,
    WrongTerm,
    common_factor,
    differing_functions,
    first_wrong_term,
    split_terms,
    terms_of_equation,
)
from derive.verification.verdict import Verdict


def advised(verdict: Verdict, model: Model, derived: sp.Expr | None) -> Verdict:
    """Add advice to the verdict on a wrong formula; on an equation of motion, none is derived.

    In unusual quotients no term is identified.
    """
    terms = terms_of_equation(verdict.printed, model.context.scope)
    value, wrong_term = sp.Add(*(term.value for term in terms)), None
    if derived is None:
        derived = closest_equation(terms, model)
        wrong_term = first_wrong_term(terms, derived, variables(model.derivation.system))
    elif is_expandable(value):
        wrong_term = _wrong_term_of_quotient(verdict.printed, model, derived)
    if wrong_term is None:
        return verdict
    return replace(verdict, wrong_term=wrong_term.text, correct_term=str(wrong_term.correct))


def closest_equation(terms: Terms, model: Model) -> sp.Expr:
    """Return the derived equation of motion, times a factor, from which `terms` differ least."""
    system = model.derivation.system
    state = variables(system)
    equations = model.derivation.euler_lagrange
    candidates = [e * common_factor(terms, e, state, system.qddot) for e in equations]
    return min(candidates, key=lambda e: len(differing_functions(terms, e, state)))


def _wrong_term_of_quotient(text: str, model: Model, derived: sp.Expr) -> WrongTerm | None:
    """Return the first wrong term of a sum, or of a quotient: its denominator comes first."""
    scope, state = model.context.scope, variables(model.derivation.system)
    terms = split_terms(text, scope)
    if len(terms) == 1:
        numerator, denominator = sp.fraction(sp.together(terms[0].value))
        derived_numerator, derived_denominator = sp.fraction(sp.together(derived))
        if depends_on(denominator, state):
            ratio = common_factor([Term("", denominator)], derived_denominator, state)
            if not model.context.is_zero(denominator - ratio * derived_denominator):
                return WrongTerm(str(denominator), sp.expand(ratio * derived_denominator))
            terms, derived = [Term(text, numerator)], derived_numerator * ratio
            printed = text.rpartition("/")[0].strip()
            if printed[:1] == "(" and printed[-1:] == ")":
                with suppress(ExpressionError):  # the brackets can belong to two factors
                    terms = split_terms(printed[1:-1], scope)
    return first_wrong_term(terms, derived, state)
