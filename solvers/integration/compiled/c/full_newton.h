/* Stages by Newton's iteration with a Jacobian for each of them, for fixed steps that are long. */

enum { MAX_FULL_ITERATIONS = 12 };

/* The shortest part of a step by which a solution is continued. */
static const double SHORTEST_PART = 0x1p-12;

static __thread double full_matrix[UNKNOWNS*UNKNOWNS];

static int iterate_fully(
    const Method *method, const State *start, double h, const double *params, double (*k)[DIM],
    StepResult *result)
{
    double states[STAGES][DIM], change[STAGES][DIM], jacobian[DIM*DIM], previous = INFINITY;
    int pivots[UNKNOWNS];
    const int unknowns = method->stages*DIM;
    for (int iteration = 1; iteration <= MAX_FULL_ITERATIONS; iteration++) {
        residuals(method, start, h, params, (const double (*)[DIM])k, states, change);
        result->evaluations += method->stages;
        result->jacobians += method->stages;
        double steepest = 0.0;
        for (int i = 0; i < unknowns; i++) {
            if (i % DIM == 0) {
                JACOBIAN(start->t + method->c[i/DIM]*h, states[i/DIM], params, jacobian);
            }
            for (int j = 0; j < unknowns; j++) {
                const double slope = jacobian[i % DIM*DIM + j % DIM];
                full_matrix[i*unknowns + j] = (i == j) - h*method->A[i/DIM][j/DIM]*slope;
                steepest = lane_fmax(steepest, fabs(h*slope));
            }
        }
        if (!factorise(unknowns, full_matrix, pivots)) {
            return 0;
        }
        solve(unknowns, full_matrix, pivots, change[0]);
        add(method, k, (const double (*)[DIM])change);
        const double size = relative_change(
            method, start->z, h, (const double (*)[DIM])k, (const double (*)[DIM])change);
        if (is_rounding(size, previous, steepest)) {
            return 1;
        }
        if (!(size < previous)) {
            return 0;
        }
        previous = size;
    }
    return 0;
}

/* Follow the solution from that of a short step to that of the whole step, where a good first guess
   is needed: each part of the step gives one for a longer part. */
static int continue_from_short_steps(
    const Method *method, const State *start, double h, const double *params,
    const double *derivative, double (*k)[DIM], StepResult *result)
{
    const int has_polynomial = method->lagrange[0] != 0;
    double solved[STAGES][DIM], part = 0.0, advance = 0.5;
    while (advance >= SHORTEST_PART) {
        const double aim = lane_fmin(part + advance, 1.0);
        if (part > 0 && has_polynomial) {
            extrapolate(method, 0.0, aim/part, (const double (*)[DIM])solved, method, k);
        }
        for (int i = 0; i < method->stages && !(part > 0 && has_polynomial); i++) {
            memcpy(k[i], part > 0 ? solved[i] : derivative, sizeof k[i]);
        }
        if (!iterate_fully(method, start, aim*h, params, k, result)) {
            advance /= 2;
        } else if (aim == 1.0) {
            return 1;
        } else {
            memcpy(solved, k, sizeof solved);
            part = aim;
            advance *= 2;
        }
    }
    return 0;
}
