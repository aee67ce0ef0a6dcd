/* The location of an event within a step: a bracket is reduced until its ends are equal times. Two or
   three substeps near the estimate of a polynomial make it narrow; a cubic gives all other states. */

enum { MAX_SUBSTEPS = 100, MAX_AIMS = 6, MAX_TRIES = 10 };

/* A bracket that is this part of a step is narrow: the cubic by the states and derivatives at its
   ends is exact but for rounding errors. Substeps aim this part of a step beyond the event, so that
   two of them may suffice. */
static const double NARROW = 2e-4, BEYOND = 2e-5;

static void add_bracket(WithinStep *within, const Bracket *bracket)
{
    memcpy(&within->brackets[within->bracket_count++], bracket, sizeof *bracket);
}

/* The next h within the bracket of an event: an estimate by a polynomial; else by regula falsi, with
   the value at an end that stays halved (M. Dowell and P. Jarratt, BIT 11 (1971) 168-174);
   bisection if that converges slowly, or the value is 0; never so close to an end that the times
   are equal. */
static double next_event_h(const WithinStep *within)
{
    const Bracket *bracket = within->bracket;
    const double x = bracket->near, y = bracket->far;
    const double u = bracket->near_value, v = bracket->far_value;
    const int is_estimated = (bracket->aim - x)*(y - bracket->aim) > 0;
    const double aim = is_estimated ? bracket->aim
        : within->substeps < MAX_SUBSTEPS/2 && v != 0 ? (x*v - y*u)/(v - u) : (x + y)/2;
    const double margin = copysign(within->resolution, y - x);
    return margin > 0 ? fmin(fmax(aim, x + margin), y - margin)
                      : fmax(fmin(aim, x + margin), y - margin);
}

/* After a substep of length h, aim slightly beyond the event, at the side where it did not end. */
static void aim_beyond(WithinStep *within, double h, double value)
{
    Bracket *bracket = within->bracket;
    if (within->substeps > 1) {
        bracket->slope = (value - within->last_value)/(h - within->last_h);
    }
    within->last_h = h;
    within->last_value = value;
    const double shift = -value/bracket->slope;
    const double excess = BEYOND*fabs(within->full_h) + 0.1*fabs(shift);
    const double side = h == bracket->near ? bracket->far - h : bracket->near - h;
    bracket->aim = within->substeps < MAX_AIMS ? h + shift + copysign(excess, side) : NAN;
}

/* Whether the bracket needs no further substeps. No cubic connects states of which different powers
   of two were taken out. */
static int is_narrow(const WithinStep *within)
{
    const Bracket *bracket = within->bracket;
    int narrow = fabs(bracket->far - bracket->near) <= NARROW*fabs(within->full_h);
    for (int k = 0; k < SCALES; k++) {
        const int n = offsetof(State, scale)/sizeof(real) + k;
        narrow &= within->near_state[n] == within->far_state[n];
    }
    return narrow && !bracket->tries && within->knows_near;
}

/* Whether the event in a bracket needs to be located more accurately. */
static int is_wide(const WithinStep *within)
{
    const Bracket *bracket = within->bracket;
    return fabs(bracket->far - bracket->near) > 2*within->resolution
        && within->substeps < MAX_SUBSTEPS;
}

/* Move one end of the bracket to h, where the event has `value`; returns whether it is the near one. */
static int reduce_bracket(WithinStep *within, double h, double value)
{
    Bracket *bracket = within->bracket;
    const int is_near = (value < 0) == (bracket->near_value < 0) && value != 0;
    within->substeps++;
    if (is_near) {
        bracket->near = h;
        bracket->near_value = value;
        bracket->far_value *= within->side < 0 ? 0.5 : 1;
    } else {
        bracket->far = h;
        bracket->far_value = value;
        bracket->near_value *= within->side > 0 ? 0.5 : 1;
    }
    within->side = is_near ? -1 : 1;
    return is_near;
}

/* Whether an extremum may have another sign than the value near it. If so, `h` moves towards it. */
static int approach_extremum(const Bracket *bracket, double value, double slope, double *h)
{
    const double move = -slope/bracket->curvature, aim = *h + move;
    const int is_inside = (aim - bracket->near)*(bracket[1].far - aim) > 0;
    /* the extremum is nearer to 0 by half of slope*move, if the curvature is right */
    if (value*bracket->curvature > 0 && fabs(value) < 2*fabs(slope*move) && is_inside) {
        *h = aim;
        return 1;
    }
    return 0;
}

/* Use the value and its derivative where a bracket may end and the next one start: at an extremum. If
   the value is 0, the next bracket decides which side it is on. */
static void close_bracket(WithinStep *within, double h, double value, double slope)
{
    Bracket *bracket = within->bracket, *next = bracket + 1;
    const int has_same_sign = (value < 0) == (bracket->near_value < 0) && value != 0;
    if (--bracket->tries && has_same_sign
            && approach_extremum(bracket, value, slope, &bracket->far)) {
        return;
    }
    bracket->tries = 0;
    bracket->far_value = value != 0 ? value : bracket->near_value;
    next->near = value != 0 ? h : bracket->near;
    next->near_value = bracket->far_value;
}
