"""The statements of a document that are those of the report, in the same order."""

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from difflib import SequenceMatcher
from itertools import pairwise, product

#: The least part of its words and signs that a changed statement has in common with the report's.
ALIKE = 0.5
#: Pairs of statements that are compared where a document differs.
MAX_PAIRS = 40_000


def aligned(written: Sequence[str], stored: Sequence[str]) -> dict[int, int]:
    """The number of a written statement for each stored one: the same one, or one that is alike."""
    found: dict[int, int] = {}
    matcher = SequenceMatcher(None, written, stored, autojunk=False)
    ends = [(0, 0)]
    for a, b, size in matcher.get_matching_blocks():
        found |= {b + k: a + k for k in range(size)}
        ends += [(a, b), (a + size, b + size)]
    gaps = [*pairwise(ends)][::2]
    for (a, b), (last, end) in gaps:
        found |= {b + j: a + i for i, j in _alike(written[a:last], stored[b:end])}
    return found


def _alike(written: Sequence[str], stored: Sequence[str]) -> Iterator[tuple[int, int]]:
    """The pairs, in order, that together have most in common."""
    if not 0 < len(written) * len(stored) <= MAX_PAIRS:
        return
    bags = [[Counter(re.findall(r"\w+|\S", one)) for one in side] for side in (written, stored)]
    best: dict[tuple[int, int], float] = {}
    likeness: dict[tuple[int, int], float] = {}
    for i, j in product(range(len(written)), range(len(stored))):
        one, other = bags[0][i], bags[1][j]
        share = 2 * (one & other).total() / (one.total() + other.total())
        likeness[i, j] = share if share >= ALIKE else 0
        both = best.get((i - 1, j - 1), 0) + likeness[i, j]
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
