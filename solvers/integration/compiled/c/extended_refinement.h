/* Refinement of the stages of extended_stages.h.

   Residuals are computed in `real`, and corrected in `lower`: each correction adds about half the
   digits of `lower`, and few evaluations in `real` are necessary. */

/* The correction d of stages in which the residuals r remain: d = r + J h A d, with products of the
   Jacobian J as differences of the right-hand side in `lower`. */
static void correct(
    lower t, Stages stages, lower h, const lower *params, Stages r, double size, Stages d)
{
    /* half the digits of `lower` are left to the difference */
    const double scale = exp2(floor(log2(sqrt((double)LOWER_EPSILON)/size)));
    Stages values;
    for (int i = 0; i < STAGES; i++) {
        LOWER_RHS(t + h*LOWER_C[i], stages[i], params, values[i]);
        memcpy(d[i], r[i], sizeof d[i]);
    }
    for (int sweep = 0; sweep < MOST_SWEEPS; sweep++) {
        double largest = 0;
        for (int i = 0; i < STAGES; i++) {
            lower stage[DIM], value[DIM], change[DIM];
            for (int n = 0; n < DIM; n++) {
                lower sum = 0;
                for (int j = 0; j < STAGES; j++) {
                    sum += LOWER_A[i][j]*d[j][n];
                }
                stage[n] = stages[i][n] + (lower)scale*h*sum;
            }
            LOWER_RHS(t + h*LOWER_C[i], stage, params, value);
            for (int n = 0; n < DIM; n++) {
                value[n] = r[i][n] + (value[n] - values[i][n])/(lower)scale;
                change[n] = value[n] - d[i][n];
                d[i][n] = value[n];
            }
            const double part = relative_size(change, h, stages[i]);
            largest = part <= largest ? largest : part;
        }
        if (!(largest > CORRECTED*size)) {
            return;
        }
    }
}

/* Residuals of the stages k, with their states, in `lower`, and the derivatives there; returns the
   size of the largest. */
static double residuals(
    const Motion *motion, real h, RefinedStages k, Stages stages, RefinedStages values, Stages r)
{
    double size = 0;
    clear_upper_halves();
    for (int i = 0; i < STAGES; i++) {
        real stage[DIM];
        for (int n = 0; n < DIM; n++) {
            real sum = 0;
            for (int j = 0; j < STAGES; j++) {
                sum += A[i][j]*k[j][n];
            }
            stage[n] = motion->y[n] + (h*sum + motion->y_low[n]);
            stages[i][n] = (lower)stage[n];
        }
        RHS(motion->t + h*C[i], stage, motion->params, values[i]);
        for (int n = 0; n < DIM; n++) {
            r[i][n] = (lower)(values[i][n] - k[i][n]);
        }
        const double part = relative_size(r[i], (lower)h, stages[i]);
        size = part <= size ? size : part;
    }
    return size;
}

/* Refine stages that are solved in `lower` to the tolerance; returns whether that succeeds, with the
   stages k. */
static int refine(const Motion *motion, real h, double rtol, Stages solved, RefinedStages k)
{
    lower params[PARAMETERS + 1];
    lower_numbers(motion->params, PARAMETERS, params);
    for (int i = 0; i < STAGES; i++) {
        for (int n = 0; n < DIM; n++) {
            k[i][n] = solved[i][n];
        }
    }
    double last = INFINITY;
    for (int count = 0; count < MOST_CORRECTIONS; count++) {
        Stages stages, r, d;
        RefinedStages values;
        const double size = residuals(motion, h, k, stages, values, r);
        if (!(size < 1)) {
            return 0;
        }
        const int is_solved = size <= fmax(0.1*rtol, 4*(double)EPSILON);
        if (is_solved || size > last/2) {
            memcpy(k, values, sizeof values);
            return is_solved || size < sqrt((double)EPSILON);
        }
        last = size;
        correct((lower)motion->t, stages, (lower)h, params, r, size, d);
        for (int i = 0; i < STAGES; i++) {
            for (int n = 0; n < DIM; n++) {
                k[i][n] += d[i][n];
            }
        }
    }
    return 0;
}
