/* One step of an implicit method, in one lane, and the length of the next one.

   Defined before this file, beside that of step.h: JACOBIAN, STAGES, and the methods, METHODS. */

#define HAS_POLYNOMIAL 1
#define INTERPOLATES 0

static const double SAFETY = 0.9, SHRINK = 0.2, GROW = 5.0;
/* The tolerance of the error estimate is this, times the power of the tolerance. */
static const double ESTIMATE_SHARE = 0.01;
/* Step sizes that would grow by less stay, and so do the factors of the matrices. */
static const double LEAST_GROWTH = 1.2;
/* Errors below this part of the tolerance do not make the prediction more optimistic. */
static const double LEAST_ERROR = 1e-2;

/* Squared norm of the error.

   The polynomial p' of the stages differs from the derivative f at the start; the embedded solution
   that uses f, too, differs by h g (f - p'(0)), where g is the real eigenvalue of A. The filter
   (I - h g J)^-1 keeps it bounded for stiff equations, a second one makes it small (E. Hairer,
   G. Wanner, section IV.8; Journal of Computational and Applied Mathematics 111 (1999) 93-111). Its
   order is the number of stages, that of the method nearly twice as large: the tolerance of the estimate is
   larger by a power accordingly, as there. */
static double squared_error_norm(
    const Method *method, const Task *task, const State *start, double h, const double *params,
    const double *derivative, const double (*k)[DIM], const State *end, StepResult *result)
{
    double at_start[DIM], error[DIM], state[DIM], filtered[DIM], check = 0.0;
    const double weight = h*method->M[0][0];
    for (int n = 0; n < DIM; n++) {
        at_start[n] = 0.0;
        for (int j = 0; j < method->stages; j++) {
            at_start[n] += method->at_start[j]*k[j][n];
        }
        error[n] = weight*(derivative[n] - at_start[n]);
    }
    solve(DIM, linearisation.factors, linearisation.pivots, error);
    for (int n = 0; n < DIM; n++) {
        state[n] = start->z[n] + error[n];
    }
    RHS(start->t, state, params, filtered);
    result->evaluations += 1;
    for (int n = 0; n < DIM; n++) {
        filtered[n] = weight*(filtered[n] - at_start[n]);
    }
    solve(DIM, linearisation.factors, linearisation.pivots, filtered);
    for (int n = 0; n < DIM; n++) {
        check += filtered[n] - filtered[n];
    }
    const double tolerance = task->rtol > 0 ? task->rtol : lane_fmin(task->atol, 1.0);
    const double relaxed = ESTIMATE_SHARE*pow(tolerance, method->error_power);
    return mean_square(check == 0 ? filtered : error, start->z, end->z, task->rtol*relaxed,
                       task->atol*relaxed);
}

static inline double increment(const Method *method, double h, const double (*k)[DIM], int n)
{
    double sum = 0.0;
    for (int j = 0; j < method->stages; j++) {
        sum += (h*method->b[j])*k[j][n];
    }
    return sum;
}

/* Which natural weights are those of component n: those of the method of the step, of a family. */
static inline int weights_of(const State *start, int n)
{
    (void)n;
    return VARIES_ORDER ? (int)start->order[0] : 0;
}

/* The change of component n that belongs to an end of the step, or after these to a stage. */
static inline double stage_change(
    const State *end, const StepResult *result, const double *h, int part, int m, int n)
{
    (void)part;
    return *h*(m < ENDS ? result->ends[m][n] : end->polynomial[(m - ENDS)*DIM + n]);
}

/* The state after h; with step control also the norm of the estimated error. */
static __attribute__((noinline)) void step(
    const Task *task, const State *restrict start, double h, const double *restrict params,
    State *restrict end, StepResult *restrict result)
{
    const Method *method = method_of_step(start);
    double k[STAGES][DIM], derivative[DIM];
    result->evaluations = 1;
    result->jacobians = 0;
    RHS(start->t, start->z, params, derivative);
    solve_stages(method, task, start, h, params, derivative, k, end, result);
    for (int n = 0; n < DIM; n++) {
        move_component(start, end, n, increment(method, h, (const double (*)[DIM])k, n));
    }
    memcpy(end->polynomial, k, sizeof k);
    end->length[0] = h;
    end->t = two_sum(start->t, h + start->t_low, &end->t_low);
    if (task->event_count > 0) {
        memcpy(result->ends[0], derivative, sizeof derivative);
        RHS(end->t, end->z, params, result->ends[1]);
        result->evaluations += 1;
    }
    if (!task->fixed_h) {
        result->squared_error = squared_error_norm(
            method, task, start, h, params, derivative, (const double (*)[DIM])k, end, result);
    }
}

/* Factor of h after an error of this norm: predictive control after an accepted step
   (K. Gustafsson, ACM Transactions on Mathematical Software 20 (1994) 496-517), the plain rule
   after a rejected one. */
static double step_factor(
    const StepResult *result, mask accepted, double h, const State *start, double *previous_error)
{
    const Method *method = method_of_step(start);
    const double share = 1.0/(method->stages + 1);
    const double error = 0.5*lane_log2(result->squared_error + 1e-75);
    double exponent = -share*error;
    if (accepted) {
        const double trend = lane_log2(h/start->length[0]) + share*(*previous_error - error);
        exponent += method == method_of_last_step(start) ? lane_fmin(trend, 0) : 0;
        *previous_error = lane_fmax(error, log2(LEAST_ERROR));
    }
    exponent = lane_fmin(lane_fmax(exponent, log2(SHRINK/SAFETY)), log2(GROW/SAFETY));
    const double factor = SAFETY*lane_exp2(exponent);
    return accepted && factor > 1 && factor < LEAST_GROWTH ? 1 : factor;
}
