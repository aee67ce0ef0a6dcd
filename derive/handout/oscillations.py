"""The section on small oscillations: the equilibrium, the matrices, the normal modes."""

from collections.abc import Iterator
from math import pi, sqrt
from typing import TypeAlias

import sympy as sp

from derive.formulas.numeric import Evaluator, mp
from derive.handout.document_model import Block, HandoutTable, Paragraph
from derive.handout.numbering import Numbering
from derive.mechanics.derivation import Derivation
from derive.mechanics.linearisation.small_oscillations import Linearisation
from derive.system.parts import SystemDefinitionError

#: The squared angular frequency of a normal mode, and its shape.
Mode: TypeAlias = tuple[float, list[float]]

#: Coordinates of the largest systems whose characteristic equation is written out.
LARGEST = 2
#: A squared frequency below this fraction of the largest is 0.
TINY = 1e-12


def oscillations(d: Derivation, formulas: Numbering) -> Iterator[Block]:
    """Small motions about the equilibrium, or the reason why they have no normal modes."""
    try:
        linear = d.linearisation()
        modes = normal_modes(d, linear)
    except SystemDefinitionError as error:
        yield Paragraph(f"There are no normal modes: {str(error).partition(':')[0]}.")
        return
    M, K, u = (formulas.notation.letter(name) for name in ("M_0", "K_0", "u"))
    is_column = len(linear.states) > 1
    vector = f"{u}_vector" if is_column else u
    if any(linear.equilibrium):
        yield Paragraph("The system is in equilibrium at these coordinates.")
        pairs = zip(d.system.q, linear.equilibrium, strict=True)
        rows = tuple((f"`{q}`", formulas.text(value)) for q, value in pairs)
        yield HandoutTable(("coordinate", "value"), rows)
    else:
        yield Paragraph("The system is in equilibrium where all coordinates are zero.")
    if d.system.conditions:
        names = ", ".join(f"`{name}`" for name in linear.states)
        yield Paragraph(
            f"Constraints determine the other small displacements by those of {names}, to which "
            "the matrices below belong."
        )
    kind = "mass and stiffness matrix" if is_column else "inertia and stiffness"
    yield Paragraph(f"Small displacements `{vector}` obey linear equations with constant {kind}.")
    yield formulas.relation(f"{M}*{vector}_ddot + {K}*{vector}", "0")
    yield from formulas.matrix(M, linear.mass_matrix)
    yield from formulas.matrix(K, linear.stiffness_matrix)
    omega = formulas.notation.letter("omega")
    if not is_column:
        yield Paragraph(f"They oscillate with the angular frequency `{omega}`.")
        square = sp.cancel(linear.stiffness_matrix[0] / linear.mass_matrix[0])
        yield formulas.equation(f"{omega}**2", f"{K}/{M}", value=square)
    elif len(linear.states) <= LARGEST:
        yield Paragraph(f"The angular frequency `{omega}` of a normal mode solves this equation.")
        value = _characteristic_polynomial(linear, sp.Symbol(omega, positive=True))
        yield formulas.equation(f"det({K} - {omega}**2*{M})", value=value, after=("0",))
    yield Paragraph("With the default values of the parameters:")
    yield _table(modes, linear, formulas)


def _characteristic_polynomial(linear: Linearisation, omega: sp.Symbol) -> sp.Expr:
    """The determinant of K - ω² M₀, in factors that are polynomials in ω."""
    determinant = (linear.stiffness_matrix - omega**2 * linear.mass_matrix).det()
    factors = (factor.as_base_exp() for factor in sp.Mul.make_args(sp.factor(determinant)))
    return sp.Mul(*(sp.collect(sp.expand(b), omega, sp.factor) ** n for b, n in factors))


def _table(modes: list[Mode], linear: Linearisation, formulas: Numbering) -> HandoutTable:
    """Frequencies, periods and shapes of the normal modes; a mode that grows has no period."""
    omega = formulas.notation.letter("omega")
    rows = []
    for square, shape in modes:
        frequency = f"{sqrt(square):.4g}" if square > 0 else "none"
        period = f"{2 * pi / sqrt(square):.4g}" if square > 0 else "none"
        rows.append((f"{square:.4g}", frequency, period, ", ".join(f"{x:.3g}" for x in shape)))
    title = "shape (" + ", ".join(f"`{name}`" for name in linear.states) + ")"
    head = (f"`{omega}**2` in 1/s²", f"`{omega}` in rad/s", "period in s", title)
    return HandoutTable(head, tuple(rows))


def normal_modes(d: Derivation, linear: Linearisation) -> list[Mode]:
    """The normal modes with the default values, the lowest frequency first.

    A `SystemDefinitionError` reports a mass matrix that is not positive definite.
    """
    values = {p.symbol: sp.Rational(str(p.default)) for p in d.system.parameters}
    n = len(linear.states)

    def numbers(matrix: sp.MatrixBase) -> mp.matrix:
        at_defaults = Evaluator(values)
        return mp.matrix([[at_defaults(entry).number for entry in row] for row in matrix.tolist()])

    # with M = C Cᵀ, the modes are those of the symmetric matrix C⁻¹ K C⁻ᵀ
    try:
        inverse = mp.inverse(mp.cholesky(numbers(linear.mass_matrix)))
    except ValueError:
        reason = "at the equilibrium, the mass matrix is not positive definite"
        raise SystemDefinitionError(reason) from None
    squares, vectors = mp.eigsy(inverse * numbers(linear.stiffness_matrix) * inverse.T)
    shapes = inverse.T * vectors
    largest = max(map(abs, squares))
    modes: list[Mode] = []
    for k in range(n):
        column = [shapes[i, k] for i in range(n)]
        size = max(column, key=abs)
        square = 0.0 if abs(squares[k]) <= TINY * largest else float(squares[k])
        modes.append((square, [float(x / size) for x in column]))
    return modes
