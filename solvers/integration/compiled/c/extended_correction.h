/* Integrals, and changes of a motion's components, in `real`, for extended_projection.h. */

typedef real number;

static void correction(const Motion *motion, number *change)
{
    clear_upper_halves();
    CORRECTION(motion->t, motion->y, motion->params, change);
}

static void keep_integrals(Motion *motion)
{
#if HAS_INTEGRALS
    clear_upper_halves();
    EVALUATE(motion->t, motion->y, motion->params, motion->params + FIRST_KEPT);
#else
    (void)motion;
#endif
}

static void shift(Motion *motion, int n, number change)
{
    motion->y[n] = compensated_sum(motion->y[n], change, motion->y_low + n);
}

/* Turn an angle, and move sin^2 + cos^2 to 1, up to cubes of the changes. */
static void turn(Motion *motion, int sine, number change)
{
    const real s = motion->y[sine], c = motion->y[sine + 1];
    const real shorter = (s*s + c*c - 1 + change*change)/2;
    shift(motion, sine, change*c - shorter*s);
    shift(motion, sine + 1, -change*s - shorter*c);
}
