/* One step of a collocation method, in one lane, whose stages are evaluated at once, each in a lane
   of a vector.

   Defined before this file, beside that of step.h: the method, by STAGES, RATIOS, NODES, WEIGHTS,
   LEGENDRE and ERROR_POWER; the right-hand side of all stages, stage_derivatives().

   The derivatives of the stages are those of a polynomial over the step. State holds h dz/dt as a
   sum of Legendre polynomials on [0, 1]: component n has the coefficients polynomial[n*STAGES] to
   polynomial[n*STAGES + STAGES - 1], h is length[0], and the next step starts at the part origin[0]
   of it: at its end, or after a rejected step at its start. */

#define HAS_POLYNOMIAL 1
#define INTERPOLATES 1
enum { TOP = STAGES - 1, MAX_ITERATIONS = 200 };

/* The error of a step is estimated after this many iterations: the top coefficient of the polynomial
   converges faster than the stages. It is estimated again at the end where the square of the
   contraction is larger than SLOW. */
enum { EARLY = 3 };
static const double SLOW = 0.25;

/* The iteration ends when the next change would be below this part of the tolerance. */
static const double CLOSE = 0.02;
/* Relative rounding errors of the derivatives, below which an iteration may stagnate. */
static const double ROUNDING = 32*DBL_EPSILON;
/* A number that counts as 0, but whose reciprocal has a square. */
static const double SMALLEST = 1e-100;
static const double ZERO[DIM];
/* Limits to the change of h; CONTRACTION is the slowest of an iteration that is efficient. */
static const double SAFETY = 0.82, SHRINK = 0.2, GROW = 2, CONTRACTION = 0.4;

static inline stage_vector splat_stages(double x) { return (stage_vector){0} + x; }

static inline double sum_of(stage_vector x)
{
    typedef double half_vector __attribute__((vector_size(4*STAGES)));
    const union { stage_vector whole; half_vector halves[2]; } lanes = {.whole = x};
    const half_vector pairs = lanes.halves[0] + lanes.halves[1];
    double sum = 0;
    for (int i = 0; i < STAGES/4; i++) {
        sum += pairs[i] + pairs[i + STAGES/4];
    }
    return sum;
}

/* Binary logarithm of a positive normal number within 0.09, more than step control needs: linear
   between powers of two. */
static inline double rough_log2(double x) { return (as_mask(x) - as_mask(1.0))*0x1p-52; }

/* The inverse of this function, for |x| < 1000. */
static inline double rough_exp2(double x) { return as_real((int64_t)(x*0x1p52) + as_mask(1.0)); }

/* For each component, `first` plus a matrix, given by its columns, times a vector. */
static inline void multiply(
    const stage_vector *columns, const void *vectors, const double *first, stage_vector *products)
{
    /* numbers are read from memory: to load one into all lanes takes less than to permute lanes */
    const double *numbers = vectors;
    __asm__("" : "+r"(numbers) : : "memory");
    for (int n = 0; n < DIM; n++) {
        const double *number = numbers + n*STAGES;
        stage_vector even = first[n] + columns[0]*number[0], odd = columns[1]*number[1];
        for (int j = 2; j < STAGES; j += 2) {
            even += columns[j]*number[j];
            odd += columns[j + 1]*number[j + 1];
        }
        products[n] = even + odd;
    }
}

/* The Legendre polynomials times `scale` at x from -1 to 1, beyond it by extrapolation. */
static inline void legendre_polynomials(stage_vector x, stage_vector scale, stage_vector *values)
{
    values[0] = scale;
    values[1] = x*scale;
    for (int k = 1; k < TOP; k++) {
        values[k + 1] = ((2*k + 1)/(k + 1.0)*x)*values[k] - (k/(k + 1.0))*values[k - 1];
    }
}

/* The polynomial of a motion that starts with a derivative and a first step. */
static void start_polynomial(State *state, double h, const double *derivative)
{
    memset(state->polynomial, 0, sizeof state->polynomial);
    for (int n = 0; n < DIM; n++) {
        state->polynomial[n*STAGES] = h*derivative[n];
    }
    state->length[0] = h;
    state->origin[0] = 1;
}

/* The polynomial of a rejected step, which ends at `end`, predicts a shorter one. */
static void keep_polynomial(State *state, const State *end)
{
    memcpy(state->polynomial, end->polynomial, sizeof state->polynomial);
    state->length[0] = end->length[0];
    state->origin[0] = 0;
}

/* Sizes of the numbers that are added to a component in a step. */
static inline double size_of(double z, stage_vector increment)
{
    const stage_vector magnitude = (stage_vector)((stage_mask)increment & INT64_MAX);
    return fabs(z) + sum_of(magnitude) + SMALLEST;
}

/* Squared change of an iteration that rounding errors may cause, in units of the tolerances. */
static double rounding_change(
    const double *z, const stage_vector *increments, const double *inverse)
{
    double sum = 0;
    for (int n = 0; n < DIM; n++) {
        const double size = inverse[n]*size_of(z[n], increments[n]);
        sum += size*size;
    }
    return sum*(ROUNDING*ROUNDING*STAGES);
}

/* Squared norm of the error. The top coefficient of a component decreases with the power STAGES of
   h, and its ratio to the lowest ones with TOP; their product with ERROR_POWER decreases as the
   local error, with 2*STAGES + 1. */
static __attribute__((noinline)) double squared_error_norm(
    const Task *task, const double *start, const stage_vector *increments)
{
    stage_vector coefficients[DIM];
    double total = DBL_MIN, weighted = DBL_MIN;
    multiply(LEGENDRE, increments, ZERO, coefficients);
    for (int n = 0; n < DIM; n++) {
        const stage_vector c = coefficients[n];
        const double size = lane_fmax(fabs(start[n]), fabs(start[n] + c[0]));
        const double allowed = lane_fmax(task->atol + task->rtol*size, SMALLEST);
        const double top = c[TOP]*c[TOP], low = c[0]*c[0] + c[1]*c[1] + c[2]*c[2] + SMALLEST;
        const double quotient = top/(allowed*allowed*low);
        total += quotient*low;
        weighted += quotient*top;
    }
    return total*(1.0/DIM)*rough_exp2(ERROR_POWER*(rough_log2(weighted) - rough_log2(total)));
}

/* A step that is predicted by the polynomial of a step of `length` and starts at `origin`, a part
   of it. */
typedef struct {
    const double *polynomial;
    double length, origin;
    double largest_error;       /* a step with a larger squared error is not completed */
} Prediction;

/* Increments h b k of all stages by fixed-point iteration; NaN where it does not converge. The
   error is estimated, unless steps are fixed. */
static inline void solve_stages(
    const Task *task, const State *start, const Prediction *prediction, double h,
    const double *params, stage_vector *increments, StepResult *result)
{
    stage_vector parameters[PARAMETERS + 1], basis[STAGES], before[DIM], z[DIM], k[DIM];
    const stage_vector t = start->t + h*NODES, weights = h*WEIGHTS;
    const double ratio = h/prediction->length, origin = prediction->origin;
    /* known one by one, so that terms of parameters alone are computed once, not in each iteration */
#pragma GCC unroll 64
    for (int p = 0; p < PARAMETERS; p++) {
        parameters[p] = splat_stages(params[p]);
    }
    legendre_polynomials((2*origin - 1) + (2*ratio)*NODES, ratio*WEIGHTS, basis);
    multiply(basis, prediction->polynomial, ZERO, increments);
    const int is_fixed = task->fixed_h != 0;
    const double limit = is_fixed ? 0 : CLOSE*CLOSE;
    double inverse[DIM], previous = INFINITY, square = 0;   /* reciprocals of the tolerances */
    for (int n = 0; n < DIM; n++) {
        inverse[n] = 1/(task->atol + task->rtol*fabs(start->z[n]) + SMALLEST);
    }
    int iteration = 0, is_last = 0, is_estimated = is_fixed;
    for (;;) {
        multiply(RATIOS, increments, start->z, z);
        stage_derivatives(t, z, parameters, k);
        iteration++;
        for (int n = 0; n < DIM; n++) {
            before[n] = increments[n];
            increments[n] = weights*k[n];
        }
        /* this was known before the iteration began: the processor need not wait for its results */
        if (is_last) {
            break;
        }
        for (int n = 0; n < DIM && iteration == 1 && is_fixed; n++) {
            inverse[n] = 1/(DBL_EPSILON*size_of(start->z[n], increments[n]));
        }
        stage_vector squares = splat_stages(0);
        for (int n = 0; n < DIM; n++) {
            const stage_vector change = (increments[n] - before[n])*inverse[n];
            squares += change*change;
        }
        const double change = sum_of(squares);
        if (iteration > 1) {
            square = lane_fmax(change/previous, square/4);      /* of the contraction */
            is_last = change*(square*square) <= limit;
            if (change*square <= limit || (change >= previous
                    && change < rounding_change(start->z, increments, inverse))) {
                break;
            }
        }
        /* with fixed steps changes may grow at first; others are shortened at once */
        if (!(change < (is_fixed ? INFINITY : 16*previous)) || iteration == MAX_ITERATIONS) {
            increments[0] = splat_stages(NAN);
            break;
        }
        if (iteration == EARLY && !is_fixed) {
            is_estimated = 1;
            result->squared_error = squared_error_norm(task, start->z, increments);
            if (result->squared_error > prediction->largest_error) {
                break;
            }
        }
        previous = change;
    }
    if (!is_estimated || (square > SLOW && is_last)) {
        result->squared_error = squared_error_norm(task, start->z, increments);
    }
    result->contraction = square;
    result->evaluations = STAGES*iteration;
}

/* The state after h, from a prediction. */
static inline void collocate(
    const Task *task, const State *start, const Prediction *prediction, double h,
    const double *params, State *end, StepResult *result)
{
    stage_vector increments[DIM], coefficients[DIM];
    solve_stages(task, start, prediction, h, params, increments, result);
    multiply(LEGENDRE, increments, ZERO, coefficients);
    for (int n = 0; n < DIM; n++) {
        move_component(start, end, n, coefficients[n][0]);   /* P_0 is 1: the sum of the increments */
    }
    memcpy(end->polynomial, coefficients, sizeof coefficients);
    end->length[0] = h;
    end->origin[0] = 1;
    end->t = two_sum(start->t, h + start->t_low, &end->t_low);
}

/* The method of the step, of those of a family. */
static inline int member_of(const State *start)
{
    (void)start;
    return 0;
}

/* The change of component n that belongs to a Legendre polynomial. */
static inline double stage_change(
    const State *end, const StepResult *result, const double *h, int part, int m, int n)
{
    (void)result; (void)h; (void)part;
    return end->polynomial[n*STAGES + m];
}

/* The state after h; with step control also the norm of the estimated error. A step whose error is
   too large ends early. */
static __attribute__((noinline)) void step(
    const Task *task, const State *restrict start, double h, const double *restrict params,
    State *restrict end, StepResult *restrict result)
{
    const Prediction prediction = {
        .polynomial = start->polynomial,
        .length = start->length[0],
        .origin = start->origin[0],
        .largest_error = 1,
    };
    result->jacobians = 0;
    collocate(task, start, &prediction, h, params, end, result);
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
    const Prediction prediction = {
        .polynomial = polynomial, .length = full->length[0], .largest_error = INFINITY
    };
    collocate(task, start, &prediction, h, params, end, &result);
    return result.evaluations;
}

/* Factor of h after an error of this norm: predictive control after accepted steps
   (K. Gustafsson, ACM Transactions on Mathematical Software 20 (1994) 496-517), the plain rule
   after a rejected one, and no growth after the next. The iteration should contract, too. */
static double step_factor(
    const StepResult *result, mask accepted, double h, const State *start, double *previous_error)
{
    const double share = 1.0/(2*STAGES + 1), error = 0.5*rough_log2(result->squared_error + SMALLEST);
    const int after_rejection = start->origin[0] == 0;
    double exponent = -share*error;
    if (accepted) {
        const double trend = rough_log2(h/start->length[0]) + share*(*previous_error - error);
        exponent += after_rejection ? 0 : lane_fmin(trend, 0);
        *previous_error = error;
    }
    const double contraction = 0.5*rough_log2(result->contraction + SMALLEST);
    const double factor = lane_fmin(
        SAFETY*rough_exp2(exponent), CONTRACTION*rough_exp2(-contraction));
    return lane_fmax(lane_fmin(factor, accepted && after_rejection ? 1 : GROW), SHRINK);
}
