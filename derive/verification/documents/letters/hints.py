"""What a user says about a document: its system, and the meanings of letters."""

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
from derive.verification.documents.letters.further_systems import named
from derive.verification.documents.letters.letters import Letters
from solvers.io.suggestion import did_you_mean
from solvers.io.toml_input import InputError


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
