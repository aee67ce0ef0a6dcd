"""The C program that integrates one form of a module's equations with one method.

It is put together from the module's generated header, the method's stages written
out from its tableau, and the hand-written files in ``solvers/c``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from importlib.resources import files

from solvers.integration.problem import SHORTEST
from solvers.runge_kutta.order_conditions import Number
from solvers.runge_kutta.tableau import Tableau

#: Folder of the handwritten C files.
SOURCES = files(__package__) / "c"

PROGRAM = """\
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <time.h>
{lanes}
{lanes_h}
#define HOLONOMIC_REAL real
{header}
#define RHS {rhs}
#define JACOBIAN {jacobian}
enum {{ STATE = {state}, PARAMETERS = {parameters}, ANGLES = {angles}, CHANGES = {changes} }};
static const int SINE[] = {{{sine}}}, RATE[] = {{{rate}}};
#define COMPENSATED {compensated}
{method}
{step_h}
{motion_h}
{errand_h}
{integrator_c}
{once}"""

#: Between ordinary states and those of the form, for single motions.
ONCE = """\
enum {{ ORDINARY = {ordinary}, SHORTEST = {shortest} }};

static void enter(
    double t, const double *y, double *z, double *turns, const double *params)
{{
{enter}
    (void)t; (void)turns; (void)params;
}}

static void leave(
    double t, const double *z, const double *turns, double *y, const double *params)
{{
{leave}
    (void)t; (void)turns; (void)params;
}}
{once_h}
"""

METHOD = """\
/* {title} */
enum {{ STAGES = {stages}, IS_FSAL = {is_fsal}, IS_EXPLICIT = {is_explicit} }};
enum {{ ESTIMATES = {estimates}, ERROR_ORDER = {error_order} }};

{solution}

static inline real increment(real h, real (*k)[STATE], int n)
{{
    return {increment};
}}

static inline real estimate(real h, real (*k)[STATE], int n)
{{
    return {estimate};
}}

static inline real second_estimate(real h, real (*k)[STATE], int n)
{{
    return {second_estimate};
}}
"""

EXPLICIT = """\
static inline real stages(
    real t, const real *z, real h, real (*k)[STATE], const real *params)
{{
    real place[STATE];
{rows}    (void)t; (void)z; (void)h; (void)place; (void)k; (void)params;
    return every(1.0);
}}"""

IMPLICIT = """\
static const double A[STAGES][STAGES] = {{
{rows}
}};
static const double C[STAGES] = {{{nodes}}};

{newton_h}"""

STAGE = """\
    for (int n = 0; n < STATE; n++) {{
        place[n] = z[n] + {sum};
    }}
    RHS(t + h*{c}, place, params, k[{i}]);
"""


@dataclass(frozen=True)
class Equations:
    """One form of a system's equations in C.

    Attributes
    ----------
    header : str
        Text of the generated header.
    rhs, jacobian : str
        The right-hand side in it and its Jacobian, which is not there in every form.
    state, parameters : int
        How many numbers it takes.
    ordinary : int
        How many numbers an ordinary state (q, q̇) has.
    angles : sequence of pairs of int
        For every angle that is known by sine and cosine: where in the state its sine
        is, which its cosine follows, and where its velocity is.
    enter, leave : sequence of str
        Statements that compute the state z of this form and the turns of its angles from
        the ordinary state y, and y from these.
    vectorises : bool
        Whether the right-hand side calls no function, so that vectors may be its numbers.
    """

    header: str
    rhs: str
    jacobian: str
    state: int
    parameters: int
    ordinary: int
    angles: Sequence[tuple[int, int]]
    enter: Sequence[str]
    leave: Sequence[str]
    vectorises: bool


def program(
    equations: Equations, tableau: Tableau, *, lanes: bool, compensated: bool, changes: int = 0
) -> str:
    """The text of the program.

    Its functions are ``run``, ``trajectory_size`` and, without lanes, ``once``.

    Parameters
    ----------
    equations : Equations
        What is integrated.
    tableau : Tableau
        The method.
    lanes : bool
        Whether as many motions are integrated at once as fill the processor's vectors;
        explicit methods only.
    compensated : bool
        Whether rounding errors of the state are carried along, as those of time are.
    changes : int
        How many numbers at the end of the state are a small change, out of which powers of
        two are taken where it is large.

    Returns
    -------
    str
        C99, complete, as `solvers.integration.compiled.compiler.build` takes it.
    """
    sines, rates = ([pair[part] for pair in equations.angles] or [0] for part in (0, 1))
    texts = {
        name.replace(".", "_"): (SOURCES / name).read_text(encoding="utf-8")
        for name in ("lanes.h", "step.h", "motion.h", "errand.h", "integrator.c", "once.h")
    }
    once = ONCE.format(
        ordinary=equations.ordinary,
        shortest=SHORTEST,
        enter="\n".join(f"    {line}" for line in equations.enter),
        leave="\n".join(f"    {line}" for line in equations.leave),
        once_h=texts.pop("once_h"),
    )
    return PROGRAM.format(
        lanes="#define HOLONOMIC_VECTOR" if lanes else "#define ONE_LANE",
        header=equations.header,
        rhs=equations.rhs,
        jacobian=equations.jacobian,
        state=equations.state,
        parameters=equations.parameters,
        angles=len(equations.angles),
        changes=changes,
        sine=", ".join(map(str, sines)),
        rate=", ".join(map(str, rates)),
        compensated=int(compensated),
        method=_method(tableau),
        once="" if lanes else once,
        **texts,
    )


def _explicit(tableau: Tableau) -> str:
    rows = [
        STAGE.format(sum=_sum(row), c=_real(c), i=i)
        for i, (row, c) in enumerate(zip(tableau.A, tableau.c, strict=True))
        if i
    ]
    return EXPLICIT.format(rows="".join(rows))


def _implicit(tableau: Tableau) -> str:
    return IMPLICIT.format(
        rows=",\n".join(f"    {{{', '.join(map(_real, row))}}}" for row in tableau.A),
        nodes=", ".join(map(_real, tableau.c)),
        newton_h=(SOURCES / "newton.h").read_text(encoding="utf-8"),
    )


def _method(tableau: Tableau) -> str:
    return METHOD.format(
        title=tableau.title,
        stages=tableau.stages,
        is_fsal=int(tableau.is_fsal),
        error_order=tableau.error_order,
        estimates=len(tableau.error_weights),
        is_explicit=int(tableau.is_explicit),
        solution=_explicit(tableau) if tableau.is_explicit else _implicit(tableau),
        increment=_sum(tableau.b),
        estimate=_sum(tableau.error_weights[0]) if tableau.b_hat else "0.0*h",
        second_estimate=_sum(tableau.error_weights[1]) if tableau.b_low else "0.0*h",
    )


def _sum(weights: Sequence[Number]) -> str:
    """Σ h w k: all but the last product are ready before the last slope is."""
    terms = [f"(h*{_real(w)})*k[{j}][n]" for j, w in enumerate(weights) if w != 0]
    return "\n            + ".join(terms) or "0.0*h"


def _real(number: Number) -> str:
    return f"({float(number)!r})"
