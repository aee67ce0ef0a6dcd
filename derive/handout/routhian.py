"""The section on the Routhian, without cyclic coordinates."""

from collections.abc import Iterator

from derive.handout.document import Block, Paragraph
from derive.handout.numbering import Numbering
from derive.mechanics.derivation import Derivation


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
