"""Sections on motions: Lagrange's equations, accelerations, energy, Hamilton's and Routh's."""

from collections.abc import Iterator
from functools import lru_cache

import sympy as sp

from derive.formulas.functions import derivative
from derive.handout.derived_letters import names_of, words
from derive.handout.document_model import Block, Paragraph
from derive.handout.numbering import Numbering, tidied
from derive.mechanics.derivation import Derivation
from derive.mechanics.energies.reduction import reduced
from derive.system.parts import SystemDefinitionError
from derive.system.symbols import TIME

#: Coordinates of the largest systems whose mass matrix, any or a diagonal one, is inverted.
LARGEST_INVERSE, LARGEST_DIAGONAL = 2, 7


def lagrangian(d: Derivation, formulas: Numbering) -> Iterator[Block]:
    """The Lagrangian and the momenta."""
    T, V, L = map(formulas.notation.letter, "TVL")
    yield Paragraph("The Lagrangian is the kinetic minus the potential energy.")
    yield formulas.equation(L, f"{T} - {V}", value=d.lagrangian)
    yield Paragraph("Its derivatives with respect to the velocities are the momenta.")
    for p, qdot, value in zip(d.system.p, d.system.qdot, d.momenta, strict=True):
        yield formulas.equation(p.name, f"d({L}, {qdot})", value=value)


def euler_lagrange(d: Derivation, formulas: Numbering) -> Iterator[Block]:
    """For each coordinate the rate of the momentum, the derivative of L, and the equation."""
    L, state = formulas.notation.letter("L"), (*d.system.q, *d.system.qdot, *d.system.qddot)
    residuals = _residuals(d)
    for i, (q, qdot) in enumerate(zip(d.system.q, d.system.qdot, strict=True)):
        rate, slope = f"ddt(d({L}, {qdot}))", f"d({L}, {q})"
        change, gradient = _time_derivative(d, d.momenta[i]), derivative(d.lagrangian, q)
        force = formulas.notation.force(i)
        yield Paragraph(
            f"Coordinate `{q}`: the rate of the momentum, the derivative of the Lagrangian, and "
            "the equation."
        )
        yield formulas.equation(rate, value=tidied(change, *state))
        yield formulas.equation(slope, value=tidied(gradient, *state))
        reaction = formulas.notation.reaction(i)
        left = f"{rate} - {slope}" + (f" - {force}" if force else "") + reaction
        yield formulas.equation(left, value=residuals[i], after=("0",))
        if gradient == 0 and not force and not reaction:
            yield Paragraph(
                f"The Lagrangian does not depend on `{q}`: the momentum `p_{q}` is constant."
            )


def accelerations(d: Derivation, formulas: Numbering) -> Iterator[Block]:
    """The equations of motion as linear equations, and their solution if it is readable."""
    M, f = map(formulas.notation.letter, "Mf")
    still = dict.fromkeys((*d.system.qddot, *d.system.multipliers), sp.S.Zero)
    forcing = sp.Matrix([-residual.xreplace(still) for residual in _residuals(d)])
    is_column = len(d.system.q) > 1
    vector = f"{f}_vector" if is_column else f
    matrix = "mass matrix" if is_column else "inertia"
    yield Paragraph(
        f"The equations of motion are linear in the accelerations, with the {matrix} `{M}` and the "
        f"forcing `{vector}`."
    )
    if d.system.conditions:
        yield from _constrained(d, formulas, vector)
    else:
        yield formulas.relation(f"{M}*{names_of(d.system.qddot)}", vector)
    yield from formulas.matrix(M, d.mass_matrix)
    yield from formulas.column(f, forcing)
    if d.system.conditions:
        yield Paragraph("At each state, both linear equations are solved in numbers.")
        return
    solution = _solution(d, forcing) if has_inverse(d) else []
    if solution and formulas.are_readable(solution):
        yield Paragraph("The solution:")
        for symbol, value in zip(d.system.qddot, solution, strict=True):
            yield formulas.equation(symbol.name, value=value)
    else:
        yield Paragraph(
            "The solution is too long to read; at each state, the linear equations are solved in "
            "numbers."
        )


def _constrained(d: Derivation, formulas: Numbering, vector: str) -> Iterator[Block]:
    """The equations of motion with multipliers, and the constraints of accelerations."""
    M, G, T, gamma = map(formulas.notation.letter, ("M", "G", "T", "gamma"))
    accelerations, multipliers = names_of(d.system.qddot), names_of(d.system.multipliers)
    yield formulas.relation(f"{M}*{accelerations}", f"{vector} + {G}**{T}*{multipliers}")
    yield Paragraph(
        f"The constraints, differentiated until accelerations occur, have the matrix `{G}`."
    )
    yield formulas.relation(f"{G}*{accelerations}", f"{gamma}_vector")
    yield from formulas.rows(G, d.constraint_jacobian)
    if d.constraint_forcing.rows > 1:
        yield from formulas.column(gamma, d.constraint_forcing)
    else:
        yield formulas.equation(f"{gamma}_vector", value=d.constraint_forcing)


def energy(d: Derivation, formulas: Numbering) -> Iterator[Block]:
    """The energy and its rate of change."""
    T, V, E = map(formulas.notation.letter, "TVE")
    if TIME in d.variables:
        yield Paragraph(
            "Since positions depend on time, Jacobi's integral takes the place of the sum of "
            "kinetic and potential energy. It is the value of the Hamiltonian."
        )
        yield formulas.equation(E, legendre(d, formulas), value=d.energy)
    else:
        yield Paragraph("The energy is the sum of kinetic and potential energy.")
        yield formulas.equation(E, f"{T} + {V}", value=d.energy)
    moved = zip(d.system.multipliers, d.constraint_drift, strict=True)
    reactions = sp.Add(*(multiplier * drift for multiplier, drift in moved))
    power = tidied(d.power - reactions, *d.system.q, *d.system.qdot)
    if power == 0:
        yield Paragraph("The energy of a motion is constant, because no force changes it.")
    else:
        yield Paragraph(
            "Forces without a potential, and terms that depend on time, change the energy of a "
            "motion at this rate:"
        )
    yield formulas.equation(f"ddt({E})", value=power)


def legendre(d: Derivation, formulas: Numbering) -> str:
    """The sum of momenta times velocities, minus the Lagrangian."""
    pairs = zip(d.system.p, d.system.qdot, strict=True)
    products = " + ".join(f"{p}*{qdot}" for p, qdot in pairs)
    return f"{products} - {formulas.notation.letter('L')}"


def has_inverse(d: Derivation) -> bool:
    """Whether the inverse of the mass matrix is derived as a formula."""
    M = d.mass_matrix
    return bool(M.rows <= (LARGEST_DIAGONAL if M.is_diagonal() else LARGEST_INVERSE))


@lru_cache(maxsize=1)  # two sections use them
def _residuals(d: Derivation) -> list[sp.Expr]:
    """The left sides d/dt ∂L/∂q̇ - ∂L/∂q - Q of the equations of motion."""
    state = (*d.system.q, *d.system.qdot, *d.system.qddot)
    reactions = d.constraint_jacobian.T * sp.Matrix(d.system.multipliers)
    forces = (
        [a + b for a, b in zip(d.system.applied, reactions, strict=True)]
        if reactions
        else d.system.applied
    )
    triples = zip(d.momenta, d.system.q, forces, strict=True)
    return [
        tidied(_time_derivative(d, p) - derivative(d.lagrangian, q) - force, *state)
        for p, q, force in triples
    ]


def _solution(d: Derivation, forcing: sp.MatrixBase) -> list[sp.Expr]:
    """The accelerations M⁻¹ f, by the adjugate of M."""
    determinant = sp.factor_terms(reduced(d.mass_matrix.det()))
    state = (*d.system.q, *d.system.qdot)
    return [
        sp.factor_terms(tidied(entry, *state)) / determinant
        for entry in d.mass_matrix.adjugate() * forcing
    ]


def _time_derivative(d: Derivation, value: sp.Expr) -> sp.Expr:
    """The time derivative of a function of coordinates, velocities and time."""
    symbols = (*d.system.q, *d.system.qdot)
    rates = zip(symbols, (*d.system.qdot, *d.system.qddot), strict=True)
    terms = (derivative(value, symbol) * rate for symbol, rate in rates)
    return sp.Add(derivative(value, TIME), *terms)


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
