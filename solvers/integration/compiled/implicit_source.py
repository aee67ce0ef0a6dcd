"""The part of a C program that makes steps of an implicit method by Newton's iteration."""

from collections.abc import Iterable, Mapping

import numpy as np

from solvers.runge_kutta.blocks import Blocks
from solvers.runge_kutta.lagrange import lagrange, lagrange_factors
from solvers.runge_kutta.order_conditions import Number
from solvers.runge_kutta.step_control import tolerance_power
from solvers.runge_kutta.tableau import Tableau

#: One of `METHODS`, a structure in ``coefficients.h``.
COEFFICIENTS = """\
{{ /* {title} */
    {stages}, {blocks}, {{{sizes}}},
    {A},
    {T},
    {inverse},
    {M},
    {b},
    {c},
    {lagrange},
    {at_start},
    {error_power},
}},"""

IMPLICIT = """\
enum {{ METHOD_COUNT = {count}, FACTORS = {squares}*DIM*DIM }};
{coefficients_h}
static const Method METHODS[] = {{
{methods}
}};
{order_choice_h}
{linear_h}
{linearisation_h}
{simplified_newton_h}
{predictor_h}
{full_newton_h}
{newton_h}
{implicit_h}"""

#: Handwritten files of implicit methods.
IMPLICIT_FILES = (
    *("coefficients", "order_choice", "linear", "linearisation", "simplified_newton"),
    *("predictor", "full_newton", "newton", "implicit"),
)


def implicit(tableau: Tableau, files: Mapping[str, str]) -> str:
    """The text of an implicit method, with the texts of `IMPLICIT_FILES` by name."""
    sizes = Blocks.of(np.array(tableau.A, float)).sizes
    return IMPLICIT.format(
        count=len(tableau.members),
        squares=sum(size**2 for size in sizes),
        methods="\n".join(map(_coefficients, tableau.members)),
        **{f"{name}_h": files[name] for name in IMPLICIT_FILES},
    )


def _coefficients(tableau: Tableau) -> str:
    A, c = np.array(tableau.A, float), np.array(tableau.c, float)
    blocks = Blocks.of(A)
    matrices = {"A": A, "T": blocks.T, "inverse": blocks.inverse, "M": blocks.M}
    vectors = {
        "b": tableau.b,
        "c": tableau.c,
        "lagrange": lagrange_factors(c),
        "at_start": lagrange(c, np.zeros(1))[0],
    }
    return COEFFICIENTS.format(
        title=tableau.title,
        stages=tableau.stages,
        blocks=len(blocks.sizes),
        sizes=", ".join(map(str, blocks.sizes)),
        error_power=real(tolerance_power(tableau.stages)),
        **{name: f"{{{', '.join(map(row, rows))}}}" for name, rows in matrices.items()},
        **{name: row(numbers) for name, numbers in vectors.items()},
    )


def real(number: Number) -> str:
    """A number of double precision, in brackets."""
    return f"({float(number)!r})"


def row(numbers: Iterable[Number]) -> str:
    """Numbers as the initial values of an array."""
    return f"{{{', '.join(map(real, numbers))}}}"
