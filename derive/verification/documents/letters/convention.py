"""The meaning of a document's letters in the names of its system, and in words."""

import sympy as sp

from derive.verification.documents.letters.candidates import SystemCandidate, kind_of

#: Where angles are measured from, by their offset in right angles.
ZEROS = {0: "hanging", 1: "the horizontal", -1: "the horizontal", 2: "upright"}


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
