"""Pairs of operands that several sums or products contain become separate operations.

Greedy, as in two-term common-subexpression extraction for linear transforms:
the most frequent pair comes first, on a tie the one with the lower numbers, so
that the result depends on the operations alone. A queue with deferred
corrections keeps the work nearly linear in the number of pairs.
"""

from collections import Counter
from collections.abc import Collection, Mapping
from dataclasses import replace
from fractions import Fraction
from heapq import heapify, heappop, heappush
from math import gcd

from derive.codegen.operations.operation import (
    ConstantOperation,
    Operation,
    ProductOperation,
    SumOperation,
)

#: Whether it is in a sum, two operands, and the ratio of their coefficients: its numerator and
#: denominator, since fractions are compared and hashed slowly.
Pair = tuple[bool, int, int, int, int]
ONE = Fraction(1)


def share_pairs(operations: dict[int, Operation]) -> None:
    """Rewrite `operations` in place until no pair of operands is computed twice."""
    common = _common_operands(operations)
    holders: dict[Pair, set[int]] = {}
    for number, operation in operations.items():
        for pair in _pairs(operation, common, operation.operands):
            holders.setdefault(pair, set()).add(number)
    queue = _Queue(holders)
    known = {operation: n for n, operation in operations.items() if len(operation.operands) == 2}
    while queue.entries:
        count, pair = queue.pop()
        if count != len(holders[pair]):
            queue.push(pair)
            continue
        shared = _operation_of(pair, operations)
        if shared not in known:
            known[shared] = len(operations)
            operations[len(operations)] = shared
        number = known[shared]
        is_sum, a, b, *_ = pair
        common.add((is_sum, number))
        for holder in sorted(holders[pair] - {number}):
            # pairs of other operands stay
            for old in _pairs(operations[holder], common, (a, b, number)):
                holders[old].discard(holder)
            if len(operations[holder].operands) == 2:
                known.pop(operations[holder], None)
            operations[holder] = _without(operations[holder], pair, number)
            if len(operations[holder].operands) == 2:
                known.setdefault(operations[holder], holder)
            for new in _pairs(operations[holder], common, (a, b, number)):
                holders.setdefault(new, set()).add(holder)
                queue.push(new)
        holders[pair].add(number)
        queue.push(pair)  # a product may contain the pair twice


class _Queue:
    """Pairs with several holders, in order of their numbers of holders when they were added."""

    def __init__(self, holders: Mapping[Pair, Collection[int]]) -> None:
        self._holders = holders
        self.entries = [
            (-len(numbers), pair) for pair, numbers in holders.items() if len(numbers) > 1
        ]
        heapify(self.entries)
        self._queued = set(self.entries)

    def push(self, pair: Pair) -> None:
        """Add a pair with its present number of holders."""
        entry = -len(self._holders[pair]), pair
        if len(self._holders[pair]) > 1 and entry not in self._queued:
            self._queued.add(entry)
            heappush(self.entries, entry)

    def pop(self) -> tuple[int, Pair]:
        """Remove the first pair, with the number of holders when it was added."""
        entry = heappop(self.entries)
        self._queued.remove(entry)
        return -entry[0], entry[1]


def _common_operands(operations: dict[int, Operation]) -> set[tuple[bool, int]]:
    """Whether it is in sums, and an operand of several of them or of several products."""
    counts = Counter(
        (isinstance(operation, SumOperation), operand)
        for operation in operations.values()
        if isinstance(operation, SumOperation | ProductOperation)
        for operand in {*operation.operands}
    )
    return {
        (is_sum, operand)
        for (is_sum, operand), count in counts.items()
        # a sum in a sum can turn out to be a pair of others
        if count > 1
        or isinstance(operations[operand], SumOperation if is_sum else ProductOperation)
    }


def _pairs(
    operation: Operation, common: Collection[tuple[bool, int]], changed: Collection[int]
) -> set[Pair]:
    """The pairs of common operands of a sum or product, of which at least one has `changed`."""
    match operation:
        case ProductOperation(operands):
            # of a power, two factors are sufficient
            factors = [n for n, count in Counter(operands).items() for _ in range(min(count, 2))]
            terms = [(n, 1, 1) for n in sorted(factors) if (False, n) in common]
        case SumOperation(operands, _, coefficients):
            pairs = sorted(zip(operands, coefficients, strict=True))
            terms = [(n, *c.as_integer_ratio()) for n, c in pairs if (True, n) in common]
        case _:
            return set()
    return {
        (isinstance(operation, SumOperation), a, b, *_ratio(above * lower, below * upper))
        for k, (b, above, below) in enumerate(terms)
        for a, upper, lower in (
            terms[:k] if b in changed else [t for t in terms[:k] if t[0] in changed]
        )
    }


def _ratio(numerator: int, denominator: int) -> tuple[int, int]:
    """Numerator and denominator of a fraction in lowest terms."""
    divisor = gcd(numerator, denominator) if denominator > 0 else -gcd(numerator, denominator)
    return numerator // divisor, denominator // divisor


def _operation_of(pair: Pair, operations: dict[int, Operation]) -> Operation:
    in_sum, a, b, *ratio = pair
    constant = operations[a].constant and operations[b].constant
    return (
        SumOperation((a, b), constant, (ONE, Fraction(*ratio)))
        if in_sum
        else ProductOperation((a, b), constant)
    )


def _without(operation: Operation, pair: Pair, number: int) -> Operation:
    """`operation` with the two operands of `pair` replaced by operation `number`."""
    _, a, b, *_ = pair
    if not isinstance(operation, SumOperation):
        factors = [*operation.operands, number]
        factors.remove(a)
        factors.remove(b)
        return replace(operation, operands=tuple(sorted(factors)))
    terms = dict(zip(operation.operands, operation.coefficients, strict=True))
    coefficient = terms.pop(a)
    del terms[b]
    terms[number] = terms.get(number, Fraction(0)) + coefficient
    if not terms[number]:  # the sum contained the pair's negative under the pair's own name
        del terms[number]
    if not terms:
        return ConstantOperation((), True, Fraction(0))
    operands, coefficients = zip(*sorted(terms.items()), strict=True)
    return replace(operation, operands=operands, coefficients=coefficients)
