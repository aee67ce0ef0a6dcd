"""Forces, friction and other letters that corrections add to formulas or take from them."""

from collections.abc import Iterator, Sequence

import sympy as sp

from derive.formulas.expression import FUNCTIONS
from derive.system.symbols import TIME
from derive.verification.documents.formula_translation import order
from derive.verification.documents.letters.candidates import SystemCandidate
from derive.verification.documents.letters.document_system import derivation
from derive.verification.documents.rules.consequences import WithVerdict
from derive.verification.documents.rules.side_verdict import HOLDING, SideVerdict
from derive.verification.documents.statements import WORD, DocumentFormula


def exchanges_loads(result: SideVerdict, candidate: SystemCandidate) -> bool:
    """Whether a formula has other letters of forces and friction than a system, and else agrees."""
    loads = {name for name, _ in (*candidate.forces, *candidate.friction)}
    pairs = [
        [loads & {*WORD.findall(text)} for text in (one.wrong, one.correct)]
        for one in result.verdict.corrections
    ]
    is_exchanged = any(a and b and a != b for a, b in pairs)
    return is_exchanged and all(a or b for a, b in pairs)


def is_driven(candidate: SystemCandidate) -> bool:
    """Whether equations of a driven motion state the system, which leave its energies open."""
    return candidate.is_of_equations and candidate.system.potential_energy.has(TIME)


def of_friction(results: Sequence[WithVerdict], candidate: SystemCandidate) -> Iterator[int]:
    """Yield the numbers of wrong formulas that differ in friction of Rayleigh's function.

    This can be wrong, too: it is right if it leads to other formulas that contain its letters.
    """
    if candidate.basis not in ("positions", "energies"):
        return
    names = {symbol.name for symbol in sp.Tuple(*candidate.system.forces).free_symbols}
    letters = {letter for name, letter in candidate.parameters.items() if name in names}
    supported = {
        word
        for formula, one in results
        if one.verdict.verdict in HOLDING and formula.subject not in letters
        for word in formula.words
    }
    for number, (formula, result) in enumerate(results):
        if result.verdict.verdict == "wrong":
            terms = [
                text for one in result.verdict.corrections for text in (one.wrong, one.correct)
            ]
            words = {w for text in terms for w in WORD.findall(text)} or {*formula.words}
            own = words & letters
            if own and not own <= supported:
                yield number


def adds_letters(formula: DocumentFormula, result: SideVerdict, candidate: SystemCandidate) -> bool:
    """Whether a correction has forces or friction that a formula, as of a case without, has not.

    Of a system that equations state, these are all letters; of a known system parameters, too, if
    the formula is that of a free motion.
    """
    letters = added(formula, result)
    if candidate.is_of_equations:
        return bool(letters)
    loads = {name for name, _ in (*candidate.forces, *candidate.friction)}
    loads |= {*_of_drives(candidate)}
    parameters = {*candidate.parameters.values()}
    is_zero = any(side.text == "0" for side in formula.sides)
    is_free = is_zero and all(order(one) == 2 or one in parameters for one in formula.words)
    if candidate.basis == "catalogue" and is_free:
        loads |= parameters
    return bool(letters & loads)


def added(formula: DocumentFormula, result: SideVerdict) -> set[str]:
    """The letters of corrections that a formula has not, but for a lost dot."""
    terms = [one for one in result.verdict.corrections if one.correct != f"{one.wrong}_dot"]
    names = {word for one in terms for word in WORD.findall(one.correct)}
    return names - {*formula.words, *FUNCTIONS}


def adds_constant_force(
    formula: DocumentFormula, result: SideVerdict, candidate: SystemCandidate
) -> bool:
    """Whether an energy lacks the potential of a letter that equations have as a force, R s.

    Such a letter stands alone in equations, with a sign of the direction of the motion perhaps.
    """
    terms = result.verdict.corrections
    if not candidate.is_of_equations or len(terms) != 1 or terms[0].wrong:
        return False
    words = WORD.findall(terms[0].correct)
    letters = added(formula, result)
    is_linear = len(words) == 2 and "**" not in terms[0].correct
    return is_linear and len(letters) == 1 and not {*words} - letters - {*candidate.coordinates}


def _of_drives(candidate: SystemCandidate) -> Iterator[str]:
    """The letters of friction and of given functions of time in a system."""
    system = candidate.system
    places = (component for one in system.masses for component in one.position)
    energies = sp.Add.make_args(sp.expand(system.potential_energy))
    driving = [one for one in (*places, *energies) if one.has(TIME)]
    if driving and not derivation(system).lagrangian.has(TIME):
        driving = []  # in a rotating frame
    symbols = sp.Tuple(system.dissipation, *system.forces, *driving).free_symbols
    for parameter in system.parameters:
        if parameter.symbol in symbols and parameter.symbol.name in candidate.parameters:
            yield candidate.parameters[parameter.symbol.name]
