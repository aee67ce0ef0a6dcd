"""The first sections of a document: the system, its velocities and its energies."""

from collections.abc import Iterator, Sequence

import sympy as sp

from derive.handout.derived_letters import unit_words, words
from derive.handout.document_model import Block, HandoutTable, Paragraph
from derive.handout.numbering import Numbering
from derive.mechanics.derivation import Derivation
from derive.system.parts import Coordinate, Input, Parameter
from derive.system.rigid_body import RigidBody


def system(d: Derivation, formulas: Numbering) -> Iterator[Block]:
    """Coordinates, parameters, masses and positions."""
    yield Paragraph("The coordinates of the system are as follows.")
    coordinates = ((f"`{c.symbol}`", unit_words(c.unit), meaning(c)) for c in d.system.coordinates)
    yield HandoutTable(("coordinate", "unit", "meaning"), tuple(coordinates))
    if d.system.parameters:
        yield Paragraph("The parameters are constant.")
        parameters = (
            (f"`{p.symbol}`", f"{p.default:g} {unit_words(p.unit)}".rstrip(), meaning(p))
            for p in d.system.parameters
        )
        yield HandoutTable(("parameter", "default value", "meaning"), tuple(parameters))
    if d.system.inputs:
        yield Paragraph("The inputs may change during a motion.")
        inputs = ((f"`{u.symbol}`", unit_words(u.unit), meaning(u)) for u in d.system.inputs)
        yield HandoutTable(("input", "unit", "meaning"), tuple(inputs))
    masses = d.system.masses
    noun = "positions of the masses" if len(masses) > 1 else "position of the mass"
    names = formulas.text(*dict.fromkeys(mass.mass for mass in masses))
    yield Paragraph(f"The {noun} {names} in Cartesian components, the last one upwards:")
    positions = [sp.Matrix(mass.position) for mass in masses]
    yield from formulas.vectors("", positions, is_given=True)
    bodies = [mass for mass in masses if isinstance(mass, RigidBody)]
    if bodies:
        yield Paragraph("These are centres of mass of rigid bodies.")
        values = ((b.mass, b.inertia, b.orientation) for b in bodies if b.axes is None)
        rows = tuple(tuple(map(formulas.text, row)) for row in values)
        if rows:
            yield HandoutTable(("mass", "moment of inertia", "orientation"), rows)
        yield from _in_space([body for body in bodies if body.axes], formulas)


def _in_space(bodies: Sequence[RigidBody], formulas: Numbering) -> Iterator[Block]:
    """Inertia of bodies in space, and their axes."""
    for body in bodies:
        mass = formulas.text(body.mass)
        entries = [entry for k in range(3) for entry in body.tensor[k, k:]]
        yield Paragraph(
            f"The tensor of inertia of {mass} about its centre of mass, in body axes, has the "
            f"entries xx, xy, xz, yy, yz and zz: {formulas.text(*entries)}."
        )
        if body.axes:
            yield Paragraph(f"The orientation of {mass} is that of {body.axes.words}.")


def constraints(d: Derivation, formulas: Numbering) -> Iterator[Block]:
    """Constraints, with names, and their multipliers."""
    yield Paragraph("These functions remain zero along a motion.")
    for name, one in zip(formulas.notation.constraints, d.system.conditions, strict=True):
        yield formulas.equation(name, value=one.formula, after=("0",), is_given=True)
    yield Paragraph(
        "A multiplier times the derivatives of its function by the coordinates, or by the "
        "velocities if it contains any, is the reaction that keeps it so."
    )
    rows = ((f"`{c.symbol}`", unit_words(c.unit), words(c.meaning)) for c in d.system.conditions)
    yield HandoutTable(("multiplier", "unit", "meaning"), tuple(rows))
    decision = d.integrability
    if decision.integrals:
        yield Paragraph(
            "Some constraints of velocities follow from constraints of positions. These functions "
            f"are constant: {formulas.text(*decision.integrals)}."
        )
    if decision.nonholonomic:
        yield Paragraph(
            "Constraints of velocities that are not integrable restrict no positions. They must "
            "not be used to remove velocities from the Lagrangian before it is differentiated, "
            "because varied motions do not satisfy them: the equations would lack forces."
        )


def meaning(part: Coordinate | Parameter | Input) -> str:
    """The meaning of a symbol; none if it only repeats the name."""
    return "" if part.meaning == part.symbol.name else words(part.meaning)


def velocities(d: Derivation, formulas: Numbering) -> Iterator[Block]:
    """Time derivatives of the positions."""
    yield Paragraph("The velocities follow by the chain rule.")
    yield from formulas.vectors("_dot", d.velocities)


def energies(d: Derivation, formulas: Numbering) -> Iterator[Block]:
    """Kinetic and potential energy, friction and applied forces."""
    letter = formulas.notation.letter
    turning = ""
    if d.bodies:
        turning = " and the energy of its rotation"
    elif any(isinstance(mass, RigidBody) for mass in d.system.masses):
        turning = " and half its moment of inertia times the square of its angular velocity"
    yield Paragraph(
        "The kinetic energy is the sum over all masses of half the mass times the square of its "
        f"velocity{turning}."
    )
    yield formulas.equation(letter("T"), value=d.kinetic_energy)
    has_weight = d.system.potential is None or d.system.gravity is not None
    if d.system.potential is None:
        yield Paragraph("The potential energy is that of the weight.")
    elif has_weight:
        yield Paragraph("The potential energy includes that of the weight.")
    else:
        yield Paragraph("The potential energy belongs to the definition of the system.")
    yield formulas.equation(letter("V"), value=d.potential_energy, is_given=not has_weight)
    if d.system.dissipation != 0:
        yield Paragraph(
            "Rayleigh's function describes friction: its negative derivatives with respect to the "
            "velocities are forces."
        )
        yield formulas.equation(letter("R"), value=d.system.dissipation, is_given=True)
    if any(d.system.applied):
        yield Paragraph("The generalized forces without a potential:")
        for i, force in enumerate(d.system.applied):
            if name := formulas.notation.force(i):
                is_given = d.system.dissipation == 0
                yield formulas.equation(name, value=force, is_given=is_given)
