"""The equations of a system in a C program."""

from collections.abc import Sequence
from dataclasses import dataclass

from solvers.equations.projection import CORRECTIONS
from solvers.integration.compiled.memory_layout import MAX_EVENTS, source
from solvers.runge_kutta.tableau import Tableau

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


PROJECTION = """\
enum {{ CORRECTIONS = {corrections} }};

/* Turn an angle by a small change. */
static inline void turn(State *state, int sine, real change)
{{
    const real s = state->z[sine], c = state->z[sine + 1];
    add_to_component(state, sine, c*change);
    add_to_component(state, sine + 1, -s*change);
}}

static inline void correct(State *state, const real *params)
{{
{correct}
    (void)state; (void)params;
}}

/* Values of integrals, which are parameters from FIRST_KEPT on. */
enum {{ KEPT = {integrals}, FIRST_KEPT = {first} }};

static inline void evaluate_integrals(const State *state, const real *params, real *values)
{{
{evaluate}
    (void)state; (void)params; (void)values;
}}
{projection_h}"""

CORRECT = """\
    real change[{changes}];
    {name}(state->t, state->z, params, change);
{lines}"""

EVALUATE = "    {name}(state->t, state->z, params + {shift}, values);"

#: The same where the functions of the header take vectors.
VECTORS = """\
    stage_vector all_params[{parameters} + 1], z[{state}], all[{results}];
    for (int p = 0; p < {parameters}; p++) {{
        all_params[p] = (stage_vector){{0}} + params[p];
    }}
    for (int n = 0; n < {state}; n++) {{
        z[n] = (stage_vector){{0}} + state->z[n];
    }}
    {name}((stage_vector){{0}} + state->t, z, all_params + {shift}, all);
"""

VECTOR_CORRECT = """\
{vectors}    double change[{changes}];
    for (int n = 0; n < {changes}; n++) {{
        change[n] = all[n][0];
    }}
{lines}"""

VECTOR_EVALUATE = """\
{vectors}    for (int n = 0; n < KEPT; n++) {{
        values[n] = all[n][0];
    }}"""

#: Switching functions of a state with momenta.
SWITCHING_OF_MOMENTA = """
static void switching_of_momenta(real t, const real *z, const real *params, real *result)
{{
    real y[{state}];
    {system}_lagrangian_state(t, z, params, y);
    {system}_switches(t, y, params, result);
}}
"""

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


@dataclass(frozen=True)
class EquationsSource:
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
    switches: int = 0  # switching functions, whose signs are held after the parameters
    perturbed: Sequence[tuple[int, int]] = ()  # indices of each velocity and its perturbation
    correction: str = ""  # name of the function that removes residuals of constraints
    corrected: Sequence[str] = ()  # statements that add its `change`s to a state
    integrals: str = ""  # name of the function of which motions keep the values
    kept: int = 0  # number of these values, the last of the parameters
    perturbed_parameters: int = 0  # number of perturbations before the parameters

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


def equations_text(equations: EquationsSource, tableau: Tableau) -> str:
    """The right-hand side, in numbers or in vectors of stages."""
    if not tableau.is_parallel:
        return EQUATIONS.format(
            jacobian=equations.jacobian,
            signs="#define HOLONOMIC_SIGNS\n" if equations.switches else "",
            smooth="SMOOTH_" if equations.switches else "",
            has_switches=int(equations.switches > 0),
            rhs=equations.rhs,
            header=equations.header + equations.switching_of_momenta,
        )
    vectors = _takes_stage_vectors(equations)
    text = VECTOR_RHS if vectors else SCALAR_RHS
    real = "stage_vector\n#define HOLONOMIC_VECTOR" if vectors else "double"
    sizes = {"state": equations.state, "parameters": equations.parameters}
    return STAGE_VECTORS.format(
        real=real,
        header=equations.header,
        rhs_h=text.format(rhs=equations.rhs, **sizes),
    )


def _takes_stage_vectors(equations: EquationsSource) -> bool:
    # functions that convert states of a single motion take numbers, not vectors
    converts = any("_state(" in line for line in equations.from_ordinary)
    return equations.vectorises and not converts


def projection_text(equations: EquationsSource, tableau: Tableau) -> str:
    """The functions by which states are moved onto the constraints."""
    is_vector = tableau.is_parallel and _takes_stage_vectors(equations)
    correct = evaluate = ""
    if equations.correction:
        name, changes = equations.correction, len(equations.corrected)
        correct = (VECTOR_CORRECT if is_vector else CORRECT).format(
            name=name,
            changes=changes,
            lines="\n".join(f"    {line}" for line in equations.corrected),
            vectors=_vectors(equations, name, changes),
        )
    if equations.integrals:
        name, shift = equations.integrals, equations.perturbed_parameters
        evaluate = (VECTOR_EVALUATE if is_vector else EVALUATE).format(
            name=name, shift=shift, vectors=_vectors(equations, name, equations.kept, shift)
        )
    return PROJECTION.format(
        corrections=CORRECTIONS if correct else 0,
        correct=correct,
        evaluate=evaluate,
        integrals=equations.kept,
        first=equations.parameters - equations.kept,
        projection_h=source("projection.h"),
    )


def _vectors(equations: EquationsSource, name: str, results: int, shift: int = 0) -> str:
    """A call with vectors."""
    sizes = {"state": equations.state, "parameters": equations.parameters}
    return VECTORS.format(name=name, results=results, shift=shift, **sizes)


def sliding_text(equations: EquationsSource, tableau: Tableau) -> str:
    """The functions by which a motion stays on jumps of forces."""
    if not equations.switches:
        return ""
    velocities, perturbations = zip(*equations.perturbed or [(0, 0)], strict=True)
    return SLIDING.format(
        switching=equations.switching,
        perturbed=len(equations.perturbed),
        has_jacobian=int(tableau.needs_jacobian),
        velocities=", ".join(map(str, velocities)),
        perturbations=", ".join(map(str, perturbations)),
        sliding_h=source("sliding.h"),
    )
