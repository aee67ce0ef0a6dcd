"""``holonomic verify EQUATIONS``: verdicts on the equations of files and systems."""

import json
import sys
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict

from derive.verification.hand import HandDerivation, judge
from derive.verification.verdict import VerdictName, table_width, verdict_rows, wrapped
from solvers.io.text_table import text_table

#: The verdicts that are counted, and the width of the column of files.
COUNTED: tuple[VerdictName, ...] = ("verified", "equivalent", "misprint", "wrong", "unreadable")
FILE_WIDTH = 26


def verify(names: Sequence[str], *, as_json: bool) -> int:
    """Print the verdicts, for several files also their numbers.

    Return 0, 1 if an equation is wrong, or 2 if an equation or a file is unreadable.
    """
    derivations: dict[str, HandDerivation | None] = {}
    for name in names:
        try:
            derivations[name] = judge(name)
        except ValueError as error:  # the other files are still judged
            derivations[name] = None
            print(f"holonomic verify: {error}", file=sys.stderr)
    judged = [one for one in derivations.values() if one]
    if as_json:
        print(json.dumps(list(map(asdict, judged)), indent=2))  # in ASCII: valid in every encoding
    else:
        texts = ["\n".join(_lines(one, table_width())) for one in judged]
        if len(derivations) > 1:
            texts.append("\n".join(_marks(derivations)))
        if texts:
            print(*texts, sep="\n\n")
    verdicts = {equation.verdict for one in judged for equation in one.equations}
    if "unreadable" in verdicts or None in derivations.values():
        return 2
    return int("wrong" in verdicts)


def _lines(derivation: HandDerivation, width: int) -> Iterator[str]:
    head = dict.fromkeys((derivation.file, derivation.system, derivation.source))
    yield wrapped(": ".join(filter(None, head)), width, 0)
    if derivation.note:
        yield wrapped(derivation.note, width, 0)
    yield from verdict_rows(derivation.equations, width)


def _marks(derivations: Mapping[str, HandDerivation | None]) -> Iterator[str]:
    """Numbers of verdicts for each file, dashes for an unreadable one, and the totals."""
    total: Counter[VerdictName] = Counter()
    rows: list[list[object]] = []
    for name, derivation in derivations.items():
        marks = Counter(one.verdict for one in derivation.equations) if derivation else None
        file = name if len(name) <= FILE_WIDTH else f"...{name[3 - FILE_WIDTH :]}"
        rows.append([file, *(marks and marks[verdict] for verdict in COUNTED)])
        total.update(marks or {})
    rows.append(["total", *(total[verdict] for verdict in COUNTED)])
    return text_table({"file": "", **dict.fromkeys(COUNTED, "d")}, rows)
