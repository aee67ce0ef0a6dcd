/* One step of a collocation method, in one lane, whose stages are evaluated at once, each in a lane
   of a vector.

   Defined before this file, beside that of step.h: the method, by STAGES, RATIOS, NODES, WEIGHTS,
   LEGENDRE and ERROR_POWER; the right-hand side of all stages, stage_derivatives().

   The derivatives of the stages are those of a polynomial over the step. State holds h dz/dt as a
   sum of Legendre polynomials on [0, 1]: component n has the coefficients polynomial[n*STAGES] to
   polynomial[n*STAGES + STAGES - 1], and h is length[0]. */

#define HAS_POLYNOMIAL 1
#define INTERPOLATES 1
enum { TOP = STAGES - 1, MAX_ITERATIONS = 200 };

/* The iteration ends when the next change would be below this part of the tolerance. */
static const double CLOSE = 0.02;
/* Relative rounding errors of the derivatives, below which an iteration may stagnate. */
static const double ROUNDING = 32*DBL_EPSILON;
/* A number that counts as 0, but whose reciprocal has a square. */
static const double SMALLEST = 1e-100;
/* Limits to the change of h; CONTRACTION is the slowest of an iteration that is efficient. */
static const double SAFETY = 0.85, SHRINK = 0.2, GROW = 1.5, CONTRACTION = 0.4;

static inline stage_vector splat_stages(double x) { return (stage_vector){0} + x; }

static inline double sum_of(stage_vector x)
{
    double pairs[STAGES/2], sum = 0;
    for (int i = 0; i < STAGES/2; i++) {
        pairs[i] = x[i] + x[i + STAGES/2];
    }
    for (int i = 0; i < STAGES/4; i++) {
        sum += pairs[i] + pairs[i + STAGES/4];
    }
    return sum;
}

/* A vector for each component, also by its numbers. */
typedef union {
    stage_vector vector[DIM];
    double number[DIM][STAGES];
} StageVectors;

/* For each component, `first` plus a matrix, given by its columns, times a vector. */
static inline void multiply(
    const stage_vector *columns, StageVectors *vectors, const double *first,
    stage_vector *products)
{
    /* numbers are read from memory: to load one into all lanes takes less than to permute lanes */
    __asm__("" : "+m"(*vectors));
    for (int n = 0; n < DIM; n++) {
        const double *number = vectors->number[n];
        stage_vector even = first[n] + columns[0]*number[0], odd = columns[1]*number[1];
        for (int j = 2; j < STAGES; j += 2) {
            even += columns[j]*number[j];
            odd += columns[j + 1]*number[j + 1];
        }
        products[n] = even + odd;
    }
}

/* The sum of Legendre polynomials at x from -1 to 1, beyond it by extrapolation (C. W. Clenshaw,
   Mathematics of Computation 9 (1955) 118-120); x[k] is (2k + 1)/(k + 1) x. */
static inline stage_vector legendre_sum(const double *coefficients, const stage_vector *x)
{
    stage_vector next = splat_stages(coefficients[TOP]), after = splat_stages(0);
    for (int k = TOP - 1; k >= 0; k--) {
        const stage_vector sum = (coefficients[k] - after*((k + 1)/(k + 2.0))) + x[k]*next;
        after = next;
        next = sum;
    }
    return next;
}

/* The polynomial of a motion that starts with a derivative and a first step. */
static void start_polynomial(State *state, double h, const double *derivative)
{
    memset(state->polynomial, 0, sizeof state->polynomial);
    for (int n = 0; n < DIM; n++) {
        state->polynomial[n*STAGES] = h*derivative[n];
    }
    state->length[0] = h;
}

/* Sizes of the numbers that are added to a component in a step. */
static inline double size_of(double z, stage_vector increment)
{
    const stage_vector magnitude = (stage_vector)((stage_mask)increment & INT64_MAX);
    return fabs(z) + sum_of(magnitude) + SMALLEST;
}

/* Squared change of an iteration that rounding errors may cause, in units of the tolerances. */
static double rounding_change(
    const double *z, const StageVectors *increments, const double *inverse)
{
    double sum = 0;
    for (int n = 0; n < DIM; n++) {
        const double size = inverse[n]*size_of(z[n], increments->vector[n]);
        sum += size*size;
    }
    return sum*(ROUNDING*ROUNDING*STAGES);
}

/* Increments h b k of all stages by fixed-point iteration; NaN where it does not converge. The
   polynomial of a step of this length predicts them: the step starts at `origin`, a part of it. */
static void solve_stages(
    const Task *task, const State *start, const double *polynomial, double length, double origin,
    double h, const double *params, StageVectors *increments, StepResult *result)
{
    stage_vector parameters[PARAMETERS + 1], z[DIM], k[DIM];
    StageVectors before;
    const stage_vector t = start->t + h*NODES, weights = h*WEIGHTS;
    const double ratio = h/length;
    /* known one by one, so that terms of parameters alone are computed once, not in each iteration */
#pragma GCC unroll 64
    for (int p = 0; p < PARAMETERS; p++) {
        parameters[p] = splat_stages(params[p]);
    }
    stage_vector x[STAGES];
    for (int k = 0; k < TOP; k++) {
        x[k] = ((2*origin - 1) + (2*ratio)*NODES)*((2*k + 1)/(k + 1.0));
    }
    for (int n = 0; n < DIM; n++) {
        increments->vector[n] = (ratio*WEIGHTS)*legendre_sum(polynomial + n*STAGES, x);
    }
    const double limit = task->fixed_h ? 0 : CLOSE*CLOSE;
    double inverse[DIM], previous = INFINITY, square = 0;   /* reciprocals of the tolerances */
    for (int n = 0; n < DIM; n++) {
        inverse[n] = 1/(task->atol + task->rtol*fabs(start->z[n]) + SMALLEST);
    }
    for (int iteration = 1;; iteration++) {
        multiply(RATIOS, increments, start->z, z);
        stage_derivatives(t, z, parameters, k);
        for (int n = 0; n < DIM; n++) {
            before.vector[n] = increments->vector[n];
            increments->vector[n] = weights*k[n];
        }
        for (int n = 0; n < DIM && iteration == 1 && task->fixed_h; n++) {
            inverse[n] = 1/(DBL_EPSILON*size_of(start->z[n], increments->vector[n]));
        }
        stage_vector squares = splat_stages(0);
        for (int n = 0; n < DIM; n++) {
            const stage_vector change =
                (increments->vector[n] - before.vector[n])*inverse[n];
            squares += change*change;
        }
        const double change = sum_of(squares);
        result->evaluations = STAGES*iteration;
        if (iteration > 1) {
            square = lane_fmax(change/previous, square/4);      /* of the contraction */
            result->contraction = square;
            if (change*square <= limit) {
                return;
            }
            if (change >= previous
                    && change < rounding_change(start->z, increments, inverse)) {
                return;
            }
        }
        /* with fixed steps changes may grow at first; others are shortened at once */
        if (!(change < (task->fixed_h ? INFINITY : 16*previous)) || iteration == MAX_ITERATIONS) {
            increments->vector[0] = splat_stages(NAN);
            return;
        }
        previous = change;
    }
}

/* Squared norm of the error. The top coefficient of a component decreases with the power STAGES of
   h, and its ratio to the lowest ones with TOP; their product with ERROR_POWER decreases as the
   local error, with 2*STAGES + 1. */
static double squared_error_norm(const Task *task, const State *start, const State *end)
{
    double total = 0, weighted = 0;
    for (int n = 0; n < DIM; n++) {
        const double *c = end->polynomial + n*STAGES;
        const double size = lane_fmax(fabs(start->z[n]), fabs(end->z[n]));
        const double error = c[TOP]/lane_fmax(task->atol + task->rtol*size, SMALLEST);
        const double square = error*error;
        total += square;
        weighted += square*(c[TOP]*c[TOP]/(c[0]*c[0] + c[1]*c[1] + c[2]*c[2] + DBL_MIN));
    }
    const double decrease = lane_log2(weighted + DBL_MIN) - lane_log2(total + DBL_MIN);
    return total*(1.0/DIM)*lane_exp2(ERROR_POWER*decrease);
}

/* The state after h, from a prediction as above. */
static void collocate(
    const Task *task, const State *start, const double *polynomial, double length, double origin,
    double h, const double *params, State *end, StepResult *result)
{
    static const double zero[DIM];
    StageVectors increments;
    stage_vector coefficients[DIM];
    solve_stages(task, start, polynomial, length, origin, h, params, &increments, result);
    multiply(LEGENDRE, &increments, zero, coefficients);
    for (int n = 0; n < DIM; n++) {
        move_component(start, end, n, coefficients[n][0]);   /* P_0 is 1: the sum of the increments */
    }
    memcpy(end->polynomial, coefficients, sizeof coefficients);
    end->length[0] = h;
    end->t = two_sum(start->t, h + start->t_low, &end->t_low);
}

/* The state after h; with step control also the norm of the estimated error. */
static __attribute__((noinline)) void step(
    const Task *task, const State *restrict start, double h, const double *restrict params,
    State *restrict end, StepResult *restrict result)
{
    result->jacobians = 0;
    collocate(task, start, start->polynomial, start->length[0], 1, h, params, end, result);
    if (!task->fixed_h) {
        result->squared_error = squared_error_norm(task, start, end);
    }
}

/* The state after a part h of a step, which ends at `full`. Returns the evaluations. */
static __attribute__((noinline)) double step_within(
    const Task *task, const State *start, const State *full, double h, const double *params,
    State *end)
{
    StepResult result;
    double polynomial[POLYNOMIAL_DIM], factor = 1;
    for (int k = 0; k < SCALES; k++) {      /* taken out of the variation at the end of the step */
        factor = exp2(full->scale[k] - start->scale[k]);
    }
    for (int j = 0; j < POLYNOMIAL_DIM; j++) {
        polynomial[j] = full->polynomial[j]*(j < STAGES*(DIM - VARIATIONS) ? 1 : factor);
    }
    collocate(task, start, polynomial, full->length[0], 0, h, params, end, &result);
    return result.evaluations;
}

/* Factor of h after an error of this norm: predictive control after an accepted step
   (K. Gustafsson, ACM Transactions on Mathematical Software 20 (1994) 496-517), the plain rule
   after a rejected one. The iteration should contract, too. */
static double step_factor(
    const StepResult *result, mask accepted, double h, const State *start, double *previous_error)
{
    const double share = 1.0/(2*STAGES + 1), error = 0.5*lane_log2(result->squared_error + 1e-75);
    double exponent = -share*error;
    if (accepted) {
        const double trend = lane_log2(h/start->length[0]) + share*(*previous_error - error);
        exponent += lane_fmin(trend, 0);
        *previous_error = error;
    }
    const double contraction = 0.5*lane_log2(result->contraction + 1e-75);
    exponent = lane_fmin(exponent, log2(CONTRACTION/SAFETY) - contraction);
    exponent = lane_fmax(exponent, log2(SHRINK/SAFETY));
    return SAFETY*lane_exp2(lane_fmin(exponent, log2(GROW/SAFETY)));
}
