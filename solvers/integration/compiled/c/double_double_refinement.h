/* Refinement of the stages of double_double_stages.h.

   Residuals are computed in sums of two doubles, and corrected in doubles: few evaluations of the
   longer numbers are necessary. */

/* The correction d of stages in which the residuals r remain: d = r + J h A d, with products of the
   Jacobian J as differences of the right-hand side; and the change h A d of their states. */
static void correct(
    const Motion *motion, const RefinedStages stages, double h, const double *inverse, double size,
    const lanes *r, Stages d, lanes *change)
{
    /* half the digits are left to the difference */
    const double scale = exp2(floor(log2(sqrt(DBL_EPSILON)/size)));
    const lanes t = motion->t + h*LOWER_C;
    lanes params[PARAMETERS + 1], stage[DIM], value[DIM], values[DIM], part[DIM];
    lanes_of_numbers(motion->params, PARAMETERS, params);
    for (int n = 0; n < DIM; n++) {
        stage[n] = stages[n].high;
        d->vector[n] = r[n];
    }
    LOWER_RHS(t, stage, params, values);
    for (int sweep = 0; sweep < MOST_SWEEPS; sweep++) {
        product(LOWER_A, d, change);
        for (int n = 0; n < DIM; n++) {
            change[n] *= h;
            stage[n] = fused(change[n], splat(scale), stages[n].high);
        }
        LOWER_RHS(t, stage, params, value);
        for (int n = 0; n < DIM; n++) {
            value[n] = fused(value[n] - values[n], splat(1/scale), r[n]);
            part[n] = value[n] - d->vector[n];
            d->vector[n] = value[n];
        }
        if (!(relative_size(part, inverse) > CORRECTED*size)) {
            break;
        }
    }
    product(LOWER_A, d, change);
    for (int n = 0; n < DIM; n++) {
        change[n] *= h;
    }
}

/* States y + h A k of stages. */
static void states_of_stages(const Motion *motion, double h, Stages k, RefinedStages stages)
{
    for (int n = 0; n < DIM; n++) {
        double_double sum = constant(0, 0);
        for (int j = 0; j < STAGES; j++) {
            sum = add_product(sum, A[j], splat(k->number[n][j]));
        }
        sum = multiply(ordered_sum(sum.high, sum.low), constant(h, 0));
        stages[n] = add(constant(motion->y[n], motion->y_low[n]), sum);
    }
}

/* Refine stages that are solved in doubles to the tolerance; returns whether that succeeds, with the
   stages k. */
static int refine(const Motion *motion, double h, double rtol, Stages solved, RefinedStages k)
{
    RefinedStages stages, values;
    double_double params[PARAMETERS + 1];
    double inverse[DIM], last = INFINITY;
    const double_double time = constant(motion->t, motion->t_low);
    const double_double t = add(time, multiply(C, constant(h, 0)));
    inverse_sizes(motion, h, inverse);
    for (int n = 0; n < PARAMETERS; n++) {
        params[n] = constant(motion->params[n], motion->params_low[n]);
    }
    for (int n = 0; n < DIM; n++) {
        k[n] = (double_double){solved->vector[n], splat(0)};
    }
    states_of_stages(motion, h, solved, stages);
    for (int count = 0; count < MOST_CORRECTIONS; count++) {
        Stages d;
        lanes r[DIM], change[DIM];
        RHS(t, stages, params, values);
        for (int n = 0; n < DIM; n++) {
            r[n] = (values[n].high - k[n].high) + (values[n].low - k[n].low);
        }
        const double size = relative_size(r, inverse);
        if (!(size < 1)) {
            return 0;
        }
        const int is_solved = size <= fmax(0.1*rtol, 4*EPSILON);
        if (is_solved || size > last/2) {
            memcpy(k, values, sizeof values);
            return is_solved || size < sqrt(EPSILON);
        }
        last = size;
        correct(motion, stages, h, inverse, size, r, d, change);
        for (int n = 0; n < DIM; n++) {
            k[n] = add(k[n], (double_double){d->vector[n], splat(0)});
            stages[n] = add(stages[n], (double_double){change[n], splat(0)});
        }
    }
    return 0;
}
