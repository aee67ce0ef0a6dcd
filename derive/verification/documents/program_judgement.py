"""Verdicts on the equations of programs, and on their methods of integration."""

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from derive.reading.latex.tree import Letter, Statement
from derive.reading.programs.findings.step_methods import STEP_SIZE
from derive.reading.programs.program import Finding, Program, ProgramEquation, RateFunction
from derive.verification.documents.formula_translation import FormulaText
from derive.verification.documents.letter_meanings import (
    Interpretation,
    alternatives,
    interpretation,
    unopposed,
)
from derive.verification.documents.letters.candidates import SystemCandidate
from derive.verification.documents.letters.hints import Hints, convention, without_meaning
from derive.verification.documents.pages.verdicts_in_place import (
    METHOD,
    Alternative,
    DocumentVerdicts,
    FormulaVerdict,
)
from derive.verification.documents.rules.corrected_formulas import inserted, source_span
from derive.verification.documents.rules.evidence.weighing import INHOMOGENEOUS, weighed
from derive.verification.documents.rules.side_verdict import HOLDING, SideVerdict
from derive.verification.documents.statements import DocumentFormula, Occurrence, Translated
from derive.verification.judging.verdict import VerdictName

#: Names, numbers and signs of an equation.
WORD_OR_SIGN = re.compile(r"\w+|\S")
#: The note on an equation that contradicts a system, perhaps because it is not read rightly.
WITH_STEP = "it contains the step size, as no acceleration does"
#: Names of angular velocities.
ANGULAR = re.compile(r"(d?_?(omega|Omega|theta|phi|psi|alpha|beta|ang)|w\d*\b)")


def judge_program(program: Program, hints: Hints | None = None) -> DocumentVerdicts:
    """Judge the equations of every function of a program, and its method of integration."""
    titles, conventions, others = list[str](), list[str](), list[Alternative]()
    judged: list[FormulaVerdict] = []
    negative = {one.name for one in program.constants if one.value.startswith("-")}
    for function in program.functions:
        best = _best(function, negative, hints)
        if best.candidate:
            titles.append(best.candidate.system.title)
            conventions.append(convention(best.candidate))
        others += best.others
        judged += best.verdicts
    judged += [_finding(one) for one in program.findings]
    judged.sort(key=lambda one: one.line)
    title, letters = ("; ".join(filter(None, dict.fromkeys(one))) for one in (titles, conventions))
    notes = tuple(_notes(program))
    return DocumentVerdicts(
        program.file, "program", title, tuple(judged), notes, letters, tuple(others)
    )


@dataclass(frozen=True)
class _Reading:
    """The verdicts on equations with the meaning of their letters, if one was found."""

    candidate: SystemCandidate | None
    verdicts: tuple[FormulaVerdict, ...]
    others: tuple[Alternative, ...]

    @property
    def holds(self) -> bool:
        """Whether all equations hold, but for definitions."""
        verdicts = {one.verdict for one in self.verdicts} - {"definition"}
        return bool(verdicts) and verdicts <= {*HOLDING}


def _best(function: RateFunction, negative: Collection[str], hints: Hints | None) -> _Reading:
    """The first meaning with which all equations hold, or else the first of all.

    Those of names of constants that others define count as well. Other spellings only show that
    equations hold.
    """
    best = _reading(function.equations, hints)
    if best.holds:
        return best
    if len(function.short) == len(function.equations):
        reading = _reading(function.short, hints)
        if reading.holds:
            return reading
        best = best if best.candidate else reading
    for equations in _spellings(function, negative):
        reading = _reading(equations, hints)
        if reading.holds:
            pairs = zip(reading.verdicts, function.equations, strict=True)
            return replace(reading, verdicts=tuple(replace(a, latex=b.text) for a, b in pairs))
    return best


def _reading(equations: Sequence[ProgramEquation], hints: Hints | None) -> _Reading:
    found = _interpretation(equations, hints)
    if found.match is None:
        odd, note = found.contradictions.inhomogeneous, without_meaning(hints)
        notes = (INHOMOGENEOUS if k in odd else note for k, _ in enumerate(equations))
        return _Reading(None, tuple(map(_plain, equations, notes)), ())
    candidate = found.match.candidate
    verdicts = found.judges.verdicts(candidate)
    results = [*weighed(verdicts, candidate, found.contradictions, hints is not None)]
    contrary = (*alternatives(found, results, {}),)
    pairs = zip(equations, unopposed(results, contrary), strict=True)
    judged = tuple(
        _plain(equation, WITH_STEP)
        if result.verdict.verdict == "wrong" and any(map(STEP_SIZE.search, formula.words))
        else _judged(equation, result)
        for equation, (formula, result) in pairs
    )
    return _Reading(candidate, judged, contrary)


def _spellings(
    function: RateFunction, negative: Collection[str]
) -> Iterator[tuple[ProgramEquation, ...]]:
    """Other texts of the equations of a function with the same meaning.

    With velocities, of which nothing is the coordinate, as rates; with negative constants as
    positive ones with a sign.
    """
    equations = function.equations
    kinds = {one.kind for one in equations}
    rates = [one.coordinate for one in equations if one.kind == "rate"]
    if len(kinds) > 1 and rates:
        turns = {q: ANGULAR.match(q) is not None for q in rates}
        names = {q: f"{'phi' if turns[q] else 'x'}_of_{q}" for q in rates}
        pairs = {q: f"{name}_dot" for q, name in names.items()}
        pairs |= {f"{q}_dot": f"{name}_ddot" for q, name in names.items()}
        yield _respelled(equations, pairs)
    if signed := {new: f"(-{new})" for old, new in function.names.items() if old in negative}:
        yield _respelled(equations, signed)


def _respelled(
    equations: Sequence[ProgramEquation], names: Mapping[str, str]
) -> tuple[ProgramEquation, ...]:
    """Equations with other names; their parts have no lines of their own."""
    word = re.compile("|".join(rf"\b{name}\b" for name in names))
    return tuple(
        replace(one, text=word.sub(lambda match: names[match[0]], one.text), origins=())
        for one in equations
    )


def _interpretation(equations: Sequence[ProgramEquation], hints: Hints | None) -> Interpretation:
    statements = Translated(tuple(map(_formula, equations)), (), {})
    return interpretation(statements, hints, are_of_program=True)


def _formula(equation: ProgramEquation) -> DocumentFormula:
    """An equation as a formula of a document; it has no LaTeX."""
    text = equation.text
    tree = Statement((Letter(text, (0, len(text))),), (), (0, len(text)))
    occurrence = Occurrence(0, equation.line, 1, 0, 0, text, tree)
    left, _, right = text.partition(" = ")
    sides = _side(left, 0), _side(right, len(left) + len(" = "))
    return DocumentFormula(occurrence, sides, ("=",))


def _side(text: str, offset: int) -> FormulaText:
    """A side of an equation, which begins at `offset` in it."""
    places = [match.span() for match in WORD_OR_SIGN.finditer(text)]
    parts = tuple((start, end, (start + offset, end + offset)) for start, end in places)
    return FormulaText(text, parts=parts)


def _judged(equation: ProgramEquation, result: SideVerdict) -> FormulaVerdict:
    verdict, text = result.verdict, equation.text
    spans = [(source_span(text, result, one), one) for one in verdict.corrections if one.wrong]
    changes = sorted(((span, one) for span, one in spans if span), key=lambda change: change[0])
    terms, line = [one.wrong for _, one in changes], equation.line
    for (start, end), one in reversed(changes):
        unsigned = text[start:end].lstrip("+- ")
        line = _line(equation, end - len(unsigned), end)
        text = inserted(text[:start], one.wrong, one.correct, text[end:])
    correction = verdict.correction
    if terms and len(terms) == len(verdict.corrections):
        correction = text
    elif correction and "=" not in correction:
        correction = f"{equation.text.partition(' = ')[0]} = {correction}"
    return FormulaVerdict(
        line, 1, 0, equation.text, verdict.verdict, "; ".join(terms), correction,
        verdict.witness, verdict.note, state=verdict.state,
    )  # fmt: skip


def _line(equation: ProgramEquation, start: int, end: int) -> int:
    """The line of the smallest part of an equation that contains a term."""
    around = [one for one in equation.origins if one.start <= start and end <= one.end]
    return min(around, key=lambda one: one.end - one.start).line if around else equation.line


def _plain(equation: ProgramEquation, note: str) -> FormulaVerdict:
    return FormulaVerdict(equation.line, 1, 0, equation.text, "context", note=note)


def _finding(finding: Finding) -> FormulaVerdict:
    verdict: VerdictName = "wrong" if finding.is_fault else "context"
    return FormulaVerdict(finding.line, 1, 0, METHOD, verdict, note=finding.text)


def _notes(program: Program) -> Iterator[str]:
    for one in program.unread:
        place = f" in {one.function}" if one.function else ""
        yield f"line {one.line}{place} is not read: {one.reason}"
