"""The statements of a document that are those of the report, in the same order."""

import re
from collections.abc import Iterator, Sequence
from difflib import SequenceMatcher
from itertools import pairwise, product

#: The least part of its words and signs that a changed statement shares with the report's.
ALIKE = 0.6
WORD = re.compile(r"\\?[A-Za-z]+|\d+|[^\s{}]")
#: Pairs of statements that are compared where a document differs.
MAX_PAIRS = 10_000


def aligned(
    written: Sequence[tuple[str, str]], stored: Sequence[tuple[str, str]]
) -> dict[int, int]:
    """The number of a written statement for each stored one: the same one, or one that is alike.

    A statement is its formula and its LaTeX. Those with the same formula are the same, also if
    their spelling differs; whether others are alike depends on their LaTeX, which may be
    unreadable.
    """
    result: dict[int, int] = {}
    first, second = ([formula for formula, _ in side] for side in (written, stored))
    matcher = SequenceMatcher(None, first, second, autojunk=False)
    ends = [(0, 0)]
    for a, b, size in matcher.get_matching_blocks():
        result |= {b + k: a + k for k in range(size)}
        ends += [(a, b), (a + size, b + size)]
    gaps = [*pairwise(ends)][::2]
    for (a, b), (last, end) in gaps:
        sides = written[a:last], stored[b:end]
        latex = ([latex for _, latex in side] for side in sides)
        result |= {b + j: a + i for i, j in _alike(*latex)}
    return result


def _alike(written: Sequence[str], stored: Sequence[str]) -> Iterator[tuple[int, int]]:
    """The pairs, in order, that together have most in common."""
    if not 0 < len(written) * len(stored) <= MAX_PAIRS:
        return
    words = [[WORD.findall(one) for one in side] for side in (written, stored)]
    best: dict[tuple[int, int], float] = {}
    for i, j in product(range(len(written)), range(len(stored))):
        matcher = SequenceMatcher(None, words[0][i], words[1][j], autojunk=False)
        is_candidate = matcher.quick_ratio() >= ALIKE
        share = matcher.ratio() if is_candidate else 0
        both = best.get((i - 1, j - 1), 0) + (share if share >= ALIKE else 0)
        best[i, j] = max(both, best.get((i - 1, j), 0), best.get((i, j - 1), 0))
    i, j = len(written) - 1, len(stored) - 1
    while i >= 0 and j >= 0:
        if best[i, j] == best.get((i - 1, j), 0):
            i -= 1
        elif best[i, j] == best.get((i, j - 1), 0):
            j -= 1
        else:
            yield i, j
            i, j = i - 1, j - 1
