"""The known systems that are tried for the letters of a document."""

from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path

from derive.system.files.system_catalogue import load
from derive.system.parts import Parameter
from derive.system.symbols import TIME
from derive.system.system import System
from derive.verification.documents.letters.known_systems.free_bodies import free_bodies
from derive.verification.documents.letters.known_systems.in_fields import systems_in_fields
from derive.verification.documents.letters.known_systems.mechanisms import mechanisms
from derive.verification.documents.letters.known_systems.of_documents import systems_of_documents
from derive.verification.documents.letters.known_systems.oscillating import oscillating_systems
from derive.verification.documents.letters.known_systems.uniform_rods import uniform_rods
from derive.verification.documents.letters.letters import Letters

#: Systems that ship and are tried, the commonest first.
SHIPPED = (
    "double_pendulum single_pendulum cart_1 elastic_pendulum spherical_pendulum chain_3 cart_2 "
    "double_bar_pendulum swinging_atwood rotating_hoop driven_pendulum coupled_pendulums "
    "henon_heiles foucault_pendulum"
).split()
#: Systems of programs that are tried for documents as well, where no energy is stated.
OF_EQUATIONS = frozenset(
    "forced_pendulum_cosine scaled_forced_pendulum_cosine attracted_mass_2 attracted_unit_mass_2 "
    "cubic_potential bodies_2_2 damped_oscillator damped_oscillator_by_rates "
    "driven_oscillator_by_rates driven_oscillator_cosine duffing_cosine van_der_pol".split()
)
#: Systems that ship and are tried for programs alone.
SHIPPED_OF_PROGRAMS = "furuta_pendulum heavy_top duffing".split()


def templates(
    letters: Letters, count: int, has_rods: bool = True, has_time: bool = True
) -> Iterator[System]:
    """Yield the systems with so many coordinates, of uniform rods as well or without these.

    Free bodies are tried where constraints are stated; other systems of programs for these, and
    some of them for documents that state no energy. Driven ones are left out where no formula
    `has_time`.
    """
    groups = [_free()] if letters.constraints else []
    groups += [_usual(), *([_rods()] if has_rods else [])]
    if letters.are_of_program:
        groups.append(tuple(one for one in _of_programs() if has_time or not _is_driven(one)))
    elif not letters.quantities:
        groups.append(tuple(one for one in _of_programs() if one.name in OF_EQUATIONS))
    yield from (one for group in groups for one in group if len(one.coordinates) == count)


def named(name: str | Path) -> System:
    """The system of a name, also one that does not ship, or of a path.

    Inputs are parameters, since a document has letters for both.
    """
    shipped = {*SHIPPED, *SHIPPED_OF_PROGRAMS}
    own = () if name in shipped else (*_free(), *_usual(), *_rods(), *_of_programs())
    return next((one for one in own if one.name == name), None) or _with_letters(load(name))


def _with_letters(system: System) -> System:
    inputs = [Parameter(one.symbol, one.unit, 1.0, one.meaning) for one in system.inputs]
    return replace(system, parameters=(*system.parameters, *inputs), inputs=())


def _is_driven(system: System) -> bool:
    """Whether the equations contain the time, as those in a rotating frame do not."""
    has_frequency = any(one.unit == "rad/s" for one in system.parameters)
    places = (component for mass in system.masses for component in mass.position)
    return has_frequency and any(one.has(TIME) for one in (system.potential_energy, *places))


@cache
def _free() -> tuple[System, ...]:
    return (*free_bodies(),)


@cache
def _usual() -> tuple[System, ...]:
    return (*map(load, SHIPPED), *systems_of_documents())


@cache
def _rods() -> tuple[System, ...]:
    return (*uniform_rods(),)


@cache
def _of_programs() -> tuple[System, ...]:
    return (
        *(_with_letters(load(one)) for one in SHIPPED_OF_PROGRAMS),
        *oscillating_systems(),
        *systems_in_fields(),
        *mechanisms(),
    )
