"""Pairs of operands that several sums or products contain become separate operations.

Greedy, as in two-term common-subexpression extraction for linear transforms:
the most frequent pair comes first, on a tie the one with the lower numbers, so
that the result depends on the operations alone. A queue with deferred
corrections keeps the work nearly linear in the number of pairs.
"""

from collections import Counter
from collections.abc import Collection
from dataclasses import replace
from fractions import Fraction
from heapq import heapify, heappop, heappush

from derive.codegen.operation import Operation, Product, Sum

#: Whether it is in a sum, two operands, and in a sum the ratio of their coefficients.
Pair = tuple[bool, int, int, Fraction]
ONE = Fraction(1)


def share_pairs(operations: dict[int, Operation]) -> None:
    """Rewrite `operations` in place until no pair of operands is computed twice."""
    common = _common_operands(operations)
    holders: dict[Pair, set[int]] = {}
    for number, operation in operations.items():
        for pair in _pairs(operation, common, operation.operands):
            holders.setdefault(pair, set()).add(number)
    queue = [(-len(numbers), pair) for pair, numbers in holders.items() if len(numbers) > 1]
    heapify(queue)
    known = {operation: number for number, operation in operations.items()}
    while queue:
        count, pair = heappop(queue)
        if -count != len(holders[pair]):
            if len(holders[pair]) > 1:
                heappush(queue, (-len(holders[pair]), pair))
            continue
        shared = _operation_of(pair, operations)
        if shared not in known:
            known[shared] = len(operations)
            operations[len(operations)] = shared
        number = known[shared]
        is_sum, a, b, _ = pair
        common.add((is_sum, number))
        for holder in sorted(holders[pair] - {number}):
            # pairs of other operands stay
            for old in _pairs(operations[holder], common, (a, b, number)):
                holders[old].discard(holder)
            known.pop(operations[holder], None)
            operations[holder] = _without(operations[holder], pair, number)
            known.setdefault(operations[holder], holder)
            for new in _pairs(operations[holder], common, (a, b, number)):
                holders.setdefault(new, set()).add(holder)
                if len(holders[new]) > 1:
                    heappush(queue, (-len(holders[new]), new))
        holders[pair].add(number)
        if len(holders[pair]) > 1:  # a product that contains the pair twice
            heappush(queue, (-len(holders[pair]), pair))


def _common_operands(operations: dict[int, Operation]) -> set[tuple[bool, int]]:
    """Whether it is in sums, and an operand of several of them or of several products."""
    counts = Counter(
        (isinstance(operation, Sum), operand)
        for operation in operations.values()
        if isinstance(operation, Sum | Product)
        for operand in {*operation.operands}
    )
    return {
        (is_sum, operand)
        for (is_sum, operand), count in counts.items()
        # a sum in a sum can turn out to be a pair of others
        if count > 1 or isinstance(operations[operand], Sum if is_sum else Product)
    }


def _pairs(
    operation: Operation, common: Collection[tuple[bool, int]], changed: Collection[int]
) -> set[Pair]:
    """The pairs of common operands of a sum or product, of which at least one has `changed`."""
    match operation:
        case Product(operands):
            # of a power, two factors are sufficient
            factors = [n for n, count in Counter(operands).items() for _ in range(min(count, 2))]
            terms = [(n, ONE) for n in sorted(factors) if (False, n) in common]
        case Sum(operands, _, coefficients):
            pairs = sorted(zip(operands, coefficients, strict=True))
            terms = [(n, c) for n, c in pairs if (True, n) in common]
        case _:
            return set()
    return {
        (isinstance(operation, Sum), a, b, cb / ca)
        for k, (b, cb) in enumerate(terms)
        for a, ca in (terms[:k] if b in changed else [t for t in terms[:k] if t[0] in changed])
    }


def _operation_of(pair: Pair, operations: dict[int, Operation]) -> Operation:
    in_sum, a, b, ratio = pair
    constant = operations[a].constant and operations[b].constant
    return Sum((a, b), constant, (ONE, ratio)) if in_sum else Product((a, b), constant)


def _without(operation: Operation, pair: Pair, number: int) -> Operation:
    """`operation` with the two operands of `pair` replaced by operation `number`."""
    _, a, b, _ = pair
    if not isinstance(operation, Sum):
        factors = [*operation.operands, number]
        factors.remove(a)
        factors.remove(b)
        return replace(operation, operands=tuple(sorted(factors)))
    terms = dict(zip(operation.operands, operation.coefficients, strict=True))
    coefficient = terms.pop(a)
    del terms[b]
    terms[number] = terms.get(number, Fraction(0)) + coefficient
    operands, coefficients = zip(*sorted(terms.items()), strict=True)
    return replace(operation, operands=operands, coefficients=coefficients)
