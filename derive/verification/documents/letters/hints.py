"""The meanings of letters as a user states them, with the system, and those of a candidate."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import sympy as sp

from derive.formulas.expression import FUNCTIONS, parse
from derive.formulas.syntax import ExpressionError
from derive.system.files.part_tables import TomlTable, read
from derive.system.system import System
from derive.verification.documents.letters.candidates import SystemCandidate, candidates, kind_of
from derive.verification.documents.letters.known_systems.templates import named
from derive.verification.documents.letters.letters import Letters
from solvers.io.suggestion import did_you_mean
from solvers.io.toml_input import InputError

#: Where angles are measured from, by their offset in right angles.
ZEROS = {0: "hanging", 1: "the horizontal", -1: "the horizontal", 2: "upright"}


def without_meaning(hints: "Hints | None") -> str:
    """The reason why formulas are not judged: their letters have no meaning."""
    if hints is None:
        return "no system was found for which its formulas hold"
    return f"no meaning of its letters was found for which its formulas hold in {hints.system.name}"


@dataclass(frozen=True)
class Hints:
    """The system of a document, and letters as formulas in the names of the system."""

    system: System
    names: Mapping[str, str]

    def __post_init__(self) -> None:
        for letter, text in self.names.items():
            try:
                value = parse(text, self._namespace)
            except ExpressionError as error:
                raise InputError(f"names.{letter}: {error}") from error
            if not value.free_symbols & {*self.system.q} and value not in self.system.params:
                known = [*(q.name for q in self.system.q), *(p.name for p in self.system.params)]
                raise InputError(
                    f"names.{letter}: {text!r} is neither a parameter nor a formula in coordinates"
                    f"{did_you_mean(text, known)}; known are {', '.join(known)}"
                )

    def candidates(self, letters: Letters) -> Iterator[Sequence[SystemCandidate]]:
        """Yield the candidates that agree with the names."""
        kinds = {p.symbol.name: kind_of(p) for p in self.system.parameters}
        # letters that are spelled as parameters, such as c_1, or as in Fortran, need not be given
        own = {name.replace("_", ""): name for name in {*kinds} - {*self.names.values()}}
        spelled = {short.lower(): name for short, name in own.items()} | own
        meant = {letter: spelled.get(letter.replace("_", "")) for letter in letters.parameters}
        pairs = (meant | {**self.names}).items()
        hinted = {letter: kinds[text] for letter, text in pairs if text in kinds}
        yield [one for one in candidates(self.system, letters.hinted(hinted)) if self._agree(one)]

    def _agree(self, candidate: SystemCandidate) -> bool:
        return all(self._agrees(candidate, letter) for letter in self.names)

    def _agrees(self, candidate: SystemCandidate, letter: str) -> bool:
        value = parse(self.names[letter], self._namespace)
        if value in self.system.params:
            return candidate.parameters.get(value.name) == letter
        if letter not in candidate.coordinates:
            return False
        own = [sp.Symbol(name, real=True) for name in candidate.coordinates]
        letters = candidate.parameters
        meanings = {p: sp.Symbol(letters[p.name]) for p in self.system.params if p.name in letters}
        rows = zip(self.system.q, candidate.signs, candidate.offsets, strict=True)
        for q, signs, offset in rows:
            shift = sp.Symbol(offset) if isinstance(offset, str) else offset * sp.pi / 2
            meanings[q] = sp.Add(*(s * one for s, one in zip(signs, own, strict=True)), shift)
        difference = value.xreplace(meanings) - own[candidate.coordinates.index(letter)]
        return bool(sp.expand(difference) == 0)

    @cached_property
    def _namespace(self) -> dict[str, object]:
        return {s.name: s for s in (*self.system.q, *self.system.params)} | FUNCTIONS


def hints(system: str | None, names: Path | None) -> Hints | None:
    """The hints of the options ``--system`` and ``--names``; None without them.

    A file of names is in TOML, with the key ``system`` and the table ``names``, as files of hand
    derivations have them.

    Raises
    ------
    InputError
        If the file cannot be read, or a name has no meaning in the system; if a file has no system
        and none is given.
    """
    if names is None:
        return Hints(named(system), {}) if system else None
    table = TomlTable(str(names), read(names), ("system", "names"))
    name = system or table.text("system")
    path = names.parent / name if name.endswith(".toml") and not system else name
    return Hints(named(path), _texts(table.entries("names").items()))


def _texts(items: Iterable[tuple[str, object]]) -> dict[str, str]:
    return {name: str(text) for name, text in items}


def names_of(candidate: SystemCandidate) -> dict[str, str]:
    """Letters as formulas in the names of the system, as a file of names states them."""
    own = {letter: name for name, letter in reversed([*candidate.parameters.items()])}
    shifts = [
        sp.Symbol(own.get(one, one)) if isinstance(one, str) else one * sp.pi / 2
        for one in candidate.offsets
    ]
    rest = sp.Matrix([q - c for q, c in zip(candidate.system.q, shifts, strict=True)])
    values = sp.Matrix(candidate.signs).inv() * rest
    texts = map(sp.sstr, values)
    return dict(zip(candidate.coordinates, texts, strict=True)) | own


def convention(candidate: SystemCandidate) -> str:
    """The letters whose meanings are not the usual ones, in words; "" without any."""
    unusual = [
        f"{letter} = {text}"
        for letter, text in names_of(candidate).items()
        if _is_crossed(letter, text) or not (candidate.is_usual or text.isidentifier())
    ]
    return ", ".join(unusual) + (_angles(candidate) if _zero(candidate) else "")


def difference(candidate: SystemCandidate, other: SystemCandidate) -> str:
    """The meanings that another candidate does not have, in words."""
    names, others = names_of(candidate), names_of(other)
    changed = [f"{letter} = {text}" for letter, text in names.items() if others.get(letter) != text]
    loads = [one for one in _loads(candidate) if one not in _loads(other)]
    missing = [f"not {one}" for one in _loads(other) if one not in _loads(candidate)]
    angles = _angles(candidate) if _zero(candidate) != _zero(other) else ""
    return ", ".join([*changed, *loads, *missing]) + angles


def is_crossed(candidate: SystemCandidate) -> bool:
    """Whether a letter with an index has the meaning of one with another index."""
    pairs = (*names_of(candidate).items(), *((b, a) for a, b in candidate.parameters.items()))
    return any(_is_crossed(letter, text) for letter, text in pairs)


def _is_crossed(letter: str, text: str) -> bool:
    indices = ["".join(filter(str.isdigit, name)) for name in (letter, text)]
    return text.isidentifier() and all(indices) and indices[0] != indices[1]


def _zero(candidate: SystemCandidate) -> int:
    """The offset of the first angle in right angles."""
    units = [one.unit for one in candidate.system.coordinates]
    offsets = zip(candidate.offsets, units, strict=True)
    return next((o for o, unit in offsets if unit == "rad" and isinstance(o, int)), 0)


def _angles(candidate: SystemCandidate) -> str:
    has_gravity = any(kind_of(one) == "gravity" for one in candidate.system.parameters)
    return f" (angles from {ZEROS[_zero(candidate)]})" if has_gravity else ""


def _loads(candidate: SystemCandidate) -> list[str]:
    """Forces and friction in words."""
    forces = [f"{name} acts on {candidate.coordinates[i]}" for name, i in candidate.forces]
    damped = {
        "coordinates": "all coordinates",
        "masses": "the velocity of each mass",
        "motion": "the motion by its masses",
    }
    friction = [
        f"{name} damps {candidate.coordinates[one] if isinstance(one, int) else damped[one]}"
        for name, one in candidate.friction
    ]
    return forces + friction
