"""Verdicts on documents of our own making, beside the truth about each of their statements."""

import re
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from random import Random

from document_mutants import changes
from document_styles import STYLES
from written_documents import WrittenDocument, written_document

from derive.reading.latex.display_reader import formulas
from derive.reading.latex.tree import Derivative, Letter, Statement, Sum, nodes
from derive.verification.documents.pages.verdicts_in_place import DocumentVerdicts, FormulaVerdict
from derive.verification.source_files import judge_file
from solvers.runge_kutta.order_conditions import order

CORRECT = ("verified", "equivalent", "definition")


@dataclass(frozen=True)
class Slip:
    """One wrong statement of a document, and the place of its mistake."""

    kind: str
    index: int
    wrong: str
    start: int
    end: int


@dataclass(frozen=True)
class Outcome:
    """The verdicts on a document with a slip, or without one."""

    name: str
    document: WrittenDocument
    slip: Slip | None
    verdicts: tuple[tuple[str, str], ...] = ()  # of each statement, and its note
    system: str = ""
    blamed: FormulaVerdict | None = None
    seconds: float = 0.0
    failure: str = ""

    @property
    def accused(self) -> list[str]:
        """Right statements that are called wrong, unless their notes name the slip."""
        if self.failure:
            return []
        wrong = self.slip.index if self.slip else -1
        return [
            f"{latex} [{note}]"
            for k, (latex, (verdict, note)) in enumerate(
                zip(self.document.statements, self.verdicts, strict=True)
            )
            if k != wrong and verdict == "wrong"
        ]

    @property
    def judged(self) -> int:
        """The number of statements that are neither context nor unreadable."""
        return sum(verdict in (*CORRECT, "wrong") for verdict, _ in self.verdicts)

    @property
    def is_found(self) -> bool:
        """Whether the slip is called wrong."""
        return self.blamed is not None and self.blamed.verdict == "wrong"

    @property
    def is_at_its_term(self) -> bool:
        """Whether the wrong term contains the place of the slip, and is no whole equation."""
        assert self.slip
        assert self.blamed
        term, whole = (_squeezed(one) for one in (self.blamed.wrong_term, self.slip.wrong))
        if not term or self.document.style.markup == "txt":
            return self.is_mended  # a missing term, or another source
        before = len(_squeezed(self.slip.wrong[: self.slip.start]))
        after = len(_squeezed(self.slip.wrong[: self.slip.end]))
        places = [one.start() for one in re.finditer(re.escape(term), whole)]
        return any(at <= after + 1 and before - 1 <= at + len(term) for at in places)

    @property
    def is_mended(self) -> bool:
        """Whether the correction is right."""
        assert self.blamed
        return self.document.is_right(self.blamed.correction.replace("&", "")) is True


def outcomes(styles: Iterable[str], seeds: Iterable[int], folder: Path) -> Iterator[Outcome]:
    """Yield the outcomes of documents: of every seed one right, and one with a slip."""
    for name in styles:
        for seed in seeds:
            document = written_document(STYLES[name], seed)
            if document is not None:
                yield outcome(f"{name} {seed}", document, None, folder)
                slip = random_slip(document, seed)
                if slip:
                    yield outcome(f"{name} {seed}", document, slip, folder)


def outcome(name: str, document: WrittenDocument, slip: Slip | None, folder: Path) -> Outcome:
    """The verdicts on a document."""
    changed = {document.statements[slip.index]: slip.wrong} if slip else {}
    path = folder / f"document.{document.style.markup}"
    path.write_text(document.text(changed), encoding="utf-8")
    start = time.process_time()
    try:
        judged, _ = judge_file(str(path), order)
    except Exception as error:  # a crash is what is counted
        return Outcome(name, document, slip, failure=repr(error))
    seconds = time.process_time() - start
    sources = [document.style.source(changed.get(one, one)) for one in document.statements]
    found = [_of(judged, one) for one in sources]
    pairs = tuple((one.verdict, one.note) if one else ("unread", "") for one in found)
    blamed = found[slip.index] if slip else None
    return Outcome(name, document, slip, pairs, judged.system, blamed, seconds)


def table(results: Iterable[Outcome]) -> dict[str, float]:
    """Numbers of a campaign, in per cent where they are parts."""
    done = [*results]
    slips = [one for one in done if one.slip and not one.failure]
    found = [one for one in slips if one.is_found]
    statements = sum(len(one.verdicts) for one in done)
    seconds = sorted(one.seconds for one in done)
    return {
        "documents": len(done),
        "statements": statements,
        "crashes": sum(bool(one.failure) for one in done),
        "right ones accused": sum(len(one.accused) for one in done),
        "slips": len(slips),
        "found": 100 * len(found) / max(1, len(slips)),
        "at the term": 100 * sum(one.is_at_its_term for one in found) / max(1, len(found)),
        "mended": 100 * sum(one.is_mended for one in found) / max(1, len(found)),
        "judged": 100 * sum(one.judged for one in done) / max(1, statements),
        "median of seconds": seconds[len(seconds) // 2],
        "most seconds": seconds[-1],
    }


def random_slip(document: WrittenDocument, seed: int) -> Slip | None:
    """A slip at a random place of a document that makes a statement wrong."""
    pick = Random(seed)
    places = [
        Slip(kind, index, latex[:start] + new + latex[end:], start, start + len(new))
        for index, latex in enumerate(document.statements)
        for kind, start, end, new in _changes(latex, document)
    ]
    kinds = sorted({one.kind for one in places})
    for kind in pick.sample(kinds, len(kinds)):
        group = [one for one in places if one.kind == kind]
        for one in pick.sample(group, min(8, len(group))):
            if document.is_right(one.wrong) is False and not _is_mirrored(document, one):
                return one
    return None


def _is_mirrored(document: WrittenDocument, slip: Slip) -> bool:
    """Whether a slip turns an axis around, which no other statement of the document has."""
    steps = dict(document.steps)
    if "velocities" in steps or document.statements[slip.index] not in steps.get("positions", ()):
        return False
    name, _, value = slip.wrong.partition("=")
    return document.is_right(f"{name} = -\\left({value}\\right)") is True


def _changes(latex: str, document: WrittenDocument) -> Iterator[tuple[str, int, int, str]]:
    statement = next(iter(formulas(latex)))
    assert isinstance(statement, Statement)
    for kind, start, end, new in changes(latex, statement):
        yield kind, start, end, " " if new == "{}" else new
    first = statement.sides[0]
    sides = statement.sides[1:] if isinstance(first, Letter | Derivative) else statement.sides
    others = document.parameters
    for node in nodes(tuple(sides)):
        start, end = node.span
        source = latex[start:end]
        if isinstance(node, Letter) and source in others:
            yield from (("another letter", start, end, one) for one in others if one != source)
            yield "twice", start, start, "2 "
        if isinstance(node, Letter) and node.dots and source.startswith("\\dot{"):
            yield "lost dot", start, end, source.replace("\\dot", "", 1)
        if isinstance(node, Sum) and len(node.terms) > 2:
            for _, term in node.terms[1:]:
                head = latex[: term.span[0]].rstrip().rstrip("+-")
                yield "lost term", len(head), term.span[1], " "


def _of(judged: DocumentVerdicts, statement: str) -> FormulaVerdict | None:
    own = _squeezed(statement)
    return next((one for one in judged.formulas if _squeezed(one.latex) == own), None)


def _squeezed(latex: str) -> str:
    return re.sub(r"[\s&]|\\\\$|\\,", "", latex)
