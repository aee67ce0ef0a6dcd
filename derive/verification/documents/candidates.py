"""What the letters of a document can mean: a system, an order of coordinates, a convention."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice, permutations, product
from math import pi

from derive.system.system import System
from derive.verification.documents.letters import Letters

#: Largest number of candidates of one system.
MAX_CANDIDATES = 3000
#: Letters of forces and of friction that are tried.
MAX_FORCES = 2

#: An angle of the system: sign times the document's angle, plus a number of right angles. From
#: hanging, from upright, mirrored, and from the horizontal.
ANGLES = ((1, 0), (-1, 2), (1, 2), (-1, 0), (1, 1), (1, -1), (-1, 1), (-1, -1))

#: Units of parameters, and the kinds of letters.
UNITS = {
    "kg": "mass",
    "m": "length",
    "m/s^2": "gravity",
    "N/m": "stiffness",
    "kg m^2": "inertia",
    "rad/s": "frequency",
    "N m s": "damping",
    "N s/m": "damping",
}


@dataclass(frozen=True)
class Candidate:
    """A system in the letters of a document.

    A coordinate of the system is a sum of those of the document with signs, plus an offset in
    right angles or, for lengths, a parameter.
    """

    system: System
    coordinates: tuple[str, ...]
    signs: tuple[tuple[int, ...], ...]  # one row for each coordinate of the system
    offsets: tuple[int | str, ...]
    parameters: Mapping[str, str]  # of the system, and the document's letters
    forces: tuple[tuple[str, int], ...] = ()  # letters of forces on coordinates of the document
    friction: tuple[tuple[str, int], ...] = ()

    def offset(self, index: int, values: Mapping[str, float]) -> float:
        """The offset of a coordinate in numbers."""
        offset = self.offsets[index]
        return values[offset] if isinstance(offset, str) else offset * pi / 2


def candidates(system: System, letters: Letters) -> Iterator[Candidate]:
    """Yield the candidates of a system, the likeliest first."""
    n = len(system.coordinates)
    orders = [*letters.orders([one.unit == "rad" for one in system.coordinates])]
    parameters = [*islice(_parameters(system, letters), 200)]
    choices = product(
        _conventions(system, letters), orders, parameters, loads(letters, "force", n),
        loads(letters, "damping", n),
    )  # fmt: skip
    for (signs, offsets), order, mapping, forces, friction in islice(choices, MAX_CANDIDATES):
        yield Candidate(system, order, signs, offsets, mapping, forces, friction)


def _conventions(
    system: System, letters: Letters
) -> Iterator[tuple[tuple[tuple[int, ...], ...], tuple[int | str, ...]]]:
    angles = [c.unit == "rad" for c in system.coordinates]
    n, lengths = len(angles), angles.count(False)
    natural: list[int | str] = [0, *letters.of_kind("length")]
    for relative in (False, True) if angles.count(True) > 1 else (False,):
        for (sign, turn), *shifts in product(
            ANGLES if any(angles) else ANGLES[:1],
            *[[(s, o) for o in natural for s in (1, -1)]] * lengths,
        ):
            rows, offsets, rest = [], list[int | str](), iter(shifts)
            for i, is_angle in enumerate(angles):
                own_sign, offset = (sign, turn) if is_angle else next(rest)
                before = range(i) if relative and is_angle else ()
                row = [own_sign * (j == i or (j in before and angles[j])) for j in range(n)]
                rows.append(tuple(map(int, row)))
                offsets.append(offset)
            yield tuple(rows), tuple(offsets)


def _parameters(system: System, letters: Letters) -> Iterator[Mapping[str, str]]:
    """Yield letters for the parameters of a system, one kind after another."""
    groups: dict[str, list[str]] = {}
    for parameter in system.parameters:
        groups.setdefault(UNITS.get(parameter.unit, ""), []).append(parameter.symbol.name)
    for choice in product(*(_choices(kind, names, letters) for kind, names in groups.items())):
        yield {name: letter for one in choice for name, letter in one.items()}


def _choices(kind: str, names: Sequence[str], letters: Letters) -> list[dict[str, str]]:
    """The letters of parameters of one kind: different ones, or the same for all."""
    usual = letters.of_kind(kind) if kind else list(letters.parameters)
    if len(usual) >= len(names):
        orders: Iterator[Sequence[str]] = permutations(usual, len(names))
    else:
        orders = product(usual, repeat=len(names))
    chosen = [dict(zip(names, order, strict=True)) for order in islice(orders, 200)]
    same = [dict.fromkeys(names, one) for one in usual] if len(names) > 1 else []
    return [*chosen, *(one for one in same if one not in chosen)] or [{}]


def loads(letters: Letters, kind: str, n: int) -> list[tuple[tuple[str, int], ...]]:
    """The coordinates on which each letter of a force acts: none, or one of them."""
    usual = letters.of_kind(kind)[:MAX_FORCES]
    choices = product(*([None, *range(n)] for _ in usual))
    return [
        tuple((name, index) for name, index in zip(usual, choice, strict=True) if index is not None)
        for choice in choices
    ]
