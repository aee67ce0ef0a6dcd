/* The stages of a step, by fixed-point iteration from the polynomial of another step, and the
   error of the step.

   Defined before this file, beside that of stage_vectors.h: the method, by RATIOS, NODES, WEIGHTS,
   LEGENDRE and ERROR_POWER; the right-hand side of all stages, stage_derivatives(). */

enum { TOP = STAGES - 1, MAX_ITERATIONS = 200 };

/* The error of a step is estimated after this many iterations: the top coefficient of the polynomial
   converges faster than the stages. It is estimated again at the end where the square of the
   contraction is larger than SLOW. */
enum { EARLY = 3 };
static const double SLOW = 0.25;

/* The iteration ends when the next change would be below this part of the tolerance; the second is
   that within a step of more than FEW stages, whose end has an error far below the tolerance. */
enum { FEW = 4 };
static const double CLOSE = 0.02, CLOSE_WITHIN = STAGES > FEW ? 2e-3 : 0.02;
/* The least square of the contraction that the first two changes can show: parts of the error of the
   prediction decrease much faster than what is left. */
static const double LEAST_SQUARE = 3e-4;
/* Relative rounding errors of the derivatives, below which an iteration may stagnate. */
static const double ROUNDING = 32*DBL_EPSILON;

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
    double largest_error;       /* a step with a larger squared error is not completed; infinite
                                   within an accepted step */
    double close;               /* part of the tolerance at which the iteration ends */
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
    const double limit = is_fixed ? 0 : prediction->close*prediction->close;
    double inverse[DIM], previous = INFINITY, square = 0;   /* reciprocals of the tolerances */
    for (int n = 0; n < DIM; n++) {
        inverse[n] = 1/(task->atol + task->rtol*fabs(start->z[n]) + SMALLEST);
    }
    /* with fixed steps and within accepted ones; other steps are shortened at once */
    const int may_grow = is_fixed || prediction->largest_error == INFINITY;
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
            /* of the contraction */
            square = lane_fmax(change/previous, iteration == 2 ? LEAST_SQUARE : square/4);
            is_last = change*(square*square) <= limit;
            if (change*square <= limit || (change >= previous
                    && change < rounding_change(start->z, increments, inverse))) {
                break;
            }
        }
        if (!(change < (may_grow ? INFINITY : 16*previous)) || iteration == MAX_ITERATIONS) {
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
