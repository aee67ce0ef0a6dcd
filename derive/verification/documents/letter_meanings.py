"""The meaning of the letters of a document: the system for which most of its formulas hold."""

import re
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import chain, islice
from math import inf

import sympy as sp

from derive.system.parts import SystemDefinitionError
from derive.system.system import System
from derive.verification.documents.formula_translation import FormulaText
from derive.verification.documents.judges import (
    TIE,
    Judges,
    Results,
    contradictions_of,
    with_direction,
    with_fewest_slips,
)
from derive.verification.documents.letters.candidates import SystemCandidate, candidates
from derive.verification.documents.letters.dimensions import (
    Restoration,
    inhomogeneous_formulas,
    with_other_powers,
)
from derive.verification.documents.letters.document_system import derivation
from derive.verification.documents.letters.energies import has_rotations, systems_of_energies
from derive.verification.documents.letters.hints import Hints, difference, is_crossed, names_of
from derive.verification.documents.letters.known_systems.templates import templates
from derive.verification.documents.letters.letter_roles import letters_of
from derive.verification.documents.letters.letters import Letters
from derive.verification.documents.letters.stated_equations import StatedEquations, is_reaction
from derive.verification.documents.letters.stated_positions import (
    stated_candidates,
    stated_systems,
)
from derive.verification.documents.letters.subjects import (
    has_arbitrary_potential,
    with_arbitrary_potentials,
)
from derive.verification.documents.numbers.matching import Match, best_matches, trivial_comparisons
from derive.verification.documents.pages.verdicts_in_place import Alternative, VerdictDifference
from derive.verification.documents.rules.consequences import Contradictions
from derive.verification.documents.rules.corrected_formulas import corrected
from derive.verification.documents.rules.side_verdict import CORRECT, SideVerdict, plain
from derive.verification.documents.statements import DocumentFormula, Translated

#: The least part of the comparisons that must hold for a system to be that of a document, unless
#: so many hold.
LEAST, ENOUGH = 0.3, 3
#: Numbers in the moments of inertia of rods.
THIRD = re.compile(r"\b(?:3|6|12|24)\b")
#: The least part if the meaning of letters is not the usual one, and of all formulas that must
#: hold for a known system.
UNUSUAL = 0.4
#: What a system can rest on, of two with the same score the last.
BASES = ("equations", "energies", "catalogue", "positions")
#: Most work of a search: characters of formulas, times candidates, times coordinates. Documents
#: of several pages take up to two fifths.
MAX_WORK = 1_000_000_000
#: Most stated systems that are tried by all verdicts where numbers support none.
MAX_VERIFIED = 4
#: The fewest wrong formulas that one slip in a position can explain, and most slips tried.
SEVERAL, MAX_POSITIONS = 2, 12
#: Most formulas with a slip for a usual meaning to be considered beside an unusual one.
MAX_SLIPS = 2


@dataclass
class Work:
    """Work that the search for the meanings of a document's letters may still do."""

    left: int = MAX_WORK

    def take(
        self,
        tried: Sequence[SystemCandidate],
        letters: Letters,
        formulas: Sequence[DocumentFormula],
    ) -> bool:
        """Take the work of a comparison of candidates; False where none is left."""
        size = sum(len(formula.text) for formula in formulas)
        self.left -= len(tried) * size * len(letters.coordinates)
        return self.left >= 0


@dataclass(frozen=True)
class Interpretation:
    """What a document is about: the system that suits its letters best, and its judges."""

    judges: "Judges"
    match: Match | None
    #: Other candidates that can be meant as well, the likeliest first.
    rivals: tuple[Match, ...] = ()
    contradictions: Contradictions = field(default_factory=Contradictions)
    #: Without a match, a system that formulas state and with which one other does not hold.
    refuted: Match | None = None


def interpretation(
    statements: Translated,
    hints: Hints | None = None,
    work: Work | None = None,
    known: Collection[str] = (),
    are_of_program: bool = False,
) -> Interpretation:
    """Find the meaning of letters for which most formulas hold; none where no `work` is left.

    Known systems are tried unless all coordinates are those of another system, which are `known`.
    If none suits, parameters without a letter are taken for numbers: gravity for that of the
    formulas, others for 1. A potential of which the variables alone are stated is any function.
    """
    work = work or Work()
    general = with_arbitrary_potentials(statements)
    if general != statements:
        result = _interpretation(general, hints, work, known, are_of_program)
        if result.match and has_arbitrary_potential(result.match.candidate.letters):
            return result
    return _interpretation(statements, hints, work, known, are_of_program)


def _interpretation(
    statements: Translated,
    hints: Hints | None,
    work: Work,
    known: Collection[str],
    are_of_program: bool,
) -> Interpretation:
    letters = letters_of(statements.formulas, statements.derivatives)
    letters = replace(letters, elsewhere=frozenset(known), are_of_program=are_of_program)
    judges = Judges(statements, letters)
    if hints:
        return _best(judges, hints.candidates(letters), work, 0)
    is_general = has_arbitrary_potential(letters.parameters)  # known systems have their own
    is_further = not is_general and not {*letters.coordinates} <= {*known}
    known_systems = partial(_of_templates, letters, statements) if is_further else None
    result = _best(judges, _stated(letters, statements), work, known_systems=known_systems)
    if is_further and _lacks_numbers(result.match, letters):
        numbers = {"gravity": _gravity(statements)}
        other = _best(judges, _of_templates(letters, statements, numbers=numbers), work)
        if other.match and (result.match is None or other.match.score > result.match.score):
            result = other
    odd = inhomogeneous_formulas(
        letters, statements.formulas, statements.derivatives, statements.elsewhere
    )
    if len(odd) == 1:
        return _without_inhomogeneous(result, odd)
    return replace(result, contradictions=replace(result.contradictions, inhomogeneous=odd))


def _lacks_numbers(match: Match | None, letters: Letters) -> bool:
    """Whether numbers can stand for parameters: nothing holds, or not all of a program."""
    if match is None or match.holding < 1:
        return True
    return bool(match.failed) and letters.are_of_program


def _without_inhomogeneous(
    result: Interpretation, odd: Mapping[int, Restoration | None]
) -> Interpretation:
    """The interpretation, or one by the other formulas if these alone refute the inhomogeneous."""
    judges, (number,) = result.judges, odd
    letters, statements = judges.letters, judges.statements
    known = replace(result.contradictions, inhomogeneous=odd)
    own = result.match.candidate if result.match else None
    if own and _refutes(judges, own, number):
        disputed = {k: them - {number} for k, them in known.disputed.items() if them - {number}}
        known = replace(known, disputed=disputed)
        if judges.count_wrong(own) == 1:
            return replace(result, contradictions=known)
    if own and number in own.stating and (restored := _restored(judges, own, number)):
        match = _match(judges, restored)
        return Interpretation(judges, match, contradictions=Contradictions(inhomogeneous=odd))
    nothing = replace(statements.formulas[number], sides=(FormulaText("0"),), relations=())
    others = (*statements.formulas[:number], nothing, *statements.formulas[number + 1 :])
    tried = chain.from_iterable(_stated(letters, replace(statements, formulas=others)))
    for candidate in islice(tried, MAX_VERIFIED):
        match = _match(judges, candidate)
        if match is None or match.holding < len(match.failed):
            continue  # more than one formula contradicts it, which takes seconds to show
        if _refutes(judges, candidate, number) and judges.count_wrong(candidate) == 1:
            return Interpretation(judges, match, contradictions=Contradictions(inhomogeneous=odd))
    return replace(result, contradictions=known)


def _match(judges: Judges, candidate: SystemCandidate) -> Match | None:
    """How well a candidate fits; None if nothing can be compared."""
    formulas, derivatives = judges.statements.formulas, judges.statements.derivatives
    matches = best_matches([candidate], judges.letters, formulas, derivatives, frozenset())
    return next(iter(matches), None)


def _with_free_reactions(best: Match, judges: Judges) -> Match:
    """The match without loads that have letters of reactions, if more formulas hold without them.

    So F in the equations of a rolling disc is the friction that its constraint requires. Such a
    force stands in several equations.
    """
    own, formulas = best.candidate, judges.statements.formulas
    reactions = {
        name for name, _ in own.forces
        if is_reaction(name) and sum(name in one.words for one in formulas) > 1
    }  # fmt: skip
    forces = tuple(one for one in own.forces if one[0] not in reactions)
    if not best.failed or not reactions:
        return best
    free = _match(judges, replace(own, forces=forces))
    tried = [best, *([free] if free else [])]
    return max(tried, key=lambda one: judges.count_holding(one.candidate))


def _with_other_position(best: Match, judges: Judges) -> Match:
    """The match with one term of a stated position changed, if this explains all wrong formulas.

    These are several, and one slip in the position is likelier than the same one in each of them.
    """
    own = best.candidate
    if own.basis != "positions" or len(best.failed) < SEVERAL or own.condition_count:
        return best
    holding = judges.count_holding(own)
    if judges.count_wrong(own) < SEVERAL:
        return best
    for system in islice(_with_changed_positions(own.system), MAX_POSITIONS):
        other = _match(judges, replace(own, system=system))
        if other is None or len(other.failed) > len(best.failed) - SEVERAL + 1:
            continue
        is_explained = judges.count_wrong(other.candidate) < SEVERAL
        if is_explained and judges.count_holding(other.candidate) >= holding + SEVERAL:
            return other
    return best


def _with_changed_positions(system: System) -> Iterator[System]:
    """Yield the system with another sign of a term of a position, or a cosine for a sine."""
    for number, mass in enumerate(system.masses):
        for k, component in enumerate(mass.position):
            terms = sp.Add.make_args(sp.expand(component))
            changes = [component - 2 * one for one in terms] if len(terms) > 1 else []
            for one in terms:
                turned = {**{f: sp.cos(*f.args) for f in one.atoms(sp.sin)},
                          **{f: sp.sin(*f.args) for f in one.atoms(sp.cos)}}  # fmt: skip
                changes += [component - one + one.xreplace({f: g}) for f, g in turned.items()]
            for changed in changes:
                position = [*mass.position[:k], changed, *mass.position[k + 1 :]]
                masses = [*system.masses]
                masses[number] = replace(mass, position=tuple(position))
                with suppress(SystemDefinitionError):
                    other = replace(system, masses=masses)
                    derivation(other)  # which refuses coordinates that are not independent
                    yield other


def _restored(judges: Judges, own: SystemCandidate, number: int) -> SystemCandidate | None:
    """The candidate that an inhomogeneous formula states with another power of a letter.

    None if no more formulas hold with it than with the stated one.
    """
    letters, statements = judges.letters, judges.statements
    formulas, derivatives = statements.formulas, statements.derivatives
    tried = [
        replace(candidate, stating=candidate.stating - {number})
        for changed in with_other_powers(letters, formulas, derivatives, number)
        for candidate in chain.from_iterable(
            _stated(letters, replace(statements, formulas=changed))
        )
        if number in candidate.stating
    ]
    first = max(tried[:MAX_VERIFIED], key=judges.count_holding, default=own)
    is_better = judges.count_holding(first) > judges.count_holding(own)
    return first if is_better and _refutes(judges, first, number) else None


def _refutes(judges: Judges, candidate: SystemCandidate, number: int) -> bool:
    """Whether a formula is wrong in one term by a system."""
    formula = judges.statements.formulas[number]
    if not _is_slip_of_a_term(judges.judge(candidate).verdict(formula)):
        return False  # for which the other verdicts are not required
    _, result = judges.verdicts(candidate)[number]
    return _is_slip_of_a_term(result)


def _is_slip_of_a_term(result: SideVerdict) -> bool:
    """Whether a verdict is `wrong` with a correction of one term."""
    return result.verdict.verdict == "wrong" and len(result.verdict.corrections) == 1


def _best(
    judges: Judges,
    groups: Iterable[Sequence[SystemCandidate]],
    work: Work,
    least: float = LEAST,
    known_systems: Callable[[bool], Iterable[Sequence[SystemCandidate]]] | None = None,
) -> Interpretation:
    """The candidate that most formulas support, if a part of them does, and its rivals.

    Known systems are tried last; beside a stated one, no parameter of these lacks a letter.
    """
    letters, statements = judges.letters, judges.statements
    formulas, derivatives = statements.formulas, statements.derivatives
    trivial = trivial_comparisons(letters, formulas, derivatives)
    matches: list[Match] = []
    stated: list[Match] = []
    circular: list[Match] = []
    has_matrix = "mass_matrix" in letters.quantities.values()

    def all_groups() -> Iterator[Sequence[SystemCandidate]]:
        yield from groups
        if known_systems:
            yield from known_systems(any(_is_supported(one, least) for one in matches))

    for tried in (tried for group in all_groups() for tried in _alike(group)):
        if not work.take(tried, letters, formulas):
            break
        least_support = _least_support(matches, least)
        result = best_matches(tried, letters, formulas, derivatives, trivial, least_support)
        held = [match for match in result if match.holding or not least]
        first = held[0].candidate if held else None  # others have the same constraints
        if first and first.condition_count and not judges.has_motions(first):
            continue
        stated += [match for match in held if match.candidate.stating]
        if not held and has_matrix and tried[0].basis == "energies":  # entries are not compared
            stated.append(Match(tried[0], 0.0, 0, frozenset()))
        for match in held:
            (circular if match.is_circular else matches).append(match)
        if any(match.is_stated_by_positions or match.is_complete for match in result):
            break  # no other system suits better
    supported = [match for match in matches if not least or _is_supported(match, least)]

    def rank(match: Match) -> tuple[float, int, int]:
        has_absent_parts = bool(match.candidate.numbers)
        basis = -1 if has_absent_parts else BASES.index(match.candidate.basis)
        return match.score, -len(match.failed), basis

    best = max(supported, key=rank, default=None)  # the first of several with the same rank
    if best is None:
        # of a stated system another formula can follow, such as for small angles
        stated = sorted(stated, key=lambda one: -one.score)[:MAX_VERIFIED]
        fitting = next((one for one in stated if _fits(judges, one.candidate)), None)
        by_energies = (one for one in stated if not one.candidate.is_of_equations)
        refuted = next((one for one in by_energies if one.is_refuted_by_one), None)
        return Interpretation(judges, fitting, refuted=None if fitting else refuted)
    best = with_direction(best, matches, judges)
    best = _with_other_position(_with_free_reactions(best, judges), judges)
    best, is_decided = with_fewest_slips(best, matches, judges)
    rivals = tuple(_rivals(best, matches))
    if best.candidate.basis == "energies":  # which equations alone can contradict
        matches += circular
    contradictions = Contradictions() if is_decided else contradictions_of(best, matches, judges)
    return Interpretation(judges, best, rivals, contradictions)


def _least_support(matches: Sequence[Match], least: float) -> float:
    """The support below which a known system changes nothing.

    Where the document states a system, all others can show that it is wrong.
    """
    if not least or any(match.candidate.basis != "catalogue" for match in matches):
        return -inf
    supported = (match.score for match in matches if _is_supported(match, least))
    return max(supported, default=-inf) - TIE


def _fits(judges: Judges, candidate: SystemCandidate) -> bool:
    """Whether a formula is verified by a system and none is wrong, or two beside a wrong one."""
    if judges.has_several_wrong(candidate):
        return False
    kinds = Counter(one.verdict.verdict for _, one in judges.verdicts(candidate))
    return kinds["wrong"] <= 1 and kinds["verified"] > kinds["wrong"]


def _alike(group: Sequence[SystemCandidate]) -> Iterator[Sequence[SystemCandidate]]:
    """Candidates of one system with the same constraints."""
    result: dict[frozenset[int], list[SystemCandidate]] = {}
    for one in group:
        result.setdefault(one.given, []).append(one)
    yield from result.values()


def _is_supported(best: Match, least: float) -> bool:
    """Whether enough comparisons hold: more of them if most do not, or letters are unusual."""
    held = best.compared - len(best.failed)
    is_known = best.candidate.basis == "catalogue"
    if best.support < 0 and held < (UNUSUAL * best.compared if is_known else ENOUGH):
        return False
    holding, compared = best.holding - best.stating, best.compared - best.stating
    if best.candidate.is_usual:
        return holding >= max(1, min(ENOUGH, least * compared))
    return holding >= max(1, UNUSUAL * compared)


def _rivals(best: Match, matches: Iterable[Match]) -> Iterator[Match]:
    """Matches of other motions with the support of the best; the usual one but for few slips."""
    known, has_usual = {best.signature}, best.candidate.is_usual
    for match in sorted(matches, key=lambda one: -one.score):
        is_slip = not has_usual and _is_slip(match, best)
        has_support = match.support >= best.support
        if match.signature in known or not (is_slip or has_support):
            continue
        if _is_plausible(match.candidate, best.candidate):
            known.add(match.signature)
            has_usual |= is_slip
            yield match


def _is_slip(match: Match, best: Match) -> bool:
    """Whether few slips would explain a document with the usual meaning of its letters."""
    is_usual = match.candidate.system is best.candidate.system and match.candidate.is_usual
    return is_usual and match.is_nearly and len(match.failed) <= MAX_SLIPS


def _is_plausible(rival: SystemCandidate, best: SystemCandidate) -> bool:
    """Whether a rival lacks no more parameters, has no crossed indices and no further loads."""
    loads, own = ({*one.forces, *one.friction} for one in (rival, best))
    is_simple = rival.lacking <= best.lacking and not own < loads
    return is_simple and (is_crossed(best) or not is_crossed(rival))


def _stated(letters: Letters, statements: Translated) -> Iterator[Sequence[SystemCandidate]]:
    """Candidates of one system after another that the document states."""
    for system in stated_systems(letters, statements.formulas):
        if letters.constraints and has_rotations(system, letters, statements.formulas):
            continue
        yield [*stated_candidates(system, letters)]
    for system, numbers in systems_of_energies(letters, statements.formulas):
        tried = (replace(one, stating=numbers) for one in stated_candidates(system, letters))
        yield [one for one in tried if one.constraints or not letters.constraints]
    yield from ([one] for one in StatedEquations(letters, statements.formulas).candidates())


def _of_templates(
    letters: Letters,
    statements: Translated,
    has_all: bool = False,
    numbers: Mapping[str, str] | None = None,
) -> Iterator[Sequence[SystemCandidate]]:
    """Candidates of one known system after another."""
    has_time = any("t" in formula.words for formula in statements.formulas)
    has_rods = any(THIRD.search(formula.text) for formula in statements.formulas)
    for count in range(len(letters.coordinates), 0, -1):
        for system in templates(letters, count, has_rods, has_time):
            yield [*candidates(system, letters, numbers, has_all)]


def _gravity(statements: Translated) -> str:
    """The number in the formulas that is gravity, or 1."""
    texts = " ".join(formula.text for formula in statements.formulas)
    result = re.search(r"\b9\.[78]\d*\b", texts)
    return result[0] if result else "1"


def general_verdicts(statements: Translated) -> Iterator[tuple[DocumentFormula, SideVerdict]]:
    """Yield statements with an index that hold for any motion, such as q̇_i = ∂H/∂p_i."""
    general = tuple(one for one in statements.formulas if one.index)
    letters = letters_of(general, statements.derivatives)
    trivial = trivial_comparisons(letters, general, statements.derivatives)
    for number, formula in enumerate(general):
        if all((number, side.text) in trivial for side in formula.sides[1:]):
            yield formula, plain("verified", formula, "it holds for any motion")


#: Most meanings that are judged beside the one that is taken.
MAX_ALTERNATIVES = 3
JUDGED = (*CORRECT, "wrong")
#: The reason of a verdict on a formula that another meaning of the letters does not refute.
OPPOSED = "it is wrong with these meanings of the letters, but holds with others that fit too"


def alternatives(
    result: Interpretation, results: Results, written: Mapping[str, str]
) -> Iterator[Alternative]:
    """Yield the rivals of the meaning that is taken which change a verdict or a correction."""
    assert result.match
    seen: set[tuple[object, ...]] = set()
    for rival in result.rivals[:MAX_ALTERNATIVES]:
        pairs = _rejudged(result, rival, results)
        own = sum(one.verdict.verdict not in CORRECT for _, one, _ in pairs)
        other = sum(one.verdict.verdict not in CORRECT for _, _, one in pairs)
        taken, rival_one = result.match.candidate, rival.candidate
        is_odd = taken.is_usual and rival_one.is_turned
        opposes = {taken.basis, rival_one.basis} == {"catalogue"} and not is_odd
        changed = tuple(_differences(pairs, written, opposes))
        kinds = tuple((one.line, one.latex, one.verdict) for one in changed)
        is_usual = rival_one.is_usual and not taken.is_usual
        if changed and kinds not in seen and (other <= own or is_usual):
            seen.add(kinds)
            yield _alternative(result.match, rival, changed)


def _rejudged(
    result: Interpretation, rival: Match, results: Results
) -> list[tuple[DocumentFormula, SideVerdict, SideVerdict]]:
    """The formulas that do not hold with both meanings, and their verdicts with each."""
    assert result.match
    failed = result.match.failed | rival.failed
    if not failed:
        return []
    judge = result.judges.judge(rival.candidate)
    pairs = (pair for k, pair in enumerate(results) if k in failed)
    return [(formula, one, judge.verdict(formula)) for formula, one in pairs]


def _differences(
    pairs: Sequence[tuple[DocumentFormula, SideVerdict, SideVerdict]],
    written: Mapping[str, str],
    opposes: bool,
) -> Iterator[VerdictDifference]:
    """Yield what changes; with `opposes`, formulas that hold with one meaning are `context`."""
    for formula, own, other in pairs:
        names = [one.verdict.verdict for one in (own, other)]
        if any(name not in JUDGED for name in names):
            continue
        first, second = (corrected(formula, one, written) for one in (own, other))
        has_other = (names[0] == "wrong") != (names[1] == "wrong")
        is_opposed = opposes and has_other and names[0] == "wrong"
        if has_other or first.correction != second.correction:
            place, verdict = formula.occurrence, "context" if is_opposed else names[0]
            yield VerdictDifference(
                place.line, place.display, place.source, names[1], verdict,
                second.correction, place.cell,
            )  # fmt: skip


def unopposed(
    results: Results, others: Sequence[Alternative]
) -> Iterator[tuple[DocumentFormula, SideVerdict]]:
    """Yield the verdicts, with `context` for a wrong formula that holds with another meaning."""
    opposed = {
        (one.line, one.display, one.latex, one.cell)
        for other in others
        for one in other.differences
        if one.instead_of == "context"
    }
    for formula, result in results:
        place = formula.occurrence
        is_opposed = (place.line, place.display, place.source, place.cell) in opposed
        if is_opposed and result.verdict.verdict == "wrong":
            result = plain("context", formula, OPPOSED)
        yield formula, result


def _alternative(match: Match, rival: Match, changed: tuple[VerdictDifference, ...]) -> Alternative:
    system, own = rival.candidate.system, match.candidate
    meaning = difference(rival.candidate, own) if system is own.system else ""
    return Alternative(system.title, system.name, names_of(rival.candidate), meaning, changed)
