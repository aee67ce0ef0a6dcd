/* Work within an accepted step, before its motion continues from the end: locate events and compute
   states at sample times. Each substep is a step of the same method from the same state, with a
   shorter h. */

enum { MAX_SUBSTEPS = 100, MAX_TRIES = 10, MAX_BRACKETS = (MAX_ROOTS + 1)*MAX_EVENTS };

typedef enum { IDLE, ADVANCE, LOCATE, SAMPLE } Mode;

/* A part of a step with at most one crossing of an event. Those of an event are adjacent. */
typedef struct {
    int event;
    int is_pending;                         /* not selected yet */
    int tries;                              /* to find an extremum at its end; then that is closed */
    double curvature;                       /* second derivative there, by a polynomial */
    double near, near_value;                /* an h before the event */
    double far, far_value;                  /* and one not before it */
} Bracket;

typedef struct {
    Mode mode;
    Trajectory *trajectory;
    int64_t rows, occurred[MAX_EVENTS];     /* before the step */
    double full_h, full_end[STATE_SIZE];    /* length of the step, and the state at its end */
    double h, end[STATE_SIZE];              /* the same up to a terminal event */
    double after[MAX_EVENTS];               /* event values at its end */
    int terminal;                           /* the event that ends the motion, or -1 */
    Bracket *brackets;                      /* of each event in ascending order */
    int bracket_count;
    Bracket *bracket;                       /* the one being reduced, or NULL */
    double far_state[STATE_SIZE];           /* state at its end */
    int substeps, side;
    double resolution;                      /* difference below which times are equal */
} WithinStep;

/* The next h within the bracket of an event: regula falsi, with the value at an end that stays
   halved (M. Dowell and P. Jarratt, BIT 11 (1971) 168-174); bisection if that converges slowly;
   never so close to an end that the times are equal. */
static double next_event_h(const WithinStep *within)
{
    const Bracket *bracket = within->bracket;
    const double x = bracket->near, y = bracket->far;
    const double u = bracket->near_value, v = bracket->far_value;
    const double aim = within->substeps < MAX_SUBSTEPS/2 ? (x*v - y*u)/(v - u) : (x + y)/2;
    const double margin = copysign(within->resolution, y - x);
    return margin > 0 ? fmin(fmax(aim, x + margin), y - margin)
                      : fmax(fmin(aim, x + margin), y - margin);
}

/* The h of the next sample, or 0 when all samples within the step are written. */
static double next_sample_h(const Task *task, WithinStep *within, double t, double t_low)
{
    Trajectory *trajectory = within->trajectory;
    while (trajectory->rows < task->samples) {
        const double h = (next_sample_time(task, trajectory) - t) - t_low;
        if (fabs(h) > fabs(within->h) + within->resolution) {
            return 0;
        }
        if (fabs(h - within->h) > within->resolution) {
            return h;
        }
        append_row(task, trajectory, within->end);
    }
    if (task->samples < 0) {
        append_row(task, trajectory, within->end);
    }
    return 0;
}

static void add_bracket(WithinStep *within, const Bracket *bracket)
{
    memcpy(&within->brackets[within->bracket_count++], bracket, sizeof *bracket);
}

/* Select a pending bracket, those of terminal events first; 0 if there is none. */
static int select_bracket(const Task *task, WithinStep *within)
{
    Bracket *selected = NULL;
    for (int k = 0; k < within->bracket_count; k++) {
        Bracket *bracket = &within->brackets[k];
        if (bracket->is_pending && (!selected || task->events[bracket->event].terminal
                                        > task->events[selected->event].terminal)) {
            selected = bracket;
        }
    }
    within->bracket = selected;
    if (selected) {
        selected->is_pending = 0;
        memcpy(within->far_state, within->full_end, sizeof within->far_state);
    }
    within->substeps = within->side = 0;
    return selected != NULL;
}

/* Use a located event: it ends the motion or is recorded, unless the motion ends before it. */
static void use_event(const Task *task, WithinStep *within)
{
    const Bracket *bracket = within->bracket;
    const int event = bracket->event;
    /* of simultaneous events those before the terminal one in the list count */
    const double later = fabs(bracket->far) - fabs(within->h);
    if (later > 0 || (later == 0 && within->terminal >= 0 && event > within->terminal)) {
        return;
    }
    if (task->events[event].terminal) {
        within->terminal = event;
        within->h = bracket->far;
        memcpy(within->end, within->far_state, sizeof within->end);
    } else {
        record_event(task, within->trajectory, event, within->far_state);
    }
}

/* The h of the next substep, or 0 when the work within the step is complete. */
static double next_h(const Task *task, WithinStep *within, double t, double t_low)
{
    for (;;) {
        if (within->mode == LOCATE) {
            const Bracket *bracket = within->bracket;
            const int is_wide = fabs(bracket->far - bracket->near) > 2*within->resolution;
            if (bracket->tries) {
                return bracket->far;
            }
            if (is_crossed(&task->events[bracket->event], bracket->near_value, bracket->far_value)) {
                if (is_wide && within->substeps < MAX_SUBSTEPS) {
                    return next_event_h(within);
                }
                use_event(task, within);
            }
        }
        if (within->mode == SAMPLE || !select_bracket(task, within)) {
            break;
        }
        within->mode = LOCATE;
    }
    if (within->mode != SAMPLE && within->terminal >= 0) {
        record_event(task, within->trajectory, within->terminal, within->end);
    }
    within->mode = SAMPLE;
    return next_sample_h(task, within, t, t_low);
}

/* Start the work within an accepted step of length h. */
static void begin_within_step(WithinStep *within, double h, const double *end)
{
    within->rows = within->trajectory->rows;
    memcpy(within->occurred, within->trajectory->occurred, sizeof within->occurred);
    within->full_h = within->h = h;
    memcpy(within->full_end, end, sizeof within->full_end);
    memcpy(within->end, end, sizeof within->end);
    within->bracket_count = 0;
    within->bracket = NULL;
    within->terminal = -1;
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

/* Use a substep of length h that ends at `state`, where the event being located has `value`, and the
   derivative `slope`. */
static void use_substep(
    const Task *task, WithinStep *within, double h, const double *state, double value,
    double slope)
{
    if (within->mode == SAMPLE) {
        append_row(task, within->trajectory, state);
        return;
    }
    Bracket *bracket = within->bracket;
    within->substeps++;
    if (bracket->tries) {
        close_bracket(within, h, value, slope);
        memcpy(within->far_state, state, sizeof within->far_state);
    } else if ((value < 0) == (bracket->near_value < 0) && value != 0) {
        bracket->near = h;
        bracket->near_value = value;
        bracket->far_value *= within->side < 0 ? 0.5 : 1;
        within->side = -1;
    } else {
        bracket->far = h;
        bracket->far_value = value;
        memcpy(within->far_state, state, sizeof within->far_state);
        bracket->near_value *= within->side > 0 ? 0.5 : 1;
        within->side = 1;
    }
}

/* Discard the rows and events that were written within the step. */
static void discard_step(WithinStep *within)
{
    within->terminal = -1;
    within->trajectory->rows = within->rows;
    memcpy(within->trajectory->occurred, within->occurred, sizeof within->occurred);
}
