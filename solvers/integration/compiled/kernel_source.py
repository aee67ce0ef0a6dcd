"""The C program that integrates one form of a module's equations with one method.

It consists of the module's generated header, the method's stages written out from its
tableau, and the handwritten files in the folder ``c``.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from solvers.integration.compiled.implicit_source import IMPLICIT_FILES, implicit
from solvers.integration.compiled.layout import MAX_EVENTS, SOURCES, declarations
from solvers.integration.compiled.literals import real, row
from solvers.integration.problem import SHORTEST
from solvers.runge_kutta.continuous_extension import ContinuousExtension, elevated
from solvers.runge_kutta.order_conditions import Number
from solvers.runge_kutta.parallel_stages import (
    error_power,
    legendre_matrix,
    symplectic_ratios,
)
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

EQUATIONS = """\
#define HOLONOMIC_REAL real
{signs}{header}
#define {smooth}RHS {rhs}
#define {smooth}JACOBIAN {jacobian}
#define HAS_SWITCHES {has_switches}
"""

#: Definitions for equations with switching functions.
SLIDING = """\
#define SWITCHING {switching}
#define PERTURBED {perturbed}
#define HAS_JACOBIAN {has_jacobian}
static const int VELOCITY[] = {{{velocities}}}, PERTURBATION[] = {{{perturbations}}};
{sliding_h}"""

#: Switching functions of a state with momenta.
SWITCHING_OF_MOMENTA = """
static void switching_of_momenta(real t, const real *z, const real *params, real *result)
{{
    real y[{state}];
    {system}_lagrangian_state(t, z, params, y);
    {system}_switches(t, y, params, result);
}}
"""

CONSTANTS = """\
/* {title} */
#define VARIES_ORDER {varies_order}
enum {{ STAGES = {stages}, IS_FSAL = {is_fsal}, IS_EXPLICIT = {is_explicit} }};
enum {{ ESTIMATES = {estimates}, ERROR_ORDER = {error_order} }};
enum {{ ENDS = {ends}, LEAST_SAMPLES = {least_samples} }};
"""

METHOD = """\
{solution}

{sums}

{sequential_h}"""

#: Equations of one motion, whose stages are evaluated in the lanes of a vector.
STAGE_VECTORS = """\
typedef double stage_vector __attribute__((vector_size(8*STAGES)));
typedef int64_t stage_mask __attribute__((vector_size(8*STAGES)));
#define HOLONOMIC_REAL {real}
{header}
{rhs_h}
"""

VECTOR_RHS = """\
static inline void stage_derivatives(
    stage_vector t, const stage_vector *z, const stage_vector *params, stage_vector *k)
{{
    {rhs}(t, z, params, k);
}}

static void RHS(double t, const double *z, const double *params, double *derivative)
{{
    stage_vector all_params[{parameters} + 1], all_z[{state}], k[{state}];
    for (int p = 0; p < {parameters}; p++) {{
        all_params[p] = (stage_vector){{0}} + params[p];
    }}
    for (int n = 0; n < {state}; n++) {{
        all_z[n] = (stage_vector){{0}} + z[n];
    }}
    {rhs}((stage_vector){{0}} + t, all_z, all_params, k);
    for (int n = 0; n < {state}; n++) {{
        derivative[n] = k[n][0];
    }}
}}
"""

#: The right-hand side calls functions of the mathematical library.
SCALAR_RHS = """\
#define RHS {rhs}
static void stage_derivatives(
    stage_vector t, const stage_vector *z, const stage_vector *params, stage_vector *k)
{{
    double numbers[{parameters} + 1], state[{state}], derivative[{state}];
    for (int p = 0; p < {parameters}; p++) {{
        numbers[p] = params[p][0];
    }}
    for (int i = 0; i < STAGES; i++) {{
        for (int n = 0; n < {state}; n++) {{
            state[n] = z[n][i];
        }}
        RHS(t[i], state, numbers, derivative);
        for (int n = 0; n < {state}; n++) {{
            k[n][i] = derivative[n];
        }}
    }}
}}
"""

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
#: others. Each method of a family has a natural extension.
EXTENSION = """\
enum {{ DEGREE = {degree}, ROUNDS = {rounds}, EXTENSION_NODES = {nodes} }};
static const int STAGES_OF[] = {{{stages}}};
static const double NATURAL[][STAGES + ENDS][DEGREE + 1] = {{
{natural}
}};
static const double EXTENSION_C[EXTENSION_NODES] = {{{c}}};
static const double FIRST[EXTENSION_NODES][STAGES] = {{
{first}
}};
static const double INTEGRALS[EXTENSION_NODES][EXTENSION_NODES] = {{
{integrals}
}};
static const double EXTENDED[EXTENSION_NODES][EXTENSION_NODES + 1] = {{
{extended}
}};
{extension_h}
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

STAGE = """\
    for (int n = 0; n < DIM; n++) {{
        stage[n] = z[n] + {sum};
    }}
    RHS(t + h*{c}, stage, params, k[{i}]);
"""


@dataclass(frozen=True)
class Equations:
    """One form of a system's equations in C; `state`, `parameters` and `ordinary` are sizes."""

    header: str  # text of the generated header
    rhs: str  # names of the right-hand side and its Jacobian, which not every form has
    jacobian: str
    state: int
    parameters: int
    ordinary: int
    angles: Sequence[tuple[int, int]]  # indices of the sine, before the cosine, and the velocity
    from_ordinary: Sequence[str]  # statements: state z and turns from the ordinary state y
    to_ordinary: Sequence[str]  # and y from these
    vectorises: bool  # the right-hand side calls no function of the mathematical library
    perturbed: Sequence[tuple[int, int]]  # indices of each velocity and its perturbation
    switches: int = 0  # switching functions, whose signs are held after the parameters

    @property
    def switching(self) -> str:
        """The name of the function of switching functions and their rates."""
        system, _, form = self.rhs.partition("_rhs")
        return "switching_of_momenta" if form == "_hamiltonian" else f"{system}_switches{form}"

    @property
    def switching_of_momenta(self) -> str:
        """Its definition, if the state contains momenta."""
        system, _, form = self.rhs.partition("_rhs")
        if not self.switches or form != "_hamiltonian":
            return ""
        return SWITCHING_OF_MOMENTA.format(system=system, state=self.state)

    def sizes(self, tableau: Tableau, *, compensated: bool, variations: int) -> dict[str, int]:
        """Numbers of components of the arrays in ``layout.h``."""
        return {
            "DIM": self.state,
            "LOW_DIM": compensated * self.state,
            "FSAL_DIM": tableau.is_fsal * self.state,
            "ANGLES": len(self.angles),
            "PARAMETERS": self.parameters + 2 * self.switches,
            "SWITCHES": self.switches,
            "POLYNOMIAL_DIM": (not tableau.is_explicit) * tableau.stages * self.state,
            "LENGTHS": int(not tableau.is_explicit),
            "ORIGINS": int(tableau.is_parallel),
            "JACOBIANS": int(tableau.needs_jacobian),
            "JACOBIAN_DIM": tableau.needs_jacobian * self.state,
            "VARIABLE_ORDERS": int(bool(tableau.lower)),
            "VARIATIONS": variations,
            "SCALES": int(variations > 0),
            "MAX_EVENTS": MAX_EVENTS,
        }


def program(
    equations: Equations, tableau: Tableau, *, lanes: bool, compensated: bool, variations: int = 0
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
        single_h=_source("single.h"),
    )
    files = ("lanes.h", "step.h", "motion.h")
    return PROGRAM.format(
        lanes="#define HOLONOMIC_VECTOR" if lanes else "#define ONE_LANE",
        functions=_source("lane_functions.h") if lanes else "",
        constants=_constants(tableau),
        equations=_equations(equations, tableau),
        layout=declarations(sizes),
        sine=", ".join(map(str, sines)),
        rate=", ".join(map(str, rates)),
        compensated=int(compensated),
        method=_method(tableau),
        sliding=_sliding(equations, tableau),
        switching=_source("switching.h") if equations.switches else "",
        extension=_extension(tableau),
        loop="\n".join(map(_source, LOOP_FILES)),
        single="" if lanes else single,
        **{name.replace(".", "_"): _source(name) for name in files},
    )


def _source(name: str) -> str:
    return (SOURCES / name).read_text(encoding="utf-8")


def _constants(tableau: Tableau) -> str:
    return CONSTANTS.format(
        title=tableau.title,
        varies_order=int(bool(tableau.lower)),
        stages=tableau.stages,
        is_fsal=int(tableau.is_fsal),
        is_explicit=int(tableau.is_explicit),
        ends=2 * tableau.needs_jacobian,
        estimates=len(tableau.error_weights),
        error_order=tableau.error_order,
        least_samples=ContinuousExtension.of(tableau).least_samples,
    )


def _equations(equations: Equations, tableau: Tableau) -> str:
    if not tableau.is_parallel:
        return EQUATIONS.format(
            jacobian=equations.jacobian,
            signs="#define HOLONOMIC_SIGNS\n" if equations.switches else "",
            smooth="SMOOTH_" if equations.switches else "",
            has_switches=int(equations.switches > 0),
            rhs=equations.rhs,
            header=equations.header + equations.switching_of_momenta,
        )
    # functions that convert states of a single motion take numbers, not vectors
    converts = any("_state(" in line for line in equations.from_ordinary)
    vectors = equations.vectorises and not converts
    text = VECTOR_RHS if vectors else SCALAR_RHS
    real = "stage_vector\n#define HOLONOMIC_VECTOR" if vectors else "double"
    sizes = {"state": equations.state, "parameters": equations.parameters}
    return STAGE_VECTORS.format(
        real=real,
        header=equations.header,
        rhs_h=text.format(rhs=equations.rhs, **sizes),
    )


def _sliding(equations: Equations, tableau: Tableau) -> str:
    if not equations.switches:
        return ""
    velocities, perturbations = zip(*equations.perturbed or [(0, 0)], strict=True)
    return SLIDING.format(
        switching=equations.switching,
        perturbed=len(equations.perturbed),
        has_jacobian=int(tableau.needs_jacobian),
        velocities=", ".join(map(str, velocities)),
        perturbations=", ".join(map(str, perturbations)),
        sliding_h=_source("sliding.h"),
    )


def _parallel(tableau: Tableau) -> str:
    """Matrices by their columns."""
    ratios, legendre = symplectic_ratios(tableau), legendre_matrix(tableau)
    return PARALLEL.format(
        nodes=", ".join(map(real, tableau.c)),
        weights=", ".join(map(real, tableau.b)),
        error_power=real(error_power(tableau.stages)),
        files="\n".join(map(_source, PARALLEL_FILES)),
        ratios=_rows(ratios.T),
        legendre=_rows(legendre.T),
    )


def _extension(tableau: Tableau) -> str:
    extension, members = ContinuousExtension.of(tableau), tableau.members
    degree = max(len(extension.natural) - 1, 3)  # as that of switching functions
    extensions = [ContinuousExtension.of(member) for member in members]
    ends = 2 * tableau.needs_jacobian
    naturals = [one.with_ends if ends else elevated(one.natural, degree) for one in extensions]
    naturals = [elevated(natural, degree) for natural in naturals]
    return EXTENSION.format(
        degree=degree,
        stages=", ".join(str(member.stages + ends) for member in members),
        rounds=extension.rounds,
        nodes=len(extension.nodes),
        natural=",\n".join(f"{{{_rows(natural.T)}}}" for natural in naturals),
        c=", ".join(map(real, extension.nodes)),
        first=_rows(extension.first),
        integrals=_rows(extension.integrals),
        extended=_rows(extension.extended.T),
        extension_h=_source("extension.h"),
        roots_h=_source("roots.h"),
    )


def _explicit(tableau: Tableau) -> str:
    rows = [
        STAGE.format(sum=_sum(weights), c=real(c), i=i)
        for i, (weights, c) in enumerate(zip(tableau.A, tableau.c, strict=True))
        if i
    ]
    return EXPLICIT.format(rows="".join(rows))


def _method(tableau: Tableau) -> str:
    if tableau.is_parallel:
        return _parallel(tableau)
    if not tableau.is_explicit:
        files = {name: _source(f"{name}.h") for name in IMPLICIT_FILES}
        return implicit(tableau, files)
    first, second, *_ = *tableau.error_weights, (), ()
    sums = {"increment": tableau.b, "estimate": first, "second_estimate": second}
    return METHOD.format(
        sequential_h=_source("sequential.h"),
        solution=_explicit(tableau),
        sums="\n".join(WEIGHTED_SUM.format(name=name, sum=_sum(w)) for name, w in sums.items()),
    )


def _rows(matrix: Iterable[Iterable[Number]]) -> str:
    return ",\n".join(f"    {row(numbers)}" for numbers in matrix)


def _sum(weights: Sequence[Number]) -> str:
    """Σ h w k, with all products but the last one independent of the last stage."""
    terms = [f"(h*{real(w)})*k[{j}][n]" for j, w in enumerate(weights) if w != 0]
    return "\n            + ".join(terms) or "0.0*h"
