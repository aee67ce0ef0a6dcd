/* Stages by Newton's iteration with one Jacobian for all of them. */

enum { MAX_FIXED_ITERATIONS = 50 };

static inline int max_controlled_iterations(const Method *method)
{
    return 7 + 2*(method->stages - 3)*(method->stages > 3);
}

/* Error of the stages of a controlled step, relative to the tolerance. */
static const double SHARE = 0.01;
/* The iteration of fixed steps ends when the relative change is below CLOSE; numbers not much larger
   than TINY have fewer digits than others. */
static const double CLOSE = 1e-14, TINY = 1e-290;

/* Derivatives at all stages, minus k. */
static void residuals(
    const Method *method, const State *start, double h, const double *params,
    const double (*k)[DIM], double (*states)[DIM], double (*residual)[DIM])
{
    multiply(method->stages, method->A, method->stages, k, states);
    for (int i = 0; i < method->stages; i++) {
        for (int n = 0; n < DIM; n++) {
            states[i][n] = start->z[n] + h*states[i][n];
        }
        RHS(start->t + method->c[i]*h, states[i], params, residual[i]);
        for (int n = 0; n < DIM; n++) {
            residual[i][n] -= k[i][n];
        }
    }
}

static void add(const Method *method, double (*k)[DIM], const double (*change)[DIM])
{
    for (int i = 0; i < method->stages; i++) {
        for (int n = 0; n < DIM; n++) {
            k[i][n] += change[i][n];
        }
    }
}

/* Largest change relative to the state and its increments, NaN if one is not finite. */
static double relative_change(
    const Method *method, const double *z, double h, const double (*k)[DIM],
    const double (*change)[DIM])
{
    double largest = 0.0, largest_change = 0.0, largest_increment = 0.0, check = 0.0;
    for (int n = 0; n < DIM; n++) {
        largest = lane_fmax(largest, fabs(z[n]));
    }
    for (int i = 0; i < method->stages; i++) {
        for (int n = 0; n < DIM; n++) {
            largest_change = lane_fmax(largest_change, fabs(h*change[i][n]));
            largest_increment = lane_fmax(largest_increment, fabs(h*k[i][n]));
            check += change[i][n] - change[i][n];
        }
    }
    return largest_change/(largest + largest_increment + TINY) + check;
}

/* Norm of the change of k relative to the tolerances. */
static double scaled_change(
    const Method *method, const Task *task, const double *z, double h,
    const double (*change)[DIM])
{
    double total = 0.0;
    for (int n = 0; n < DIM; n++) {
        const double inverse = h/lane_fmax(task->atol + task->rtol*fabs(z[n]), 1e-75);
        for (int i = 0; i < method->stages; i++) {
            total += (change[i][n]*inverse)*(change[i][n]*inverse);
        }
    }
    return sqrt(total/(method->stages*DIM));
}

/* Whether changes no longer decrease since rounding errors, multiplied by a large Jacobian, prevent
   it. */
static int is_rounding(double change, double previous, double steepest)
{
    return change <= CLOSE || (change < CLOSE*(100 + steepest) && change >= previous/2);
}

/* Iterate with the Jacobian of a point; `rate` is the part of the error that an iteration leaves, and
   the contraction the mean of its last two values. Returns whether it converges, early where it does
   not. */
static int iterate(
    const Method *method, const Task *task, const State *start, double h, const double *params,
    double t, const double *z, double (*k)[DIM], double *rate, StepResult *result)
{
    double states[STAGES][DIM], change[STAGES][DIM], previous = INFINITY;
    const int limit = task->fixed_h ? MAX_FIXED_ITERATIONS : max_controlled_iterations(method);
    if (!linearise(method, t, z, h, params)) {
        return 0;
    }
    if (!task->fixed_h) {
        /* not known before the second change: less certain than in the last step */
        *rate = sqrt(*rate);
    }
    result->contraction = 0.0;
    for (int iteration = 1; iteration <= limit; iteration++) {
        residuals(method, start, h, params, (const double (*)[DIM])k, states, change);
        result->evaluations += method->stages;
        solve_blocks(method, change);
        add(method, k, (const double (*)[DIM])change);
        const double size = task->fixed_h
            ? relative_change(method, start->z, h, (const double (*)[DIM])k,
                              (const double (*)[DIM])change)
            : scaled_change(method, task, start->z, h, (const double (*)[DIM])change);
        const double last_rate = *rate;
        if (iteration > 1) {
            *rate = size/previous;
            result->contraction = iteration == 2 ? *rate : sqrt(*rate*last_rate);
        }
        if (task->fixed_h ? is_rounding(size, previous, fabs(h)*linearisation.largest)
                          : size == 0 || (*rate < 1 && size**rate < SHARE*(1 - *rate))) {
            /* with fixed steps the change is a rounding error, which only limits the rate */
            *rate = lane_fmin(*rate, task->fixed_h ? last_rate : 1);
            return 1;
        }
        if (!(size < INFINITY) || (iteration > 1 && *rate >= 1)) {
            return 0;
        }
        previous = size;
    }
    return 0;
}
