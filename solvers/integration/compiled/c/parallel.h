/* One step of a collocation method, in one lane, whose stages are evaluated at once, each in a lane
   of a vector.

   The derivatives of the stages are those of a polynomial over the step. State holds h dz/dt as a
   sum of Legendre polynomials on [0, 1]: component n has the coefficients polynomial[n*STAGES] to
   polynomial[n*STAGES + STAGES - 1], h is length[0], and the next step starts at the part origin[0]
   of it: at its end, or after a rejected step at its start. */

#define HAS_POLYNOMIAL 1
#define INTERPOLATES 1

/* Limits to the change of h; CONTRACTION is the slowest of an iteration that is efficient. */
static const double SAFETY = 0.82, SHRINK = 0.2, GROW = 2, CONTRACTION = 0.4;

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

/* Which natural weights are those of component n: there is one method. */
static inline int weights_of(const State *start, int n)
{
    (void)n;
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
        .close = CLOSE,
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
        .polynomial = polynomial, .length = full->length[0], .largest_error = INFINITY,
        .close = CLOSE_WITHIN,
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
