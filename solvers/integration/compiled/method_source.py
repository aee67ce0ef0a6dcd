"""A method in a C program: its stages, written out from the tableau, and continuous extension.

Steps of implicit methods are solved by Newton's iteration.
"""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from solvers.integration.compiled.memory_layout import source
from solvers.runge_kutta.collocation import lagrange, lagrange_factors
from solvers.runge_kutta.continuous_extension import ContinuousExtension, elevated
from solvers.runge_kutta.newton_stages import Blocks
from solvers.runge_kutta.order_conditions import Number
from solvers.runge_kutta.parallel_stages import (
    error_power,
    legendre_matrix,
    symplectic_ratios,
)
from solvers.runge_kutta.step_control import tolerance_power
from solvers.runge_kutta.tableau import Splitting, Tableau

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


CONSTANTS = """\
/* {title} */
#define VARIES_ORDER {varies_order}
enum {{ STAGES = {stages}, IS_FSAL = {is_fsal}, IS_EXPLICIT = {is_explicit} }};
enum {{ IS_SPLITTING = {is_splitting} }};
enum {{ ESTIMATES = {estimates}, ERROR_ORDER = {error_order} }};
enum {{ ENDS = {ends}, LEAST_SAMPLES = {least_samples} }};
"""

METHOD = """\
{solution}

{sums}

{sequential_h}"""

PARALLEL = """\
static const stage_vector RATIOS[STAGES] = {{
{ratios}
}}, LEGENDRE[STAGES] = {{
{legendre}
}};
static const stage_vector NODES = {{{nodes}}}, WEIGHTS = {{{weights}}};
static const double ERROR_POWER = {error_power};
{files}"""

PARALLEL_FILES = ("stage_vectors.h", "parallel_stages.h", "parallel.h")

#: Matrices of the continuous extension: columns of the first and last, rows of
#: others. Each method of a family has a natural extension, and each half of a splitting's state.
EXTENSION = """\
enum {{ DEGREE = {degree}, ROUNDS = {rounds}, EXTENSION_NODES = {nodes} }};
static const int STAGES_OF[] = {{{stages}}};
static const double NATURAL[][STAGES + ENDS][DEGREE + 1] = {{
{natural}
}};
static const double EXTENSION_C[EXTENSION_NODES] = {{{c}}};
static const double FIRST[][EXTENSION_NODES][STAGES] = {{
{first}
}};
static const double INTEGRALS[EXTENSION_NODES][EXTENSION_NODES] = {{
{integrals}
}};
static const double EXTENDED[EXTENSION_NODES][EXTENSION_NODES + 1] = {{
{extended}
}};
{event_polynomials_h}
{roots_h}"""

WEIGHTED_SUM = """\
static inline real {name}(real h, real (*k)[DIM], int n)
{{
    return {sum};
}}
"""

EXPLICIT = """\
static inline void stages(
    real t, const real *z, real h, real (*k)[DIM], const real *params)
{{
    real stage[DIM];
{rows}    (void)t; (void)z; (void)h; (void)stage; (void)k; (void)params;
}}"""

SPLITTING = """\
static const double KICKS[STAGES] = {kicks}, DRIFTS[STAGES] = {drifts};
static const double NODES[STAGES] = {nodes};
{splitting_h}"""

STAGE = """\
    for (int n = 0; n < DIM; n++) {{
        stage[n] = z[n] + {sum};
    }}
    RHS(t + h*{c}, stage, params, k[{i}]);
"""


def constants_text(tableau: Tableau) -> str:
    """Numbers of stages and orders."""
    return CONSTANTS.format(
        title=tableau.title,
        varies_order=int(bool(tableau.lower)),
        stages=tableau.stages,
        is_fsal=int(tableau.is_fsal),
        is_explicit=int(tableau.is_explicit),
        is_splitting=int(tableau.is_splitting),
        ends=2 * tableau.needs_jacobian,
        estimates=len(tableau.error_weights),
        error_order=tableau.error_order,
        least_samples=ContinuousExtension.of(tableau).least_samples,
    )


def method_text(tableau: Tableau) -> str:
    """The stages and the step."""
    if tableau.is_parallel:
        return _parallel(tableau)
    if not tableau.is_explicit:
        files = {name: source(f"{name}.h") for name in IMPLICIT_FILES}
        return implicit(tableau, files)
    first, second, *_ = *tableau.error_weights, (), ()
    sums = {"estimate": first, "second_estimate": second}
    if isinstance(tableau, Splitting):
        solution = _splitting(tableau)
    else:
        solution, sums = _explicit(tableau), {"increment": tableau.b, **sums}
    return METHOD.format(
        sequential_h=source("sequential.h"),
        solution=solution,
        sums="\n".join(WEIGHTED_SUM.format(name=name, sum=_sum(w)) for name, w in sums.items()),
    )


def _explicit(tableau: Tableau) -> str:
    rows = [
        STAGE.format(sum=_sum(weights), c=real(c), i=i)
        for i, (weights, c) in enumerate(zip(tableau.A, tableau.c, strict=True))
        if i
    ]
    return EXPLICIT.format(rows="".join(rows))


def _splitting(tableau: Splitting) -> str:
    return SPLITTING.format(
        kicks=row(tableau.b),
        drifts=row(tableau.drifts),
        nodes=row(tableau.c),
        splitting_h=source("splitting.h"),
    )


def _parallel(tableau: Tableau) -> str:
    """Matrices by their columns."""
    ratios, legendre = symplectic_ratios(tableau), legendre_matrix(tableau)
    return PARALLEL.format(
        nodes=", ".join(map(real, tableau.c)),
        weights=", ".join(map(real, tableau.b)),
        error_power=real(error_power(tableau.stages)),
        files="\n".join(map(source, PARALLEL_FILES)),
        ratios=_rows(ratios.T),
        legendre=_rows(legendre.T),
    )


def extension_text(tableau: Tableau) -> str:
    """The continuous extension of a step."""
    extension, members = ContinuousExtension.of(tableau), tableau.members
    degree = max(len(extension.naturals[0]) - 1, 3)  # as that of switching functions
    extensions = [ContinuousExtension.of(member) for member in members]
    ends = 2 * tableau.needs_jacobian
    naturals = [
        (member.stages + ends, elevated(natural, degree))
        for member, one in zip(members, extensions, strict=True)
        for natural in ((one.with_ends,) if ends else one.naturals)
    ]
    return EXTENSION.format(
        degree=degree,
        stages=", ".join(str(stages) for stages, _ in naturals),
        rounds=extension.rounds,
        nodes=len(extension.nodes),
        natural=",\n".join(f"{{{_rows(natural.T)}}}" for _, natural in naturals),
        c=", ".join(map(real, extension.nodes)),
        first=",\n".join(f"{{{_rows(first)}}}" for first in extension.firsts),
        integrals=_rows(extension.integrals),
        extended=_rows(extension.extended.T),
        event_polynomials_h=source("event_polynomials.h"),
        roots_h=source("roots.h"),
    )


def _rows(matrix: Iterable[Iterable[Number]]) -> str:
    return ",\n".join(f"    {row(numbers)}" for numbers in matrix)


def _sum(weights: Sequence[Number]) -> str:
    """Σ h w k, with all products but the last one independent of the last stage."""
    terms = [f"(h*{real(w)})*k[{j}][n]" for j, w in enumerate(weights) if w != 0]
    return "\n            + ".join(terms) or "0.0*h"
