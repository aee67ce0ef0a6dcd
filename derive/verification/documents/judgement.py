"""Verdicts on all formulas of a document, from its displays alone."""

import re
from collections.abc import Collection, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import replace

from derive.reading.document import Display, Document, divided
from derive.reading.latex.display_reader import formulas, macros_of
from derive.reading.latex.tree import (
    Derivative,
    Letter,
    Span,
    Statement,
    Unreadable,
    nodes,
)
from derive.reading.plain_formulas import PLAIN
from derive.verification.documents.formula_translation import (
    RATES,
    FormulaTranslator,
    UntranslatableError,
    order,
    stem,
)
from derive.verification.documents.letter_meanings import (
    Interpretation,
    Work,
    alternatives,
    general_verdicts,
    interpretation,
    unopposed,
)
from derive.verification.documents.letters.hints import Hints, convention, without_meaning
from derive.verification.documents.letters.letter_forms import (
    VARIANTS,
    with_one_letter,
    with_own_letters,
)
from derive.verification.documents.letters.letter_roles import letters_of
from derive.verification.documents.letters.letters import Letters
from derive.verification.documents.letters.stated_constraints import WAY_OUT
from derive.verification.documents.letters.subjects import (
    ARBITRARY,
    Formulas,
    implied_rates,
    of_single_coordinates,
    restated_subjects,
    subjects,
    with_loads_behind,
)
from derive.verification.documents.pages.verdicts_in_place import (
    JUDGED,
    Alternative,
    DocumentVerdicts,
    FormulaVerdict,
)
from derive.verification.documents.rules.consequences import WithVerdict, opposed
from derive.verification.documents.rules.corrected_formulas import corrected
from derive.verification.documents.rules.corrected_formulas import written as latex_of
from derive.verification.documents.rules.evidence.weighing import (
    INHOMOGENEOUS,
    of_dimensions,
    weighed,
)
from derive.verification.documents.rules.identities import Identities
from derive.verification.documents.rules.side_verdict import CORRECT, HOLDING, SideVerdict, plain
from derive.verification.documents.statements import (
    IMPLIED,
    POINT,
    DocumentFormula,
    Occurrence,
    Translated,
    general_statements,
    notation,
    translated,
)
from solvers.io.suggestion import did_you_mean

#: Most systems of a section of a document.
MAX_SYSTEMS = 3
#: The note on a document of which too many meanings are possible.
PARTIAL = (
    "not all meanings of its letters were tried, so that verdicts are partial: state the system "
    "by --system, and its letters by --names"
)
#: Brackets around a letter, as those of a function's argument.
BRACKETS = re.compile(r"\s*(?:\\left)?\(\s*([^()]*?)\s*(?:\\right)?\)\s*")
#: The reason of a verdict on a formula that is wrong for one of two subjects.
OF_OTHER_SUBJECT = "it does not hold for the system of its section, but for another of the document"
#: Verdicts from the gravest: that of a formula with an index is the gravest of its instances.
GRAVEST = ("wrong", "context", "definition", "equivalent", "verified")

#: Characters before and after a formula in which its sentence is sought.
BEFORE, AFTER = 300, 100
#: The number of an equation beside it.
LABEL = re.compile(r"\([IVXivx]+\)")
#: Ends of sentences and of paragraphs.
END = re.compile(r"[.!?](?=\s)|\n\s*\n\s*\n|\\(?:section|begin\{document\})")
#: Formulas, in which there are no words.
FORMULA = re.compile(
    r"\$\$.*?\$\$|\$.*?\$|\\\[.*?\\\]|\\begin\{(\w+\*?)\}.*?\\end\{\1\}", re.DOTALL
)


def judge_document(document: Document, hints: Hints | None = None) -> DocumentVerdicts:
    """Judge every formula of a document.

    A document can treat several systems: another is sought for the formulas with letters that
    have no meaning in those before, then for such below each heading. Where formulas do not hold,
    energies that are stated anew can be those of other systems.
    """
    occurrences, unreadable = _read(document)
    result = _by_subjects(document, hints, occurrences, unreadable)
    for variant, name in VARIANTS:
        wrong = _wrong(result)
        if wrong and (same := with_one_letter(occurrences, variant, name)):
            other = _by_subjects(document, hints, same, unreadable)
            is_worse = len(_wrong(other)) > len(wrong)
            if _wrong(other) < wrong or (not is_worse and _holding(other) > _holding(result)):
                note = f"{variant} and {name} are taken for one letter, with which more holds"
                result = replace(other, notes=(*other.notes, note))
    return result


def _by_subjects(
    document: Document,
    hints: Hints | None,
    occurrences: Sequence[Occurrence],
    unreadable: Sequence[FormulaVerdict],
) -> DocumentVerdicts:
    """Verdicts with other subjects where energies are stated anew, if more formulas hold so.

    If as many do, more of them must hold by what the document states.
    """
    statements = with_loads_behind(implied_rates(translated(occurrences)))
    parts = subjects(document.text, statements)
    work = Work()
    result = _judge(document, hints, occurrences, unreadable, statements, parts, work)
    if general := general_statements(statements):
        own = statements.part(general)
        places = subjects(document.text, own)
        other = _judge(document, hints, occurrences, unreadable, own, places, work)
        result = _with_general(result, other)
    if hints or all(one.verdict in CORRECT for one in result.formulas):
        return result
    others = restated_subjects(document.text, statements)
    if others != parts:
        other = _judge(document, hints, occurrences, unreadable, statements, others, work)
        accused = _wrong(other) - _wrong(result)
        more = _holding(other) - _holding(result)
        gain = more or _holding(other, "document") - _holding(result, "document")
        has_few = len(_wrong(other)) <= len(_wrong(result)) or len(accused) <= gain
        if more >= 0 and gain > 0 and has_few:
            return _undisputed(other, result)
        return _undisputed(result, other)
    return result


def _with_general(verdicts: DocumentVerdicts, general: DocumentVerdicts) -> DocumentVerdicts:
    """The verdicts, with those on formulas that are wrong but for parameters that are equal."""
    held = {one.span for one in verdicts.formulas if one.verdict in CORRECT}
    wrong = {one.span: one for one in general.formulas if one.verdict == "wrong"}
    if len(wrong) > _holding(general):
        return verdicts
    own = {span: one for span, one in wrong.items() if span in held}
    return replace(verdicts, formulas=tuple(own.get(one.span, one) for one in verdicts.formulas))


def _undisputed(verdicts: DocumentVerdicts, others: DocumentVerdicts) -> DocumentVerdicts:
    """The verdicts, with `context` for what is wrong but holds with the other subjects."""
    held = {one.span for one in others.formulas if one.verdict in HOLDING}
    formulas = [
        replace(one, verdict="context", wrong_term="", correction="", witness="", state="",
                wrong_spans=(), basis="", note=OF_OTHER_SUBJECT)
        if one.verdict == "wrong" and one.span in held else one
        for one in verdicts.formulas
    ]  # fmt: skip
    return replace(verdicts, formulas=tuple(formulas))


def _holding(verdicts: DocumentVerdicts, basis: str = "") -> int:
    """The number of formulas that hold, or that do by statements of this kind."""
    return sum(one.verdict in CORRECT and basis in ("", one.basis) for one in verdicts.formulas)


def _wrong(verdicts: DocumentVerdicts) -> set[Span]:
    """The places of wrong formulas."""
    return {one.span for one in verdicts.formulas if one.verdict == "wrong"}


def _judge(
    document: Document,
    hints: Hints | None,
    occurrences: Sequence[Occurrence],
    unreadable: Sequence[FormulaVerdict],
    statements: Translated,
    parts: Sequence[Formulas],
    work: Work,
) -> DocumentVerdicts:
    """Verdicts on the statements of a document with some subjects."""
    judged = [*unreadable]
    judged += [_plain(place, "context", note) for place, note in statements.failures]
    written = _written(occurrences)
    titles, conventions, others = list[str](), list[str](), list[Alternative]()
    results: dict[Occurrence, tuple[DocumentFormula, SideVerdict]] = {}
    known: set[Occurrence] = set()  # formulas that a known system judges
    reasons: dict[Occurrence, str] = {}  # why formulas without a system have none
    waiting = [*parts]
    while waiting:
        remaining, count, moving = waiting.pop(0), 0, set[str]()
        while remaining and count < (1 if hints else MAX_SYSTEMS):
            count += 1
            found = interpretation(statements.part(remaining), hints, work, moving)
            open_ones = (one for one in statements.formulas if one.occurrence not in results)
            if found.match is None and (more := _with_stating(open_ones, remaining, statements)):
                beside = interpretation(statements.part(more), hints, work, moving)
                if beside.match and beside.match.candidate.basis != "catalogue":
                    found, remaining = beside, more
            if found.match is None:
                for number, restoration in found.contradictions.inhomogeneous.items():
                    if restoration:
                        formula = remaining[number]
                        result = of_dimensions(formula, restoration)
                        results[formula.occurrence] = formula, result
                for number, reason in _reasons(found, remaining):
                    reasons.setdefault(remaining[number].occurrence, reason)
                break
            candidate = found.match.candidate
            moving.update(candidate.coordinates)
            judges = found.judges
            own = judges.verdicts(candidate)
            is_stated, is_partial = hints is not None, work.left < 0
            verdicts = [*weighed(own, candidate, found.contradictions, is_stated, is_partial)]
            if not titles or any(result.is_understood for _, result in verdicts):
                titles.append(candidate.title)
                conventions.append(convention(candidate))
            elsewhere = {*statements.formulas} - {*remaining}
            is_known = candidate.basis == "catalogue" and hints is None
            letters = judges.letters
            verdicts = [*_without_foreign(verdicts, letters, elsewhere, is_known)]
            contrary = [*alternatives(found, verdicts, written)]
            others += contrary
            verdicts = [*unopposed(verdicts, contrary)]
            for formula, result in verdicts:
                before = results.get(formula.occurrence)
                if before is None or _is_graver(result, before[1]):
                    results[formula.occurrence] = formula, result
                    (known.add if is_known else known.discard)(formula.occurrence)
            bound = {q for one in candidate.constraints for q in one.coordinates}
            remaining = tuple(
                one for one, result in verdicts
                if not result.is_understood and bound.isdisjoint(map(stem, one.words))
            )  # fmt: skip
        if remaining and not hints:
            parted = divided(document.text, remaining, lambda one: one.occurrence.start)
            if len(parted) == 1 and not titles:
                parted = of_single_coordinates(statements, remaining)
            waiting += [one for one in parted if len(one) < len(remaining)]
    understood = {place for place, (_, result) in results.items() if result.is_understood}
    left = {one for one in statements.formulas if one.occurrence not in understood}
    identities = Identities(statements.formulas, statements.derivatives, left)
    follow = *general_verdicts(statements), *identities.verdicts()
    results |= {one.occurrence: (one, result) for one, result in follow if one in left}
    for one, result in identities.multiples():
        before = results.get(one.occurrence)
        if before is None or before[1].verdict.verdict not in (*HOLDING, "wrong"):
            results[one.occurrence] = one, result
    note = without_meaning(hints)
    if work.left < 0:
        note = (
            f"its {len(statements.formulas)} formulas have too many letters to try all meanings: "
            "state the system by --system, and its letters by --names"
        )
    letters = letters_of(statements.formulas, statements.derivatives)
    if letters.multipliers or letters.constraints:
        note = f"{note}: {WAY_OUT}"
    results = {place: pair for place, pair in results.items() if place.display != IMPLIED}
    stated = {one.occurrence for one in statements.formulas if one.occurrence.display != IMPLIED}
    places = stated - {*results}
    judged += [_plain(place, "context", reasons.get(place, note)) for place in places]
    judged += [_judged(*pair, written, place in known) for place, pair in results.items()]
    partial = (PARTIAL,) if work.left < 0 and titles else ()
    notes = (*document.notes, *partial, *_unused(hints, statements.formulas))
    system, ordered = "; ".join(dict.fromkeys(titles)), sorted(judged, key=lambda one: one.span)
    meanings = "; ".join(filter(None, dict.fromkeys(conventions)))
    return DocumentVerdicts(
        document.file, document.kind, system, tuple(ordered), notes, meanings, tuple(others)
    )


def _with_stating(
    others: Iterable[DocumentFormula], formulas: Formulas, statements: Translated
) -> Formulas:
    """Formulas of a section with energies and positions in their coordinates before it.

    Nothing if there are none.
    """
    own = {*letters_of(formulas, statements.derivatives).coordinates}
    before = [one for one in others if one.occurrence.start < formulas[0].occurrence.start]
    quantities = letters_of(before, statements.derivatives).quantities
    stating = []
    for one in before:
        rates = {stem(word) for word in one.words if order(word)}
        is_energy = one.subject in quantities and rates and rates <= own
        if is_energy or (POINT.match(one.subject) and own & {*one.words} and not rates):
            stating.append(one)
    return (*stating, *formulas) if stating else ()


def _reasons(found: Interpretation, formulas: Formulas) -> Iterator[tuple[int, str]]:
    """Why formulas have no system, by their numbers.

    The dimensions of one contradict those of all others, or it contradicts the one that states a
    system.
    """
    yield from ((number, INHOMOGENEOUS) for number in found.contradictions.inhomogeneous)
    if found.refuted:
        stating, (failed,) = found.refuted.candidate.stating, found.refuted.failed
        yield failed, opposed(formulas[min(stating)].occurrence.line)
        yield from ((one, opposed(formulas[failed].occurrence.line)) for one in sorted(stating))


def _without_foreign(
    verdicts: Sequence[WithVerdict],
    letters: Letters,
    others: Collection[DocumentFormula],
    is_known: bool,
) -> Iterator[WithVerdict]:
    """The verdicts, with `context` for wrong formulas with letters of another meaning.

    Other parts of the document define parameters by coordinates, or before the formula coordinates
    of a known system by those of another one.
    """
    definitions = {
        one.subject: one.occurrence
        for one in others
        if one.subject in letters.parameters and {*one.words} & {*letters.coordinates}
    }
    foreign = {stem(word) for one in others for word in one.words if order(word) and is_known}
    foreign -= {*letters.coordinates}
    before = {
        one.subject: one.occurrence
        for one in others
        if one.subject in letters.coordinates and foreign.intersection(one.words)
    }
    for formula, result in verdicts:
        start = formula.occurrence.start
        own = {name: one for name, one in before.items() if one.start < start} | definitions
        words = [word for word in formula.words if word in own and word != formula.subject]
        if words and result.verdict.verdict == "wrong":
            note = f"line {own[words[0]].line} defines {words[0]} for another system"
            result = plain("context", formula, note)
        yield formula, result


def _read(document: Document) -> tuple[list[Occurrence], list[FormulaVerdict]]:
    """All statements of a document, and those that cannot be read."""
    macros = macros_of("\n".join(document.definitions))
    occurrences, unreadable = [], []
    for display in document.displays:
        for one in formulas(display.latex, macros):
            place = _occurrence(document, display, one)
            if isinstance(one, Unreadable):
                if not display.is_inline:
                    unreadable.append(_plain(place, "unreadable", one.reason))
            elif one.relations or not (display.is_inline or LABEL.fullmatch(place.source)):
                occurrences.append(place)
    return with_own_letters(occurrences), unreadable


def _occurrence(document: Document, display: Display, tree: Statement | Unreadable) -> Occurrence:
    line, column, cell = document.place(display.start + tree.span[0])
    prose = sentence(document, display)
    return Occurrence(
        display.number, line, column, cell, display.start, display.latex, tree, prose,
        is_plain=display.delimiter == PLAIN,
    )  # fmt: skip


def _plain(place: Occurrence, verdict: str, note: str) -> FormulaVerdict:
    span = place.span
    return FormulaVerdict(
        place.line, place.column, place.display, place.source, verdict,  # type: ignore[arg-type]
        note=note, span=span, cell=place.cell,
    )  # fmt: skip


def _judged(
    formula: DocumentFormula, result: SideVerdict, written: dict[str, str], is_known: bool
) -> FormulaVerdict:
    place, verdict = formula.occurrence, result.verdict
    correction = corrected(formula, result, written)
    spans = tuple((place.start + a, place.start + b) for a, b in correction.spans if a < b)
    return FormulaVerdict(
        place.line, place.column, place.display, place.source, verdict.verdict,
        correction.wrong_term, correction.correction, verdict.witness, verdict.note,
        place.span, place.cell, spans, _state(verdict.state, written),
        ("known system" if is_known else "document") if verdict.verdict in JUDGED else "",
    )  # fmt: skip


def _state(state: str, letters: dict[str, str]) -> str:
    """The numbers of a state, with the letters as the document writes them."""
    pairs = (one.partition(" = ") for one in filter(None, state.split(", ")))
    pairs = (one for one in pairs if not one[0].startswith(ARBITRARY))
    return ", ".join(f"{latex_of(name, letters)} = {number}" for name, _, number in pairs)


def _is_graver(one: SideVerdict, other: SideVerdict) -> bool:
    """Whether a verdict prevails over one on another instance, or in another system."""
    if one.is_understood != other.is_understood:
        return one.is_understood
    order = [GRAVEST.index(result.verdict.verdict) for result in (one, other)]
    return order[0] < order[1]


def _written(occurrences: Sequence[Occurrence]) -> dict[str, str]:
    """The letters' names, and the LaTeX that stands for each where it is first used."""
    translator, result = FormulaTranslator(notation(occurrences)), dict[str, str]()
    for occurrence in occurrences:
        for node in nodes(occurrence.sides):
            if isinstance(node, Letter | Derivative):
                own = occurrence.latex[slice(*node.span)]
                inside = BRACKETS.fullmatch(own)
                with suppress(UntranslatableError):  # such as the derivative of a sum
                    result.setdefault(translator.text(node).text, inside[1] if inside else own)
    return result


def _unused(hints: Hints | None, formulas: Sequence[DocumentFormula]) -> Iterator[str]:
    """Notes on letters of hints that no formula has."""
    words = {word for formula in formulas for word in formula.words}
    for letter in hints.names if hints else ():
        if not words & {letter + ending for ending in RATES}:
            known = sorted({stem(word) for word in words})
            yield f"names.{letter}: no formula has this letter{did_you_mean(letter, known)}"


def sentence(document: Document, display: Display) -> str:
    """The words of the sentence with a display, without those of its formulas."""
    start, end = display.extent
    before = document.text[max(0, start - BEFORE) : start]
    after = document.text[end : end + AFTER]
    head = END.split(_words(before))[-1]
    tail = "" if _is_end(document.text[start:end]) else END.split(_words(after))[0]
    return f"{head} {tail}"


def _words(text: str) -> str:
    """Text without formulas; a formula that ends with a full stop ends its sentence."""
    return FORMULA.sub(lambda result: ". " if _is_end(result[0]) else " ", text)


def _is_end(formula: str) -> bool:
    return re.sub(r"\\end\{\w+\*?\}", "", formula).rstrip(" $\\]\n").endswith(".")
