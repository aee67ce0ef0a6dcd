"""The C program that integrates one form of a module's equations with one method.

It is put together from the module's generated header, the method's stages written
out from its tableau, and the hand-written files in ``solvers/c``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from importlib.resources import files

from solvers.order_conditions import Number
from solvers.tableau import Tableau

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
enum {{ STATE = {state}, PARAMETERS = {parameters}, ANGLES = {angles} }};
static const int SINE[] = {{{sine}}}, RATE[] = {{{rate}}};
#define COMPENSATED {compensated}
{method}
{step_h}
{motion_h}
{errand_h}
{integrator_c}
"""

METHOD = """\
/* {title} */
enum {{ STAGES = {stages}, IS_FSAL = {is_fsal}, ERROR_ORDER = {error_order} }};

static inline void stages(
    real t, const real *z, real h, real (*k)[STATE], const real *params)
{{
    real place[STATE];
{rows}    (void)t; (void)z; (void)h; (void)place; (void)k; (void)params;
}}

static inline real increment(real h, real (*k)[STATE], int n)
{{
    return {increment};
}}

static inline real estimate(real h, real (*k)[STATE], int n)
{{
    return {estimate};
}}
"""

STAGE = """\
    for (int n = 0; n < STATE; n++) {{
        place[n] = z[n] + ({sum});
    }}
    RHS(t + h*{c}, place, k[{i}], params);
"""


@dataclass(frozen=True)
class Equations:
    """One form of a system's equations in C.

    Attributes
    ----------
    header : str
        Text of the generated header.
    rhs : str
        The right-hand side in it.
    state, parameters : int
        How many numbers it takes.
    angles : sequence of pairs of int
        For every angle that is known by sine and cosine: where in the state its sine
        is, which its cosine follows, and where its velocity is.
    """

    header: str
    rhs: str
    state: int
    parameters: int
    angles: Sequence[tuple[int, int]]

    @property
    def vectorises(self) -> bool:
        """Whether the right-hand side calls no function, so that vectors may be its numbers."""
        before, _, _ = self.header.partition(f"void {self.rhs}(")
        return before.rfind("#ifndef HOLONOMIC_VECTOR") <= before.rfind("#endif")


def program(equations: Equations, tableau: Tableau, *, lanes: bool, compensated: bool) -> str:
    """The text of the program; its functions are ``run`` and ``trajectory_size``.

    Parameters
    ----------
    equations : Equations
        What is integrated.
    tableau : Tableau
        An explicit method.
    lanes : bool
        Whether as many motions are integrated at once as fill the processor's vectors.
    compensated : bool
        Whether rounding errors of the state are carried along, as those of time are.
    """
    sines, rates = ([pair[part] for pair in equations.angles] or [0] for part in (0, 1))
    folder = files("solvers") / "c"
    return PROGRAM.format(
        lanes="#define HOLONOMIC_VECTOR" if lanes else "#define ONE_LANE",
        header=equations.header,
        rhs=equations.rhs,
        state=equations.state,
        parameters=equations.parameters,
        angles=len(equations.angles),
        sine=", ".join(map(str, sines)),
        rate=", ".join(map(str, rates)),
        compensated=int(compensated),
        method=_method(tableau),
        **{
            name.replace(".", "_"): (folder / name).read_text(encoding="utf-8")
            for name in ("lanes.h", "step.h", "motion.h", "errand.h", "integrator.c")
        },
    )


def _method(tableau: Tableau) -> str:
    rows = [
        STAGE.format(sum=_sum(row), c=_real(c), i=i)
        for i, (row, c) in enumerate(zip(tableau.A, tableau.c, strict=True))
        if i
    ]
    return METHOD.format(
        title=tableau.title,
        stages=tableau.stages,
        is_fsal=int(tableau.is_fsal),
        error_order=min(tableau.order, tableau.embedded_order),
        rows="".join(rows),
        increment=_sum(tableau.b),
        estimate=_sum(tableau.error_weights),
    )


def _sum(weights: Sequence[Number]) -> str:
    """Σ h w k: each product with h is ready before the slope is, which saves a rounding's time."""
    terms = [f"(h*{_real(w)})*k[{j}][n]" for j, w in enumerate(weights) if w != 0]
    return "\n            + ".join(terms) or "0.0*h"


def _real(number: Number) -> str:
    return f"({float(number)!r})"
