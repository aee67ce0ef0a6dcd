"""Definitions that can be wrong in place of a formula with their letter."""

from collections import Counter
from collections.abc import Sequence
from contextlib import suppress

import sympy as sp

from derive.formulas.expression import FUNCTIONS, parse
from derive.formulas.syntax import ExpressionError
from derive.verification.documents.formula_translation import order, stem
from derive.verification.documents.letters.stated_equations import is_reaction
from derive.verification.documents.rules.consequences import WithVerdict, opposed
from derive.verification.documents.rules.defined_names import required_value
from derive.verification.documents.rules.evidence.slips import factor_of, is_slip
from derive.verification.documents.rules.known_values import DocumentNamespace
from derive.verification.documents.rules.side_verdict import HOLDING, SideVerdict, plain
from derive.verification.documents.statements import POINT, WORD, DocumentFormula
from derive.verification.judging.reference_system import depends_on, time_derivative
from derive.verification.judging.verdict import Correction

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
        for name in _names(namespace, formula):
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


def _names(namespace: DocumentNamespace, formula: DocumentFormula) -> set[str]:
    """The names in a formula but its subject, and those in the definitions of these."""
    result, waiting = set[str](), {*formula.words} - {formula.subject}
    while waiting:
        result |= waiting
        texts = [namespace.defining[name][1] for name in waiting if name in namespace.defining]
        waiting = {word for text in texts for word in WORD.findall(text)} - result
    return result


def _can_be_wrong(
    namespace: DocumentNamespace, name: str, formula: DocumentFormula, result: SideVerdict
) -> bool:
    """Whether another value of a letter explains a wrong formula as well as its correction does."""
    value, corrections = namespace.names[name], result.verdict.corrections
    if isinstance(value, sp.MatrixBase):
        return not is_slip(corrections)
    if value.is_Symbol or POINT.match(name):
        return False
    system = namespace.derivation.system
    moving = {*system.q, *system.qdot, *system.qddot} - value.free_symbols
    is_force = is_reaction(name) and 2 in map(order, formula.words)
    is_constant = False  # of the motion
    with suppress(*FAILURES):
        other = required_value(namespace, name, formula)
        slopes = [other.diff(one) for one in moving & other.free_symbols] if other else []
        if not all(map(namespace.model.context.is_small, slopes)):
            return is_force and [one.wrong for one in corrections] == [""]
        rate = time_derivative(system, value)
        is_constant = depends_on(value, system.qdot) and namespace.model.agreement(rate) is not None
    if not is_slip(corrections):
        return not is_constant
    term, *others = corrections
    if others:
        return False
    if not term.wrong:
        return is_force or name in WORD.findall(term.correct)
    definition, _ = namespace.defining[name]
    factor = _factor_of_letter(name, term)
    if factor is None or factor == -1 or sp.expand(value).is_Add:
        return False
    letters = {str(one) for one in factor.free_symbols}
    if name in letters:  # which has another power
        return False
    changed = {one for one in letters if stem(one) in namespace.letters.coordinates}
    return changed <= (set() if is_constant else {*definition.words})


def _factor_of_letter(name: str, term: Correction) -> sp.Expr | None:
    """The factor of a letter that has the effect of a slip in a term; None if none has."""
    factor = factor_of(term)
    symbols = {word: sp.Symbol(word, positive=True) for word in WORD.findall(term.wrong)}
    with suppress(*FAILURES):
        written = sp.sympify(parse(term.wrong, {**symbols, **FUNCTIONS}))
        power = written.as_powers_dict()[sp.Symbol(name, positive=True)]
        if factor is not None and power:
            root = factor ** (1 / power)
            number, _ = root.as_coeff_Mul()
            is_rational = root.is_number is not True or root.is_rational
            return root if is_rational and number.is_rational else None
    return None
