"""Formulas in plain text, as in blocks of code: ``θ'' = -(g/l) sin θ``, ``x_ddot = -k*x/m``."""

import re
import unicodedata
from collections.abc import Iterable, Iterator
from dataclasses import replace

from derive.reading.latex.layout.latex_symbols import FUNCTIONS, GREEK
from derive.reading.scanning import Excerpt, UnreadDisplay

#: The delimiter of a formula in plain text, and those of blocks and spans of code that are scanned:
#: as inline formulas, since a display without an end would be reported.
PLAIN, BLOCK, SPAN = "text", "block of code", "span of code"
#: Languages of blocks of code that are none.
LANGUAGES = r"(?:text|txt|plain|plaintext|ascii|none)?"
#: Before a formula: a mark of a list, a number in brackets, words and a colon.
LABEL = re.compile(
    r"[ \t>]*(?:(?:[-*•]|\d+[.)]|\([\w.]+\))[ \t]+)?(?:[A-Za-z][^=:\n]{2,60}:[ \t]+)?"
)
#: Behind it: a comment, a number or words in brackets after several spaces, punctuation.
REMARK = re.compile(
    r"(?<![ \t])(?:[ \t]+(?:#|//|--|←|<-|—)[^\n]*|(?:[ \t]{2,}|\t)[(\[][^=\n]*[)\]]\.?$"
    r"|[ \t]+\((?=[^()=]*[a-z]{4})[^()=]*\)$|[ \t]+\[[^\]=\n]*\]$|[ \t]*[,;.]?[ \t]*$)"
)
#: A line, and the characters of the longest that is read.
MAX_LENGTH = 300
LINE = re.compile(rf"^[^\n]{{1,{MAX_LENGTH}}}$", re.MULTILINE)
RELATION = re.compile(r"=|≈|≡|:=")
#: The value of a name, as programs print it.
VALUE = re.compile(r"\s*\w+\s*=\s*[-+\d.eE/\s]*")
#: The start of a line that continues the formula before it.
CONTINUED = re.compile(r"[=+\-−*/·]")
#: What is part of no formula but of a program, of a table or of a sentence.
FOREIGN = re.compile(
    r"""==|[+\-*/]=|=>|=\s*'|[;{}"`$@!?\\&|#<>~%]|\w\[|[A-Za-z]\.[A-Za-z]|\d\.\w*[A-Za-z]|[A-Za-z]\w*\(\)"""
)
PROGRAM = re.compile(
    r"^[ \t]*(?:def|for|while|import|from|function|class|return|if|else|elif|var|let|const|double|"
    r"float|int|void|print|#include|git|pip|npm|cd|make|sudo|\$|>>>)\b|[;{][ \t]*$",
    re.MULTILINE,
)
#: Signs of mechanics: characters that programs lack, and derivatives.
MATHEMATICS = re.compile(r"''|d?dot\b|\bd\^?2\w|\bd\w{1,6}/dt\b|[A-Za-z)]'")
#: Words of a formula: letters, functions, Greek letters, derivatives of these, and products.
WORD = re.compile(
    rf"(?i:{'|'.join(FUNCTIONS)}|sqrt|abs|d?(?:{'|'.join(GREEK)})|[KPT]E|mg[a-z]|GMm)(?:_?d{{1,3}}ot)*"
    r"|d{0,2}[a-zA-Z]_?d{1,3}ot|const(?:ant)?|[a-zA-Z]{1,2}"
)
#: Words of two letters that are none of a formula.
PROSE = frozenset("is of to in at or if we by so an as on it be do no".split())


def with_plain_formulas(
    text: str, results: Iterable[Excerpt | UnreadDisplay]
) -> Iterator[Excerpt | UnreadDisplay]:
    """The results of a scan, with formulas in code in place of blocks and spans of code.

    Blocks have none unless one of them shows that it belongs to no program.
    """
    found = list[tuple[Excerpt | UnreadDisplay, bool]]()  # and whether it stands in a block
    for one in _with_whole_blocks(text, results):
        match one:
            case Excerpt(delimiter=delimiter) if delimiter == BLOCK:
                found += ((own, True) for own in _formulas(text, one))
            case Excerpt(delimiter=delimiter) if delimiter == SPAN:
                formula = text[one.start : one.end]
                is_relation = len(formula) <= MAX_LENGTH and RELATION.search(formula)
                if is_relation and _is_formula(formula) and _is_mathematics(formula):
                    found.append((replace(one, delimiter=PLAIN), False))
            case _:
                found.append((one, False))
    blocks = (
        text[one.start : one.end]
        for one, is_block in found
        if is_block and isinstance(one, Excerpt)
    )
    is_read = any(map(_is_mathematics, blocks))
    return (one for one, is_block in found if is_read or not is_block)


def _with_whole_blocks(
    text: str, results: Iterable[Excerpt | UnreadDisplay]
) -> Iterator[Excerpt | UnreadDisplay]:
    """The results with one block for indented lines that only spaces separate."""
    block: Excerpt | None = None
    for one in results:
        own = one if isinstance(one, Excerpt) and one.delimiter == BLOCK else None
        if block and own and not text[block.end : own.start].strip():
            block = replace(block, end=own.end)
            continue
        if block:
            yield block
        block = own
        if not own:
            yield one
    if block:
        yield block


def _formulas(text: str, block: Excerpt) -> list[Excerpt]:
    """The formulas on the lines of a block, if it is no program."""
    found = list[Excerpt]()
    start = text.rfind("\n", 0, block.start) + 1  # before the indentation
    if PROGRAM.search(text, start, block.end):
        return []
    for line in LINE.finditer(text, start, block.end):
        first, last = _formula(line)
        formula = text[first:last]
        if not _is_formula(formula):
            continue
        if CONTINUED.match(formula) and found and text[found[-1].end : first].count("\n") == 1:
            found[-1] = replace(found[-1], end=last, extent=(found[-1].start, last))
        elif RELATION.search(formula):
            found.append(Excerpt(first, last, (first, last), PLAIN))
    return found


def _formula(line: re.Match[str]) -> tuple[int, int]:
    """Where the formula of a line starts and ends, without a label and a remark."""
    label = LABEL.match(line.string, line.start(), line.end())
    first = label.end() if label else line.start()
    last = first + len(line.string[first : line.end()].rstrip())
    while remark := REMARK.search(line.string[first:last]):
        if not remark.group():
            break
        last = first + remark.start()
    return first, last


def _is_formula(formula: str) -> bool:
    """Whether all words are those of a formula."""
    if FOREIGN.search(formula) or not formula:
        return False
    left, _, right = formula.partition("=")
    name = left.strip()
    if re.fullmatch(r"\w+", name) and re.match(rf"\s*{re.escape(name)}\s*[-+*]", right):
        return False  # x = x + v*dt
    if any(VALUE.fullmatch(part) for part in formula.split(",")):
        return False
    words = re.findall(r"[A-Za-z]+", re.sub(r"_[A-Za-z]+", "_", formula))
    return all(WORD.fullmatch(one) and one not in PROSE for one in words)


def _is_mathematics(formula: str) -> bool:
    """Whether a formula has characters that programs lack, or a derivative."""
    characters = (one for one in unicodedata.normalize("NFKD", formula) if not one.isascii())
    return bool(MATHEMATICS.search(formula)) or any(characters)
