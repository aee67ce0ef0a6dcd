"""Definitions that can be wrong in place of a formula with their letter."""

from collections import Counter
from collections.abc import Sequence
from contextlib import suppress

import sympy as sp

from derive.formulas.syntax import ExpressionError
from derive.verification.documents.rules.consequences import WithVerdict, opposed
from derive.verification.documents.rules.defined_names import required_value
from derive.verification.documents.rules.evidence.slips import factor_of, is_slip
from derive.verification.documents.rules.known_values import DocumentNamespace
from derive.verification.documents.rules.side_verdict import HOLDING, SideVerdict, plain
from derive.verification.documents.statements import POINT, WORD, DocumentFormula
from derive.verification.judging.reference_system import depends_on, time_derivative

#: Why a formula gives no value.
FAILURES = (ExpressionError, NotImplementedError, TypeError, ValueError)


def with_open_definitions(
    namespace: DocumentNamespace, verdicts: Sequence[WithVerdict]
) -> list[WithVerdict]:
    """The verdicts, with `context` for a wrong formula if a definition can be wrong in its place.

    This is that of a letter in it with which no other formula holds, unless one slip elsewhere in
    the formula explains it.
    """
    result = [*verdicts]
    supported = Counter(
        word
        for formula, one in verdicts
        if one.verdict.verdict in HOLDING
        for word in {*formula.words} - {formula.subject}
    )
    kinds = {id(formula): one.verdict for formula, one in verdicts}
    for number, (formula, one) in enumerate(verdicts):
        if one.verdict.verdict != "wrong":
            continue
        for name in {*formula.words} - {formula.subject}:
            definition, _ = namespace.defining.get(name, (formula, ""))
            kind = kinds.get(id(definition))
            states_constraint = definition.sides[-1].text == "0"
            if definition is formula or kind is None or supported[name] or states_constraint:
                continue
            is_open = kind.verdict == "definition" and not kind.note and definition.occurrence.line
            if is_open and _can_be_wrong(namespace, name, formula, one):
                note = opposed(definition.occurrence.line)
                result[number] = formula, plain("context", formula, note)
    return result


def _can_be_wrong(
    namespace: DocumentNamespace, name: str, formula: DocumentFormula, result: SideVerdict
) -> bool:
    """Whether another value of a letter explains a wrong formula as well as its correction does."""
    value, corrections = namespace.names[name], result.verdict.corrections
    if isinstance(value, sp.MatrixBase) or value.is_Symbol or POINT.match(name):
        return False
    system = namespace.derivation.system
    moving = {*system.q, *system.qdot, *system.qddot} - value.free_symbols
    with suppress(*FAILURES):
        other = required_value(namespace, name, formula)
        if other is not None and depends_on(other, moving):
            return False
        is_moving = depends_on(value, system.qdot)
        if is_moving and namespace.model.agreement(time_derivative(system, value)) is not None:
            return False  # a constant of the motion
    if not is_slip(corrections):
        return True
    term, *others = corrections
    is_missing = not term.wrong and name in WORD.findall(term.correct)
    is_factor = name in WORD.findall(term.wrong) and not sp.expand(value).is_Add
    return not others and (is_missing or (is_factor and factor_of(term) != -1))
