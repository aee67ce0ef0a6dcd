"""The section on Hamilton's equations."""

from collections.abc import Iterator

from derive.formulas.derivative import derivative
from derive.handout.derived_letters import names_of, words
from derive.handout.document_model import Block, Paragraph
from derive.handout.motion_sections import has_inverse, legendre
from derive.handout.numbering import Numbering, tidied
from derive.mechanics.derivation import Derivation
from derive.system.parts import SystemDefinitionError


def hamilton(d: Derivation, formulas: Numbering) -> Iterator[Block]:
    """The Hamiltonian and its derivatives, if they are readable, or else linear equations."""
    try:
        d.check_canonical()
    except SystemDefinitionError as error:
        yield Paragraph(
            f"There are none: {words(str(error).partition(': ')[2].partition(';')[0])}."
        )
        return
    if not has_inverse(d) or not formulas.are_readable([d.hamiltonian]):
        yield Paragraph(
            "The Hamiltonian contains the inverse of the mass matrix and is too long to read. At "
            "each state, linear equations give the velocities as functions of the momenta."
        )
        yield from _linear_equations(d, formulas)
        yield Paragraph("With these velocities, the rates of the momenta are as follows.")
        yield from _rates_of_momenta(d, formulas)
        return
    H, (velocities, rates) = formulas.notation.letter("H"), d.hamilton_equations
    rates = [tidied(rate, *d.system.q, *d.system.p) for rate in rates]
    yield Paragraph("The Hamiltonian is the energy as a function of coordinates and momenta.")
    yield formulas.equation(H, legendre(d, formulas), value=d.hamiltonian)
    yield Paragraph("Its derivatives are the rates of coordinates and momenta.")
    for qdot, p, value in zip(d.system.qdot, d.system.p, velocities, strict=True):
        yield formulas.equation(qdot.name, f"d({H}, {p})", value=value)
    if formulas.are_readable(rates):
        for i, (q, value) in enumerate(zip(d.system.q, rates, strict=True)):
            force = formulas.notation.force(i)
            right = f"-d({H}, {q})" + (f" + {force}" if force else "")
            yield formulas.equation(f"pdot_{q}", right, value=value)
    else:
        yield Paragraph("The rates of the momenta are shorter as functions of the velocities.")
        yield from _rates_of_momenta(d, formulas)


def _linear_equations(d: Derivation, formulas: Numbering) -> Iterator[Block]:
    """M q̇ + b = p, whose solution is the velocities."""
    M, b = map(formulas.notation.letter, "Mb")
    velocities, momenta = names_of(d.system.qdot), names_of(d.system.p)
    if d.drift.is_zero_matrix:
        yield formulas.relation(f"{M}*{velocities}", momenta)
    else:
        vector = f"{b}_vector" if len(d.system.q) > 1 else b
        yield formulas.relation(f"{M}*{velocities} + {vector}", momenta)
        yield from formulas.column(b, d.drift)


def _rates_of_momenta(d: Derivation, formulas: Numbering) -> Iterator[Block]:
    """ṗ = ∂L/∂q + Q as functions of coordinates and velocities."""
    L, state = formulas.notation.letter("L"), (*d.system.q, *d.system.qdot)
    for i, q in enumerate(d.system.q):
        force = formulas.notation.force(i)
        right = f"d({L}, {q})" + (f" + {force}" if force else "")
        value = tidied(derivative(d.lagrangian, q) + d.system.applied[i], *state)
        yield formulas.equation(f"pdot_{q}", right, value=value)


def routhian(d: Derivation, formulas: Numbering) -> Iterator[Block]:
    """The Routhian and its equations, if they are readable."""
    if not formulas.are_readable([d.routhian]):
        yield Paragraph("The Routhian is too long to read.")
        return
    L, R = formulas.notation.letter("L"), formulas.notation.routhian
    indices = [d.system.q.index(q) for q in d.cyclic_coordinates]
    momenta = [d.system.p[k] for k in indices]
    work = "".join(f" - {d.system.p[k]}*{d.system.qdot[k]}" for k in indices)
    names = formulas.text(*d.cyclic_coordinates)
    yield Paragraph(
        f"The momenta {formulas.text(*momenta)} of the cyclic coordinates are constant. The "
        "Routhian is the Lagrangian of the other coordinates."
        if len(momenta) > 1
        else f"The momentum {formulas.text(*momenta)} of the cyclic coordinate {names} is "
        "constant. The Routhian is the Lagrangian of the other coordinates."
    )
    yield formulas.equation(R, f"{L}{work}", value=d.routhian)
    others = [k for k in range(len(d.system.q)) if k not in indices]
    if not formulas.are_readable(d.routh_equations):
        return
    yield Paragraph("Lagrange's equations of the Routhian have constant momenta.")
    for k, residual in zip(others, d.routh_equations, strict=True):
        q, v = d.system.q[k], d.system.qdot[k]
        force = formulas.notation.force(k)
        left = f"ddt(d({R}, {v})) - d({R}, {q})" + (f" - {force}" if force else "")
        yield formulas.equation(left, value=residual, after=("0",))
