/* Signs of switching functions, as in solvers/integration/loops/switching.py.

   Signs and levels of all functions are held behind the parameters. A level is the value that counts
   as 0, up to rounding errors. */

/* Changes of signs, for each function, until they agree with their rates; and successive parts of a
   motion that take less than BRIEF shortest steps, after which all functions that changed their
   signs in turn are at 0. */
enum { MOST_CHANGES = 20, BRIEF = 100, MOST_BRIEF_PARTS = 20 };

/* Stand for the failures of a step, where a function has no value, and where no signs agree with
   their rates. */
enum { HAS_NO_VALUE = 999, IS_UNDETERMINED = 1000 };

static void slide_with(const Motion *motion, int lane, const double *signs, Sliding *sliding)
{
    real params[PARAMETERS];
    memcpy(params, motion->params, sizeof params);
    for (int k = 0; k < SWITCHES; k++) {
        LANE(params[FIRST_SIGN + k], lane) = signs[k];
    }
    slide(motion->state.t, motion->state.z, params, sliding);
}

/* Whether the right-hand side is affine in the signs that are 0. */
static int is_affine(const Motion *motion, int lane, const double *signs)
{
    double held[SWITCHES], first[DIM], other[DIM], expected[DIM], largest = 0.0, defect = 0.0;
    Sliding sliding;
    for (int k = 0; k < SWITCHES; k++) {
        held[k] = signs[k] == 0 ? 1.0 : signs[k];
    }
    slide_with(motion, lane, held, &sliding);
    read_lane(sliding.derivative, DIM, lane, first);
    memcpy(expected, first, sizeof expected);
    for (int k = 0; k <= SWITCHES; k++) {
        double changed[SWITCHES];
        for (int j = 0; j < SWITCHES; j++) {    /* one sign after the other, then all */
            changed[j] = signs[j] == 0 && (j == k || k == SWITCHES) ? -1.0 : held[j];
        }
        slide_with(motion, lane, changed, &sliding);
        read_lane(sliding.derivative, DIM, lane, other);
        for (int n = 0; n < DIM; n++) {
            largest = fmax(largest, fabs(other[n]));
            if (k < SWITCHES) {
                expected[n] += other[n] - first[n];
            } else {
                defect = fmax(defect, fabs(other[n] - expected[n]));
            }
        }
    }
    return defect <= 1e-9*largest;
}

static double direction_of(const Motion *motion, int lane)
{
    const double left = LANE(motion->t_end, lane) - LANE(motion->state.t, lane);
    return left != 0 ? copysign(1.0, left) : copysign(1.0, LANE(motion->h, lane));
}

/* Change signs of functions at 0, always the first that disagrees, between 1, 0 and -1, until each
   moves to the side of its sign or stays (K. G. Murty, Linear Algebra and its Applications 7 (1974)
   65); 0 if they do not. Friction without a lever arm changes its rate by rounding errors alone: then
   the sign by which the function would stay 0 is none, or is beyond the one that disagrees. */
static int make_consistent(const Motion *motion, int lane, const int *is_active, double *signs)
{
    const double direction = direction_of(motion, lane);
    for (int change = 0; change < MOST_CHANGES*SWITCHES; change++) {
        Sliding sliding;
        slide_with(motion, lane, signs, &sliding);
        int k, staying = 0;
        for (k = 0; k < SWITCHES; k++) {
            const double rate = direction*LANE(sliding.values[RATES + k], lane);
            const int agrees = signs[k] != 0 ? signs[k]*rate >= 0
                                             : fabs(LANE(sliding.signs[k], lane)) <= 1 + 1e-12;
            if (is_active[k] && !agrees) {
                break;
            }
            staying += signs[k] == 0;
        }
        if (k == SWITCHES) {
            return staying < 2 || is_affine(motion, lane, signs);
        }
        const double sign = signs[k];
        if (sign == 0) {
            signs[k] = copysign(1.0, LANE(sliding.signs[k], lane));
            continue;
        }
        signs[k] = 0;
        slide_with(motion, lane, signs, &sliding);
        double check = 0;
        for (int j = 0; j < SWITCHES; j++) {
            check += LANE(sliding.signs[j], lane) - LANE(sliding.signs[j], lane);
        }
        /* the rate does not depend on the sign */
        if (check != 0 || !(sign*LANE(sliding.signs[k], lane) < 1)) {
            signs[k] = -sign;
        }
    }
    return 0;
}

static void hold_signs(Motion *motion, int lane, const int *is_active, const double *signs)
{
    Sliding sliding;
    slide_with(motion, lane, signs, &sliding);
    for (int n = 0; n < DIM; n++) {
        LANE(motion->state.z[n], lane) -= LANE(sliding.excess[n], lane);
    }
    slide_with(motion, lane, signs, &sliding);
    for (int k = 0; k < SWITCHES; k++) {
        const double sign = LANE(sliding.signs[k], lane);
        const double level = signs[k] != 0 ? LANE(sliding.values[k], lane) : fmin(1 - sign*sign, 0.0);
        LANE(motion->params[FIRST_SIGN + k], lane) = signs[k];
        LANE(motion->params[FIRST_LEVEL + k], lane) = is_active[k] ? level : 0.0;
    }
}

/* Hold the signs that the functions have from now on. `signs` are preferred for active functions,
   which are 0, and those of the values of others. */
static void settle_signs(Motion *motion, int lane, const int *is_active, double *signs)
{
    for (int round = 0; round <= SWITCHES; round++) {
        if (!make_consistent(motion, lane, is_active, signs)) {
            break;
        }
        Sliding sliding;
        slide_with(motion, lane, signs, &sliding);
        int beyond = 0;
        for (int k = 0; k < SWITCHES; k++) {
            if (!is_active[k] && signs[k]*LANE(sliding.values[k], lane) < 0) {
                signs[k] = -signs[k];
                beyond = 1;
            }
        }
        if (!beyond) {
            hold_signs(motion, lane, is_active, signs);
            return;
        }
    }
    LANE(motion->reductions, lane) = IS_UNDETERMINED;
}

/* Signs at the start of a motion, or where its inputs change. */
static void start_signs(Motion *motion, int lane)
{
    double signs[SWITCHES];
    int is_active[SWITCHES], stays[SWITCHES];
    for (int k = 0; k < SWITCHES; k++) {
        const double before = LANE(motion->params[FIRST_SIGN + k], lane);
        stays[k] = LANE(motion->attempts, lane) > 0 && before == 0;
        signs[k] = LANE(motion->attempts, lane) > 0 && before < 0 ? -1.0 : 1.0;
    }
    /* the value of a function may depend on the signs of those before it */
    for (int round = 0; round < SWITCHES; round++) {
        Sliding sliding;
        slide_with(motion, lane, signs, &sliding);
        for (int k = 0; k < SWITCHES; k++) {
            const double value = LANE(sliding.values[k], lane);
            if (isnan(value)) {
                LANE(motion->reductions, lane) = HAS_NO_VALUE;
                return;
            }
            is_active[k] = stays[k] || value == 0;
            signs[k] = is_active[k] ? signs[k] : copysign(1.0, value);
        }
    }
    settle_signs(motion, lane, is_active, signs);
}

/* Perturbations of velocities jump with accelerations: the perturbed motion switches dt later, with
   dt = -dg/g' (P. C. Mueller, Chaos, Solitons & Fractals 5 (1995) 1671). */
static void perturb(Motion *motion, int lane, int index, const Sliding *before)
{
#if PERTURBED
    const double rate = LANE(before->values[RATES + index], lane);
    const double change = LANE(before->values[CHANGES + index], lane);
    Sliding after;
    slide(motion->state.t, motion->state.z, motion->params, &after);
    for (int i = 0; i < PERTURBED; i++) {
        const double jump = LANE(before->derivative[VELOCITY[i]], lane)
            - LANE(after.derivative[VELOCITY[i]], lane);
        if (jump != 0) {
            LANE(motion->state.z[PERTURBATION[i]], lane) -= jump*(change/rate);
        }
    }
#else
    (void)motion; (void)lane; (void)index; (void)before;
#endif
}

/* Hold other signs from the zero of a switching function on. */
static void switch_signs(Motion *motion, int lane, int index)
{
    const double t = LANE(motion->state.t, lane), last = LANE(motion->last_switch, lane);
    const int is_brief = LANE(motion->recent, lane) != 0
        && fabs(t - last) < BRIEF*LANE(motion->min_h, lane);
    const int parts = is_brief ? (int)LANE(motion->brief_parts, lane) + 1 : 1;
    const int recent = (is_brief ? (int)LANE(motion->recent, lane) : 0) | 1 << index;
    LANE(motion->last_switch, lane) = t;
    LANE(motion->brief_parts, lane) = parts;
    LANE(motion->recent, lane) = recent;
    const int indices = parts > MOST_BRIEF_PARTS ? recent : 1 << index;
    double signs[SWITCHES];
    int is_active[SWITCHES];
    Sliding before;
    read_lane(motion->params + FIRST_SIGN, SWITCHES, lane, signs);
    slide_with(motion, lane, signs, &before);
    const int leaves = signs[index] == 0 && indices == 1 << index;
    for (int k = 0; k < SWITCHES; k++) {
        const int is_beyond = signs[k]*LANE(before.values[k], lane) < 0 && !leaves;
        const int changes = indices >> k & 1 || is_beyond;
        is_active[k] = changes || signs[k] == 0;
        signs[k] = changes ? -signs[k] : signs[k];
    }
    if (parts > 2*MOST_BRIEF_PARTS) {
        LANE(motion->reductions, lane) = IS_UNDETERMINED;
    } else if (leaves) {    /* forces are continuous there */
        signs[index] = copysign(1.0, LANE(before.signs[index], lane));
        hold_signs(motion, lane, is_active, signs);
    } else {
        const int stayed = LANE(motion->params[FIRST_SIGN + index], lane) == 0;
        settle_signs(motion, lane, is_active, signs);
        if (!stayed) {
            perturb(motion, lane, index, &before);
        }
    }
}
