"""Verdicts on the equations of programs, and on their methods of integration."""

import re
from collections.abc import Iterator, Sequence

from derive.reading.latex.tree import Letter, Statement
from derive.reading.programs.program import Finding, Program, ProgramEquation
from derive.verification.documents.formula_translation import FormulaText
from derive.verification.documents.letter_meanings import (
    Interpretation,
    alternatives,
    interpretation,
    unopposed,
)
from derive.verification.documents.letters.hints import Hints, convention, without_meaning
from derive.verification.documents.pages.verdicts_in_place import (
    METHOD,
    Alternative,
    DocumentVerdicts,
    FormulaVerdict,
)
from derive.verification.documents.rules.corrected_formulas import inserted, source_span
from derive.verification.documents.rules.evidence import weighed
from derive.verification.documents.rules.side_verdict import SideVerdict
from derive.verification.documents.statements import DocumentFormula, Occurrence, Translated
from derive.verification.judging.verdict import VerdictName

#: Names, numbers and signs of an equation.
WORD_OR_SIGN = re.compile(r"\w+|\S")


def judge_program(program: Program, hints: Hints | None = None) -> DocumentVerdicts:
    """Judge the equations of every function of a program, and its method of integration."""
    titles, conventions, others = list[str](), list[str](), list[Alternative]()
    judged: list[FormulaVerdict] = []
    for function in program.functions:
        equations, found = function.equations, _interpretation(function.equations, hints)
        if found.match is None and len(function.short) == len(equations):
            equations, found = function.short, _interpretation(function.short, hints)
        if found.match is None:
            note = without_meaning(hints)
            judged += [_plain(equation, note) for equation in function.equations]
            continue
        candidate = found.match.candidate
        titles.append(candidate.system.title)
        conventions.append(convention(candidate))
        verdicts = found.judges.verdicts(candidate)
        results = [*weighed(verdicts, candidate, found.contradictions, hints is not None)]
        contrary = [*alternatives(found, results, {})]
        others += contrary
        pairs = zip(equations, unopposed(results, contrary), strict=True)
        judged += [_judged(equation, result) for equation, (_, result) in pairs]
    judged += [_finding(one) for one in program.findings]
    judged.sort(key=lambda one: one.line)
    title, letters = ("; ".join(filter(None, dict.fromkeys(one))) for one in (titles, conventions))
    notes = tuple(_notes(program))
    return DocumentVerdicts(
        program.file, "program", title, tuple(judged), notes, letters, tuple(others)
    )


def _interpretation(equations: Sequence[ProgramEquation], hints: Hints | None) -> Interpretation:
    statements = Translated(tuple(map(_formula, equations)), (), {})
    return interpretation(statements, hints)


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
