"""Recorded outputs: texts that the project writes, beside those in ``tests/records``.

A record is for outputs without an independent truth, such as messages, tables and files of other
languages. The fixture ``record`` compares the output of a test with the file of its name, and
shows the difference; ``make records`` writes all of them anew, for ``git diff`` to be read.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from difflib import SequenceMatcher, unified_diff
from hashlib import sha256
from pathlib import Path
from textwrap import wrap

from folders import ROOT

RECORDS = ROOT / "tests" / "records"
MEND = "if this is intended, `make records` writes it anew"
NUMBER = re.compile(r"-?\b\d+(?:\.\d+(?:e[+-]?\d+)?|e[+-]?\d+)\b")
#: Hexadecimal digits of a paragraph: one of 65,536 changes is not noticed.
DIGITS = 4
INDENT = "    "


@dataclass(frozen=True)
class Record:
    """The recorded output of one test, which is written instead of compared if requested."""

    path: Path
    is_written: bool

    def check(self, text: str) -> None:
        """Compare a text with the record, line by line."""
        if not self._is_compared(text.rstrip() + "\n"):
            return
        recorded = self.path.read_text(encoding="utf-8").splitlines()
        lines = [*_rounded_alike(text.rstrip().splitlines(), recorded)]
        difference = unified_diff(recorded, lines, self.path.name, "now", n=1, lineterm="")
        assert lines == recorded, "\n".join([*difference, MEND])

    def check_digests(self, texts: Mapping[str, str]) -> None:
        """Compare long texts with digests of their paragraphs, first the list of texts."""
        parts = {name: text.rstrip().split("\n\n") for name, text in texts.items()}
        digests = {name: [*map(_digest, own)] for name, own in parts.items()}
        lines = (
            line
            for name, own in digests.items()
            for line in wrap(f"{name}: {''.join(own)}", 100, subsequent_indent=INDENT)
        )
        if not self._is_compared("\n".join(lines) + "\n"):
            return
        rows = self.path.read_text(encoding="utf-8").replace(f"\n{INDENT}", "").splitlines()
        pairs = (row.rpartition(":")[::2] for row in rows)
        recorded = {name: wrap(rest.strip(), DIGITS) for name, rest in pairs}
        assert [*digests] == [*recorded], f"{[*digests]} instead of {[*recorded]}; {MEND}"
        for name, own in digests.items():
            changed = [*_changed(parts[name], own, recorded[name])]
            assert not changed, "\n\n".join([f"{self.path.name}: {name}", *changed, MEND])

    def _is_compared(self, text: str) -> bool:
        if self.is_written:
            self.path.write_text(text, encoding="utf-8")
        return not self.is_written


def _digest(paragraph: str) -> str:
    return sha256(paragraph.encode()).hexdigest()[:DIGITS]


def _changed(parts: Sequence[str], own: Sequence[str], recorded: Sequence[str]) -> Iterator[str]:
    """Yield the new paragraphs of a text, and how many are replaced."""
    for kind, i, j, k, m in SequenceMatcher(None, recorded, own, autojunk=False).get_opcodes():
        if kind != "equal":
            yield f"{j - i} recorded paragraphs are now {m - k}:"
            yield from parts[k:m]


def _rounded_alike(lines: Sequence[str], recorded: Sequence[str]) -> Iterator[str]:
    """Yield lines as recorded, where only the last digits of decimals differ by one.

    Compilers and mathematical libraries round differently, and a digit follows them.
    """
    for k, line in enumerate(lines):
        yield recorded[k] if k < len(recorded) and _is_alike(line, recorded[k]) else line


def _is_alike(line: str, recorded: str) -> bool:
    if NUMBER.sub("#", line) != NUMBER.sub("#", recorded):
        return False
    pairs = zip(NUMBER.findall(line), NUMBER.findall(recorded), strict=True)
    return all(abs(Decimal(a) - Decimal(b)) <= _unit(b) for a, b in pairs)


def _unit(number: str) -> Decimal:
    exponent = Decimal(number).as_tuple().exponent
    return Decimal(1).scaleb(int(exponent))
