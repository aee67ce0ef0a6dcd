"""The C program that integrates one form of a module's equations with one method.

It consists of the module's generated header, the method's stages written out from its
tableau, and the handwritten files in the folder ``c``.
"""

from solvers.integration.compiled.equations_source import (
    EquationsSource,
    equations_text,
    projection_text,
    sliding_text,
)
from solvers.integration.compiled.memory_layout import declarations, source
from solvers.integration.compiled.method_source import constants_text, extension_text, method_text
from solvers.integration.problem.problem import SHORTEST
from solvers.runge_kutta.tableau import Tableau

PROGRAM = """\
#include <float.h>
#include <stddef.h>
#include <string.h>
#include <time.h>
{lanes}
{lanes_h}
{functions}
{constants}
{equations}
{layout}
static const int SINE[] = {{{sine}}}, RATE[] = {{{rate}}};
{sliding}
#define COMPENSATED {compensated}
{step_h}
{projection}
{method}
{motion_h}
{switching}
{extension}
{loop}
{single}"""

#: Handwritten files of the loop over steps, in their order.
LOOP_FILES = (
    *("within_step.h", "brackets.h", "substeps.h", "motions.h", "event_brackets.h"),
    *("cubic.h", "process_step.h", "finish_step.h", "advance.h", "integrator.c", "probe.h"),
)

#: Conversion between ordinary states and those of the form, for single motions.
SINGLE = """\
enum {{ ORDINARY = {ordinary}, MIN_H_ULPS = {shortest} }};

static void from_ordinary(
    double t, const double *y, double *z, double *turns, const double *params)
{{
{from_ordinary}
    (void)t; (void)turns; (void)params;
}}

static void to_ordinary(
    double t, const double *z, const double *turns, double *y, const double *params)
{{
{to_ordinary}
    (void)t; (void)turns; (void)params;
}}
{single_h}
"""


def program(
    equations: EquationsSource,
    tableau: Tableau,
    *,
    lanes: bool,
    compensated: bool,
    variations: int = 0,
) -> str:
    """The text of the C99 program, with the functions ``run`` and, without lanes, ``single``.

    With lanes it integrates many motions at once, by explicit methods only. If `compensated`, it
    carries the rounding errors of the state along. The last `variations` components of the state
    are a variation, out of which powers of two are taken where it is large.
    """
    sines, rates = ([pair[part] for pair in equations.angles] or [0] for part in (0, 1))
    sizes = equations.sizes(tableau, compensated=compensated, variations=variations)
    single = SINGLE.format(
        ordinary=equations.ordinary,
        shortest=SHORTEST,
        from_ordinary="\n".join(f"    {line}" for line in equations.from_ordinary),
        to_ordinary="\n".join(f"    {line}" for line in equations.to_ordinary),
        single_h=source("single.h"),
    )
    files = ("lanes.h", "step.h", "motion.h")
    return PROGRAM.format(
        lanes="#define HOLONOMIC_VECTOR" if lanes else "#define ONE_LANE",
        functions=source("lane_functions.h") if lanes else "",
        constants=constants_text(tableau),
        equations=equations_text(equations, tableau),
        layout=declarations(sizes),
        sine=", ".join(map(str, sines)),
        rate=", ".join(map(str, rates)),
        compensated=int(compensated),
        method=method_text(tableau),
        sliding=sliding_text(equations, tableau),
        projection=projection_text(equations, tableau),
        switching=source("switching.h") if equations.switches else "",
        extension=extension_text(tableau),
        loop="\n".join(map(source, LOOP_FILES)),
        single="" if lanes else single,
        **{name.replace(".", "_"): source(name) for name in files},
    )
