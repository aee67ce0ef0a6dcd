"""Forms of one letter, and letters with several meanings, in the statements of a document."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial

from derive.reading.latex.tree import (
    DIFFERENCE,
    Application,
    Derivative,
    Letter,
    Node,
    Span,
    Statement,
    Sum,
    letters,
    nodes,
    with_differences,
    with_labels,
    with_letters,
)
from derive.verification.documents.letters.letters import QUANTITIES
from derive.verification.documents.statements import Occurrence

#: Two forms of one letter, which some documents mix.
VARIANTS = (("ell", "l"), ("varphi", "phi"), ("vartheta", "theta"), ("varepsilon", "epsilon"))


def with_own_letters(occurrences: Sequence[Occurrence]) -> list[Occurrence]:
    """The statements with a letter of its own for each meaning that a document shows."""
    labelled = [_with_sides(one, with_labels(one.sides, QUANTITIES)) for one in occurrences]
    return _with_any_coordinate(_with_differences(_with_lengths(labelled)))


def with_one_letter(occurrences: Sequence[Occurrence], variant: str, name: str) -> list[Occurrence]:
    """The statements with one letter for two forms of it; none unless they have both."""
    if not {variant, name} <= {one.name for place in occurrences for one in letters(place.sides)}:
        return []

    def change(letter: Letter) -> Letter:
        return replace(letter, name=name) if letter.name == variant else letter

    return [_with_sides(one, with_letters(one.sides, change)) for one in occurrences]


def _with_any_coordinate(occurrences: Sequence[Occurrence]) -> list[Occurrence]:
    """The statements with an index for a letter q by which energies are differentiated alone.

    It stands for any coordinate then, as q_i does.
    """

    def count(sides: object) -> int:
        return sum((one.name, one.index) == ("q", "") for one in letters(sides))

    def change(letter: Letter) -> Letter:
        return replace(letter, index="i") if (letter.name, letter.index) == ("q", "") else letter

    variables = [
        node.variables
        for one in occurrences
        for node in nodes(one.sides)
        if isinstance(node, Derivative) and count(node.variables)
    ]
    if count(tuple(variables)) < sum(count(one.sides) for one in occurrences):
        return [*occurrences]
    return [_with_sides(one, with_letters(one.sides, change)) for one in occurrences]


#: The name of a letter L that is a length beside the Lagrangian.
LENGTH = "length"


def _with_lengths(occurrences: Sequence[Occurrence]) -> list[Occurrence]:
    r"""The statements, with lengths for some letters L beside the Lagrangian.

    They are plain where the Lagrangian is ``\mathcal L``, or factors where it is alone.
    """

    def is_plain(place: Occurrence, letter: Letter) -> bool:
        return place.latex[slice(*letter.span)].lstrip("{ ").startswith("L")

    found = {
        is_plain(one, letter)
        for one in occurrences
        for letter in nodes(one.sides)
        if isinstance(letter, Letter) and letter.name == "L"
    }
    differentiated = {
        letter.name
        for one in occurrences
        for node in nodes(one.sides)
        if isinstance(node, Derivative) and isinstance(letter := node.operand, Letter)
    }
    if len(found) < 2 and "L" not in differentiated:
        return [*occurrences]

    def change(place: Occurrence, alone: set[Span], letter: Letter) -> Letter:
        if letter.name != "L" or letter.index:
            return letter
        is_length = is_plain(place, letter) if len(found) > 1 else letter.span not in alone
        return replace(letter, name=LENGTH) if is_length else letter

    def changed(place: Occurrence) -> Occurrence:
        alone = {one.span for one in (*place.sides, *_terms(place.sides))}
        return _with_sides(place, with_letters(place.sides, partial(change, place, alone)))

    return [changed(one) for one in occurrences]


def _terms(sides: object) -> Iterator[Node]:
    """Terms of sums, and what derivatives apply to."""
    for node in nodes(sides):
        if isinstance(node, Sum):
            yield from (term for _, term in node.terms)
        if isinstance(node, Derivative | Application):
            yield node.operand if isinstance(node, Derivative) else node.head


def _with_sides(place: Occurrence, sides: tuple[Node, ...]) -> Occurrence:
    """A statement with other sides."""
    tree = place.tree
    return replace(place, tree=replace(tree, sides=sides)) if isinstance(tree, Statement) else place


def _with_differences(occurrences: Sequence[Occurrence]) -> list[Occurrence]:
    r"""The statements with one letter for ``\Delta x``, unless Δ stands alone somewhere."""
    trees = [one.sides for one in occurrences]
    joined = [with_differences(sides) for sides in trees]
    is_alone = any(one.name == DIFFERENCE for sides in joined for one in letters(sides))
    if is_alone or joined == trees:
        return [*occurrences]
    return [_with_sides(one, sides) for one, sides in zip(occurrences, joined, strict=True)]
