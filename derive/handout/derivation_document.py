"""The document of a derivation: its sections, and its files in the format of their suffix."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from textwrap import fill
from typing import TypeAlias

from derive.codegen.backend import find_backends
from derive.codegen.forms.factorisation import LARGE
from derive.codegen.module_functions import contents
from derive.handout.derived_letters import DerivedLetters, names_of, words
from derive.handout.document_model import (
    WIDTH,
    Block,
    Code,
    HandoutDocument,
    HandoutSection,
    Paragraph,
)
from derive.handout.exercises import Exercise, with_exercises
from derive.handout.formats.notebook import notebook
from derive.handout.formats.page import page
from derive.handout.formats.tex import tex
from derive.handout.motion_sections import (
    accelerations,
    energy,
    euler_lagrange,
    hamilton,
    lagrangian,
    routhian,
)
from derive.handout.numbering import Numbering
from derive.handout.oscillations import oscillations
from derive.handout.setup import constraints, energies, system, velocities
from derive.mechanics.derivation import Derivation
from derive.mechanics.reduced_coordinates import reduced
from derive.system.parts import SystemDefinitionError
from solvers.io.atomic_write import write_texts

Blocks: TypeAlias = Callable[[Derivation, Numbering], Iterator[Block]]

SECTIONS: dict[str, Blocks] = {
    "System": system,
    "Constraints": constraints,
    "Velocities": velocities,
    "Energies": energies,
    "Lagrangian and momenta": lagrangian,
    "Euler–Lagrange equations": euler_lagrange,
    "Accelerations": accelerations,
    "Hamilton's equations": hamilton,
    "Routhian": routhian,
    "Energy balance": energy,
    "Small oscillations": oscillations,
}
#: Coordinates of the largest system: its document has fifty pages.
LARGEST_SYSTEM = 10
LANGUAGES = {".py": "Python", ".h": "C"}


def document(derivation: Derivation) -> HandoutDocument:
    """The document of a derivation.

    Parameters
    ----------
    derivation : Derivation
        The derivation of any system.

    Returns
    -------
    Document
        Sections with numbered formulas, from the positions to generated code.

    Raises
    ------
    SystemDefinitionError
        When the system has more than `LARGEST_SYSTEM` coordinates.
    UnsupportedFunctionError
        When an expression has no counterpart in generated code.

    Examples
    --------
    >>> from derive import Derivation, load
    >>> [section.title for section in document(Derivation(load("single_pendulum"))).sections][:3]
    ['System', 'Velocities', 'Energies']
    """
    count = len(derivation.system.q)
    if count > LARGEST_SYSTEM:
        raise SystemDefinitionError(
            f"a document of {count} coordinates is too long to read: at most {LARGEST_SYSTEM} are "
            "allowed; choose a system with fewer"
        )
    derivation = with_letters(derivation)
    formulas = Numbering(DerivedLetters(derivation.system))
    sections = [
        HandoutSection(title, tuple(blocks(derivation, formulas)))
        for title, blocks in SECTIONS.items()
        if _exists(blocks, derivation)
    ]
    sections.append(HandoutSection("Generated code", tuple(_code(derivation, formulas))))
    return HandoutDocument(words(derivation.system.title), tuple(sections))


def _exists(blocks: Blocks, derivation: Derivation) -> bool:
    """Whether a system has a section."""
    if blocks is routhian:
        return 0 < len(derivation.cyclic_coordinates) < len(derivation.system.q)
    return blocks is not constraints or bool(derivation.system.conditions)


def with_letters(derivation: Derivation) -> Derivation:
    """The derivation with multipliers that are called λ, with an index."""
    system = derivation.system
    taken = {s.name for s in (*system.params, *system.q)}
    letters = [f"lambda_{k}" for k in range(1, len(system.conditions) + 1)]
    if taken & {*letters} or letters == [one.name for one in system.conditions]:
        return derivation
    pairs = zip(system.conditions, letters, strict=True)
    renamed = [replace(one, name=letter, meaning=one.meaning) for one, letter in pairs]
    return Derivation(replace(system, constraints=renamed))


def _code(derivation: Derivation, formulas: Numbering) -> Iterator[Block]:
    """The right-hand side in every target language, in the fewest coordinates."""
    derivation = Derivation(reduced(derivation.system))
    (rhs,) = contents(derivation, ["rhs"]).functions
    yield Paragraph(
        "As generated code, the equations of motion give velocities and accelerations at a state."
    )
    if eliminated := derivation.system.eliminated:
        determined = names_of([one.coordinate.symbol for one in eliminated])
        q, qdot = names_of(derivation.system.q), names_of(derivation.system.qdot)
        yield Paragraph(
            f"The constraints determine `{determined}`: the state y consists of `{q}` and `{qdot}` "
            "alone."
        )
        for one in eliminated:  # no exercises, which contain no code
            name = one.coordinate.symbol.name
            yield formulas.equation(name, value=one.formula, is_given=True)
    for backend in reversed(find_backends()):
        language = LANGUAGES.get(backend.suffix, backend.suffix.removeprefix("."))
        text = backend.function(rhs).strip("\n")
        is_executable = language == "Python" and len(derivation.system.q) < LARGE
        if is_executable:
            called = ", ".join(sorted(rhs.lowering.functions))
            imports = f"from math import {called}\n\n\n" if called else "\n"
            text = f"from __future__ import annotations\n\n{imports}{text}"
        yield Code(language, text, is_executable)
        if is_executable:
            yield Code(language, _example(derivation), is_executable)


def _example(derivation: Derivation) -> str:
    """A call of the right-hand side at a state."""
    defaults = [float(parameter.default) for parameter in derivation.system.parameters_and_inputs]
    lines = [f"y = [0.1] * {2 * len(derivation.system.q)}", fill(f"params = {defaults}", WIDTH)]
    return "\n".join([*lines, "rhs(0.0, y, params)"])


WRITERS: dict[str, Callable[[HandoutDocument], str]] = {
    ".html": page,
    ".tex": tex,
    ".ipynb": notebook,
}


def write_document(
    derivation: Derivation, path: Path, exercises: Exercise | None = None, seed: int = 0
) -> list[Path]:
    """Write the document of a derivation; with exercises, also the key beside it.

    Parameters
    ----------
    derivation : Derivation
        The derivation of any system.
    path : Path
        The file, of a suffix in `WRITERS`; its folder exists.
    exercises : {"blank", "mistakes"}, optional
        Leave formulas blank, or plant one mistake in each; the key is a second file, ``_key``.
    seed : int, default 0
        The mistakes follow from it.

    Returns
    -------
    list of Path
        The files; all are complete before the first is moved into place.

    Raises
    ------
    OSError
        When a file cannot be written.
    UnsupportedFunctionError
        When an expression has no counterpart in generated code.
    """
    write, whole = WRITERS[path.suffix], document(derivation)
    documents = {path.name: whole}
    if exercises:
        pair = with_exercises(whole, exercises, seed)
        documents = dict(zip((path.name, f"{path.stem}_key{path.suffix}"), pair, strict=True))
    write_texts(path.parent, {name: write(one) for name, one in documents.items()})
    return [path.with_name(name) for name in documents]
