/* Integrals, and changes of a motion's components, in sums of two doubles, for
   extended_projection.h; all lanes are equal. */

typedef double_double number;

typedef void (*Function)(
    double_double t, const double_double *y, const double_double *params, double_double *result);

static void evaluate(Function function, const Motion *motion, double_double *result)
{
    double_double y[DIM], params[PARAMETERS + 1];
    for (int n = 0; n < DIM; n++) {
        y[n] = constant(motion->y[n], motion->y_low[n]);
    }
    for (int n = 0; n < PARAMETERS; n++) {
        params[n] = constant(motion->params[n], motion->params_low[n]);
    }
    function(constant(motion->t, motion->t_low), y, params, result);
}

static void correction(const Motion *motion, number *change)
{
    evaluate(CORRECTION, motion, change);
}

static void keep_integrals(Motion *motion)
{
#if HAS_INTEGRALS
    double_double values[KEPT];
    evaluate(EVALUATE, motion, values);
    for (int k = 0; k < KEPT; k++) {
        motion->params[FIRST_KEPT + k] = values[k].high[0];
        motion->params_low[FIRST_KEPT + k] = values[k].low[0];
    }
#else
    (void)motion;
#endif
}

static void shift(Motion *motion, int n, number change)
{
    const double_double sum = add(constant(motion->y[n], motion->y_low[n]), change);
    motion->y[n] = sum.high[0];
    motion->y_low[n] = sum.low[0];
}

/* Turn an angle, and move sin^2 + cos^2 to 1, up to cubes of the changes. */
static void turn(Motion *motion, int sine, number change)
{
    const double_double s = constant(motion->y[sine], motion->y_low[sine]);
    const double_double c = constant(motion->y[sine + 1], motion->y_low[sine + 1]);
    const double_double square = add(multiply(s, s), multiply(c, c));
    const double_double excess = add(subtract(square, constant(1, 0)), multiply(change, change));
    const double_double shorter = multiply(excess, constant(0.5, 0));
    shift(motion, sine, subtract(multiply(change, c), multiply(shorter, s)));
    shift(motion, sine + 1, negative(add(multiply(change, s), multiply(shorter, c))));
}
