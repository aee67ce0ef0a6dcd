"""Forms of one letter, and letters with several meanings, in the statements of a document."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import pairwise

from derive.reading.latex.tree import (
    DIFFERENCE,
    Application,
    Derivative,
    Letter,
    Matrix,
    Node,
    Product,
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
from derive.verification.documents.statements import CONSTANT, Occurrence

#: Two forms of one letter, which some documents mix.
VARIANTS = (("ell", "l"), ("varphi", "phi"), ("vartheta", "theta"), ("varepsilon", "epsilon"))


def with_own_letters(occurrences: Sequence[Occurrence]) -> list[Occurrence]:
    """The statements with a letter of its own for each meaning that a document shows."""
    masses = _with_masses(occurrences)
    labelled = [_with_sides(one, with_labels(one.sides, QUANTITIES)) for one in masses]
    separate = _with_constants(_with_initial_rates(_with_functions(_with_lengths(labelled))))
    return _with_any_coordinate(_with_differences(separate))


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
#: The energies of which the Lagrangian is the difference.
ENERGIES = {"kinetic_energy", "potential_energy"}


def _with_lengths(occurrences: Sequence[Occurrence]) -> list[Occurrence]:
    r"""The statements, with lengths for some letters L beside the Lagrangian.

    They are plain where the Lagrangian is ``\mathcal L``, or factors where it is alone. This is
    differentiated, or a difference of energies. A plain letter is no length if it is given by
    velocities.
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
    has_lengths = "L" in differentiated or any(map(_is_difference_of_energies, occurrences))
    if len(found) > 1:
        has_lengths = not any(map(_is_of_motion, occurrences))
    if not has_lengths:
        return [*occurrences]

    def change(place: Occurrence, alone: set[Span], letter: Letter) -> Letter:
        if letter.name != "L" or letter.index:
            return letter
        is_length = is_plain(place, letter) if len(found) > 1 else letter.span not in alone
        return replace(letter, name=LENGTH) if is_length else letter

    def changed(place: Occurrence) -> Occurrence:
        sides = () if _is_of_length(place) else place.sides
        alone = {one.span for one in (*sides, *_terms(place.sides))}
        return _with_sides(place, with_letters(place.sides, partial(change, place, alone)))

    return [changed(one) for one in occurrences]


#: The name of a mass M beside a matrix M.
MASS = "mass"


def _with_masses(occurrences: Sequence[Occurrence]) -> list[Occurrence]:
    """The statements, with a name for a mass M that is in the entries of a matrix M.

    The matrix is a side of an equation, a function of letters, or a factor of other letters' rates.
    """

    def is_matrix(node: Node) -> bool:
        name = node.head if isinstance(node, Application) else node
        return isinstance(name, Letter) and name.identifier == "M"

    written = [
        side
        for one in occurrences
        if any(map(is_matrix, one.sides))
        for side in one.sides
        if isinstance(side, Matrix)
    ]
    own = {one.identifier for one in letters(tuple(written))}
    if "M" not in own:
        return [*occurrences]

    def matrices(place: Occurrence) -> Iterator[Span]:
        yield from (one.span for one in place.sides if is_matrix(one))
        for node in nodes(place.sides):
            match node:
                case Application(head=head, arguments=arguments) if is_matrix(head):
                    if all(isinstance(one, Letter) for one in arguments):
                        yield head.span
                case Product(factors=factors):
                    for one, other in pairwise(factors):
                        if is_matrix(one) and isinstance(other, Letter) and other.dots:
                            yield from [one.span] * (other.identifier not in own)

    def change(alone: set[Span], letter: Letter) -> Letter:
        is_mass = letter.identifier == "M" and letter.span not in alone
        return replace(letter, name=MASS) if is_mass else letter

    return [
        _with_sides(one, with_letters(one.sides, partial(change, {*matrices(one)})))
        for one in occurrences
    ]


#: The name of a function g, such as a constraint, beside the gravity g.
FUNCTION = "function"


def _with_functions(occurrences: Sequence[Occurrence]) -> list[Occurrence]:
    """The statements, with a name for a function g beside the gravity g.

    It is differentiated, has several arguments, or is stated, as in g(x) = 0.
    """

    def heads(place: Occurrence) -> Iterator[Span]:
        for node in nodes(place.sides):
            match node:
                case Derivative(operand=Letter(span=span) as letter):
                    is_function = True
                case Application(head=Letter(span=span) as letter, arguments=arguments):
                    # unlike the product g(m_1 - m_2)
                    is_stated = node in place.sides[:1] and isinstance(arguments[0], Letter)
                    is_function = len(arguments) > 1 or is_stated
                case _:
                    continue
            if is_function and letter.identifier == "g":
                yield span

    def change(own: set[Span], letter: Letter) -> Letter:
        return replace(letter, name=FUNCTION) if letter.span in own else letter

    own = [{*heads(one)} for one in occurrences]
    count = sum(one.identifier == "g" for place in occurrences for one in letters(place.sides))
    if not any(own) or count == sum(map(len, own)):
        return [*occurrences]
    return [
        _with_sides(place, with_letters(place.sides, partial(change, spans)))
        for place, spans in zip(occurrences, own, strict=True)
    ]


def _with_constants(occurrences: Iterable[Occurrence]) -> list[Occurrence]:
    """The statements with a letter of its own for each constant, as that of an energy."""

    def change(place: Occurrence, own: set[Span], letter: Letter) -> Letter:
        start = str(place.start + letter.span[0])
        return replace(letter, index=start) if letter.span in own else letter

    def changed(place: Occurrence) -> Occurrence:
        terms = (one for side in place.sides for one in (side, *_summands(side)))
        own = {
            one.span
            for one in terms
            if isinstance(one, Letter) and CONSTANT.fullmatch(one.identifier)
        }
        return _with_sides(place, with_letters(place.sides, partial(change, place, own)))

    return [changed(one) for one in occurrences]


def _with_initial_rates(occurrences: Sequence[Occurrence]) -> list[Occurrence]:
    r"""The statements, with constants for rates such as ``\dot\psi_0`` beside ``\dot\psi``.

    These are no rates of another coordinate, unless energies have them, or accelerations.
    """
    found = [one for place in occurrences for one in letters(place.sides) if one.dots]
    moving = {(one.name, one.index) for one in found}
    initial = {(name, "0") for name, index in moving if index == "0" and (name, "") in moving}
    initial -= {(one.name, one.index) for one in found if one.dots > 1}
    for sides in (place.sides for place in occurrences):
        if any(isinstance(one, Letter) and one.name in QUANTITIES for one in sides[:1]):
            initial -= {(one.name, one.index) for one in letters(sides)}

    def change(letter: Letter) -> Letter:
        is_initial = letter.dots == 1 and (letter.name, letter.index) in initial
        return replace(letter, dots=0, index="dot_0") if is_initial else letter

    if not initial:
        return [*occurrences]
    return [_with_sides(one, with_letters(one.sides, change)) for one in occurrences]


def _is_difference_of_energies(place: Occurrence) -> bool:
    """Whether a statement is L = T - V, in any letters of energies."""
    first, *others = place.sides or (None,)
    return (
        isinstance(first, Letter)
        and first.identifier == "L"
        and any(
            isinstance(one, Sum) and {QUANTITIES.get(x.name) for x in letters(one)} >= ENERGIES
            for one in others
        )
    )


def _is_of_motion(place: Occurrence) -> bool:
    """Whether a statement gives a plain L by velocities."""
    first, *others = place.sides or (None,)
    is_plain = isinstance(first, Letter) and place.latex[slice(*first.span)] == "L"
    return is_plain and any(one.dots for one in letters(tuple(others)))


def _is_of_length(place: Occurrence) -> bool:
    """Whether a statement defines a length L, as L = 2 l does: by letters without dots alone."""
    others = [*letters(place.sides[1:])]
    moving = any(one.dots or one.primes or one.name in QUANTITIES for one in others)
    return len(others) == 1 and not moving


def _terms(sides: Iterable[Node]) -> Iterator[Node]:
    """Terms of sums that are no factors, what derivatives apply to, and functions of letters."""
    for node in nodes(sides):
        if isinstance(node, Derivative):
            yield from (node.operand, *_summands(node.operand))
        elif isinstance(node, Application) and {*map(type, node.arguments)} == {Letter}:
            yield node.head
    for side in sides:
        yield from _summands(side)


def _summands(node: Node) -> Iterator[Node]:
    """The terms of a sum, and those of sums among them."""
    if isinstance(node, Sum):
        for _, term in node.terms:
            yield from (term, *_summands(term))


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
