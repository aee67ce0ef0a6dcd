"""What the letters of a document can mean: a system, an order of coordinates, a convention."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from itertools import combinations, islice, permutations, product
from typing import Any, Literal, TypeAlias

import sympy as sp

from derive.system.parts import Parameter
from derive.system.system import System
from derive.verification.documents.letters.letters import KINDS, Letters
from derive.verification.documents.letters.stated_constraints import StatedConstraint
from derive.verification.documents.statements import WORD
from derive.verification.judging.system_names import FACTORS

#: The names of systems that documents state by positions or energies, and by equations of motion:
#: by those with a potential energy, and by others; by a Lagrangian with terms linear in velocities,
#: which belong to no kinetic energy.
STATED, BY_POTENTIAL, BY_EQUATIONS = "stated", "stated_potential", "stated_equations"
BY_LAGRANGIAN = "stated_lagrangian"
#: Largest number of candidates of one system, the likeliest: in some 240 documents and programs,
#: those that were meant were among the first 210, but for one.
MAX_CANDIDATES = 600
#: The same of one with constraints, before those of the signs of multipliers.
MAX_CONSTRAINED = 400
#: Largest number of choices of parameters of one kind, and of all.
MAX_CHOICES = 200
#: Letters of forces and of friction that are tried.
MAX_FORCES = 2

#: Kinds of parameters of which a document can have a part.
PARTIAL = ("stiffness", "frequency")

#: Most multipliers whose signs are tried one by one.
MAX_SIGNS = 3

#: What a letter of friction damps: the rate of one coordinate or of all, the velocity of each mass
#: (with Rayleigh's function b (v_1**2 + v_2**2)/2), or the motion as a whole (Q = -b M q_dot).
Damped: TypeAlias = int | Literal["coordinates", "masses", "motion"]

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
    "N": "force",
    "N m": "force",
}


@dataclass(frozen=True)
class SystemCandidate:
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
    friction: tuple[tuple[str, Damped], ...] = ()
    #: Numbers in place of parameters that have no letter.
    numbers: Mapping[str, str] = field(default_factory=dict)
    #: Constraints that the document states, after those of the system.
    constraints: tuple[StatedConstraint, ...] = ()
    #: Letters of multipliers, the number of the constraint, and the factor of its multiplier.
    multipliers: tuple[tuple[str, int, sp.Rational], ...] = ()
    #: Numbers of formulas that state the system, beside constraints.
    stating: frozenset[int] = frozenset()
    #: Whether a parameter of a kind with usual letters has another.
    has_unusual_letters: bool = False
    #: Letters of reactions along the motion, with their values in the symbols of the system.
    reactions: Mapping[str, sp.Expr] = field(default_factory=dict)

    @property
    def is_usual(self) -> bool:
        """Whether the coordinates are those of the system, but for the elongation of a spring."""
        return _is_usual(self.signs, self.offsets)

    @property
    def is_turned(self) -> bool:
        """Whether its angles are those from the horizontal, which few documents have."""
        return any(isinstance(one, int) and one % 2 for one in self.offsets)

    @property
    def lacking(self) -> int:
        """How many parameters of the system have neither a letter nor a number."""
        return len(self.system.parameters) - len({*self.parameters, *self.numbers})

    @property
    def basis(self) -> Literal["equations", "energies", "positions", "catalogue"]:
        """What it rests on: statements of the document, or a known system."""
        if self.stating:
            return "equations" if self.system.name == BY_EQUATIONS else "energies"
        return "positions" if self.system.name == STATED else "catalogue"

    @property
    def is_of_equations(self) -> bool:
        """Whether equations of motion of the document state the system."""
        return self.system.name in (BY_POTENTIAL, BY_EQUATIONS)

    @cached_property
    def letters(self) -> frozenset[str]:
        """The parameters of the document that have a meaning, or can have one in constraints."""
        own: set[str] = {*self.parameters.values(), *self.reactions}
        own |= {one for one in self.offsets if isinstance(one, str)}
        loads: list[tuple[Any, ...]] = [*self.forces, *self.friction, *self.multipliers]
        own |= {str(name) for name, *_ in loads}
        return frozenset(own.union(*(WORD.findall(one.text) for one in self.constraints)))

    @property
    def given(self) -> frozenset[int]:
        """Numbers of constraints, which hold for the system whatever they are."""
        return frozenset(one.number for one in self.constraints)

    @property
    def title(self) -> str:
        """The title of the system."""
        stated = " with the constraints that the document states" if self.constraints else ""
        return f"{self.system.title}{stated}"

    @property
    def condition_count(self) -> int:
        """The number of constraints."""
        return len(self.system.conditions) + len(self.constraints)


@cache
def _is_usual(signs: tuple[tuple[int, ...], ...], offsets: tuple[int | str, ...]) -> bool:
    n = range(len(signs))
    is_same = all(signs[i][j] == (i == j) for i in n for j in n)
    return is_same and not any(isinstance(one, int) and one for one in offsets)


def kind_of(parameter: Parameter) -> str:
    """The kind of a parameter by its unit, or "" for others."""
    return UNITS.get(parameter.unit, "")


def candidates(
    system: System,
    letters: Letters,
    numbers: Mapping[str, str] | None = None,
    has_all: bool = False,
) -> Iterator[SystemCandidate]:
    """Yield the candidates of a system, the likeliest first.

    With `numbers`, by kinds of parameters, these have the numbers instead of letters. With
    `has_all`, no parameter lacks a letter.
    """
    n = len(system.coordinates)
    is_constrained = bool(system.conditions or letters.constraints)
    if is_constrained:
        own = {*letters.multipliers}
        others = (one for one in letters.parameters if one not in own)
        letters = replace(letters, parameters=tuple(others))
    most = MAX_CONSTRAINED if is_constrained else MAX_CANDIDATES
    kinds = {one.symbol.name: kind for one in system.parameters if (kind := kind_of(one))}
    usual = {(name, one) for name, kind in kinds.items() for one in (name, *letters.of_kind(kind))}
    choices = _likeliest(
        [*islice(_conventions(system, letters), most)],
        sorted(
            letters.orders([one.unit == "rad" for one in system.coordinates]),
            key=lambda order: _mixed([one.symbol.name for one in system.coordinates], order),
        ),
        [
            (
                one,
                {**_absent(system, one), **_numbers(system, one, numbers or {})},
                any(pair[0] in kinds and pair not in usual for pair in one.items()),
                frozenset(one.values()),
            )
            for one in islice(_parameters(system, letters), MAX_CHOICES)
            if not has_all or len({*one, *_absent(system, one)}) == len(system.parameters)
        ],
        [(one, {*dict(one)}) for one in loads(letters, "force", n)],
        [(one, {*dict(one)}) for one in frictions(letters, n, {*kinds.values()})],
    )
    for convention, order, parameters, (forces, acting), (friction, damping) in islice(
        choices, most
    ):
        (signs, offsets), (mapping, stated, is_unusual, used) = convention, parameters
        if not (used.isdisjoint(acting) and used.isdisjoint(damping)):
            continue  # the letter of a force of the system
        if numbers is None or stated:
            one = SystemCandidate(
                system, order, signs, offsets, mapping, forces, friction, stated,
                has_unusual_letters=is_unusual,
            )  # fmt: skip
            yield from constrained(one, letters) if is_constrained else (one,)


def _mixed(names: Sequence[str], letters: Sequence[str]) -> int:
    """How many pairs of coordinates are of one body in the system alone, or in letters alone."""
    pairs = combinations(zip(map(_index, names), map(_index, letters), strict=True), 2)
    return sum((a == c) != (b == d) for (a, b), (c, d) in pairs)


def constrained(candidate: SystemCandidate, letters: Letters) -> Iterator[SystemCandidate]:
    """The candidate with the constraints of its coordinates, and meanings of multipliers.

    A system with constraints has no others. There is none if a constraint of the document contains
    other coordinates as well.
    """
    if not (candidate.system.conditions or letters.constraints):
        yield candidate
        return
    own = set() if candidate.system.conditions else {*candidate.coordinates}
    stated = tuple(one for one in letters.constraints if one.coordinates & own)
    if not all(one.coordinates <= own for one in stated):
        return
    if stated:
        candidate = replace(candidate, constraints=stated)
    count = min(candidate.condition_count, len(letters.multipliers))
    if not count:
        yield candidate
        return
    for factors in _factors(count):
        numbered = zip(letters.multipliers, range(len(factors)), factors, strict=False)
        yield replace(candidate, multipliers=tuple(numbered))


def _factors(count: int) -> Iterator[tuple[sp.Rational, ...]]:
    """Factors of multipliers: the same for all, or signs of each."""
    common = [(one,) * count for one in FACTORS]
    signs = product(*(FACTORS[:2],) * count) if count <= MAX_SIGNS else iter(())
    yield from dict.fromkeys([*common, *signs])


def _numbers(
    system: System, mapping: Mapping[str, str], numbers: Mapping[str, str]
) -> dict[str, str]:
    """Numbers for the parameters without a letter."""
    kinds = {p.symbol.name: kind_of(p) for p in system.parameters}
    return {
        name: numbers.get(kind, "1")
        for name, kind in kinds.items()
        if numbers and name not in mapping
    }


def _absent(system: System, mapping: Mapping[str, str]) -> dict[str, str]:
    """Zero for springs without a letter, of a document with a letter for another spring."""
    springs = [p.symbol.name for p in system.parameters if kind_of(p) == "stiffness"]
    without = [name for name in springs if name not in mapping]
    return dict.fromkeys(without, "0") if len(without) < len(springs) else {}


def _likeliest(*choices: Sequence[Any]) -> Iterator[tuple[Any, ...]]:
    """Combinations of choices, each sorted: those with the smallest sum of indices first."""

    def with_sum(total: int, axis: int) -> Iterator[tuple[Any, ...]]:
        """Combinations of the choices from an axis on whose indices have a sum."""
        if axis < len(choices):
            for i, one in enumerate(choices[axis][: total + 1]):
                yield from ((one, *rest) for rest in listed(total - i, axis + 1))
        elif not total:
            yield ()

    @cache
    def listed(total: int, axis: int) -> list[tuple[Any, ...]]:
        return [*with_sum(total, axis)]

    for total in range(sum(map(len, choices)) - len(choices) + 1):
        yield from with_sum(total, 0)


def _conventions(
    system: System, letters: Letters
) -> Iterator[tuple[tuple[tuple[int, ...], ...], tuple[int | str, ...]]]:
    """Yield the signs and offsets of coordinates, the usual ones first."""
    angles = [c.unit == "rad" for c in system.coordinates]
    n = len(angles)
    natural: list[int | str] = [0, *letters.of_kind("length")]
    positions = [c.symbol for c in system.coordinates if c.unit != "rad"]
    directions = [(1,) if symbol.is_positive else (1, -1) for symbol in positions]
    for (sign, turn), relative, *shifts in _likeliest(
        ANGLES if any(angles) else ANGLES[:1],
        (False, True) if angles.count(True) > 1 else (False,),
        *([(s, o) for o in natural for s in signs] for signs in directions),
    ):
        rows, offsets, rest = list[tuple[int, ...]](), list[int | str](), iter(shifts)
        for i, is_angle in enumerate(angles):
            own_sign, offset = (sign, turn) if is_angle else next(rest)
            before = range(i) if relative and is_angle else ()
            rows.append(tuple(own_sign * (j == i or (j in before and angles[j])) for j in range(n)))
            offsets.append(offset)
        yield tuple(rows), tuple(offsets)


def _parameters(system: System, letters: Letters) -> Iterator[Mapping[str, str]]:
    """Yield letters for the parameters of a system, one kind after another."""
    groups: dict[str, list[str]] = {}
    for parameter in system.parameters:
        groups.setdefault(kind_of(parameter), []).append(parameter.symbol.name)
    spare = _spare(groups, letters) if letters.are_of_program else []
    choices = (_choices(kind, names, letters, spare) for kind, names in groups.items())
    for choice in _likeliest(*choices):
        used = [letter for one in choice for letter in {*one.values()}]
        if len({*used}) == len(used):  # no letter has two units
            yield {name: letter for one in choice for name, letter in one.items()}


def _spare(groups: Mapping[str, Sequence[str]], letters: Letters) -> list[str]:
    """Letters that are of no kind by their names, or of one with more letters than parameters."""
    named = {kind: letters.of_kind(kind) for kind in groups if kind}
    taken = {p for kind, own in named.items() if len(own) <= len(groups[kind]) for p in own}
    return [p for p in letters.parameters if p not in taken]


def _choices(
    kind: str, names: Sequence[str], letters: Letters, spare: Sequence[str]
) -> list[dict[str, str]]:
    """The letters of parameters of one kind: their own, the same indices, one for all.

    Of springs and frequencies, some can be absent. Where no name is of this kind, there is none
    or a `spare` one.
    """
    own = {name: name for name in names if name in letters.parameters}
    named = letters.of_kind(kind) if kind else list(letters.parameters)
    usual = named or spare
    if len(usual) >= len(names):
        orders: Iterator[Sequence[str]] = permutations(usual, len(names))
    else:
        orders = product(usual, repeat=len(names))
    chosen = [dict(zip(names, order, strict=True)) for order in islice(orders, MAX_CHOICES)]
    if kind in PARTIAL and 0 < len(usual) < len(names):
        parts = permutations(names, len(usual))
        chosen += [dict(zip(part, usual, strict=True)) for part in islice(parts, MAX_CHOICES)]
    same = [dict.fromkeys(names, one) for one in usual] if len(names) > 1 else []
    if letters.are_of_program:
        same = [one for one in same if not _has_partner(one[names[0]], usual)]
    chosen.sort(key=lambda one: sum(_index(name) != _index(one[name]) for name in one))
    others = [*chosen, *(one for one in same if one not in chosen)]
    if len(own) == len(names):
        return [own, *(one for one in others if one != own)]
    if not named:
        return [{}, *others]
    # a mass called mu can be a friction
    return [*others, {}] if kind == "mass" and {*named} <= {*letters.of_kind("damping")} else others


def _has_partner(letter: str, usual: Sequence[str]) -> bool:
    """Whether a letter with an index stands beside the same one with another, as r1 beside r2."""
    stem = letter.rstrip("0123456789")
    return any(one != letter and one.rstrip("0123456789") == stem for one in usual)


def _index(name: str) -> str:
    """The number in a name, and whether its letter is r, which stands for a centre of mass."""
    return name[:1] * (name[:1] == "r") + "".join(filter(str.isdigit, name))


def loads(
    letters: Letters, kind: str, n: int, kinds: Collection[str] = KINDS
) -> list[tuple[tuple[str, int], ...]]:
    """The coordinates on which each letter of a force acts: none, or one of them.

    A letter of a program stands in an equation of motion, and most likely acts.
    """
    usual = _letters_of_loads(letters, kind, kinds)
    choices = product(*([None, *range(n)] for _ in usual))
    result = [
        tuple((name, index) for name, index in zip(usual, choice, strict=True) if index is not None)
        for choice in choices
    ]
    is_likely = letters.are_of_program and bool(letters.of_kind(kind))
    return sorted(result, key=len, reverse=True) if is_likely else result


def frictions(
    letters: Letters, n: int, kinds: Collection[str] = KINDS
) -> list[tuple[tuple[str, Damped], ...]]:
    """What letters of friction damp: one coordinate each, or one of them everything.

    In a program these are also letters of kinds that the parameters do not have.
    """
    one_each: list[tuple[tuple[str, Damped], ...]] = [*loads(letters, "damping", n, kinds)]
    names = _letters_of_loads(letters, "damping", kinds)
    everything: tuple[Damped, ...] = ("coordinates", "masses", "motion")
    alone = [((name, damped),) for name in names for damped in everything]
    if not one_each[0]:  # it most likely damps nothing
        return [*one_each, *alone]
    full = sum(len(one) == len(names) for one in one_each)
    return [*one_each[:full], *alone, *one_each[full:]]


def _letters_of_loads(letters: Letters, kind: str, kinds: Collection[str]) -> list[str]:
    """Letters of a kind of loads; of friction in a program else those of no kind of parameters."""
    usual = letters.of_kind(kind)
    if not usual and kind == "damping" and letters.are_of_program:
        others = (one for one in KINDS if one != "stiffness" or one in kinds)
        known = {p for one in others for p in letters.of_kind(one)}
        usual = [p for p in letters.parameters if p not in known]
    return usual[:MAX_FORCES]
