/* Work within an accepted step, before its motion continues from the end: locate events and compute
   states at sample times. Each substep is a step of the same method from the same state, with a
   shorter h. */

enum { MAX_SUBSTEPS = 100, MAX_BRACKETS = (INTERPOLATES ? 8 : 2)*MAX_EVENTS };

typedef enum { IDLE, ADVANCE, LOCATE, SAMPLE } Mode;

/* A crossing of an event between two parts of a step: its value has different signs there. */
typedef struct {
    int event;
    double near, near_value;                /* an h before the event */
    double far, far_value, far_state[STATE_SIZE];   /* and one not before it */
    /* two crossings are sought where the signs are equal, by this number of attempts */
    int probes;
    double aim;                             /* h of the next attempt */
    double near_slope, far_slope;           /* derivatives times the step */
    int is_void;                            /* there is no crossing */
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
    uint64_t pending;                       /* brackets to be reduced, one bit each */
    Bracket *bracket;                       /* the one being reduced, or NULL */
    int substeps, side;
    double resolution;                      /* difference below which times are equal */
} WithinStep;

/* The next h within the bracket of an event: regula falsi, with the value at an end that stays
   halved (M. Dowell and P. Jarratt, BIT 11 (1971) 168-174); bisection if that converges slowly;
   never so close to an end that the times are equal. */
static double next_event_h(const WithinStep *within)
{
    const Bracket *bracket = within->bracket;
    if (bracket->probes) {
        return bracket->aim;
    }
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
        const double h = (task->times[trajectory->rows] - t) - t_low;
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
    if (within->bracket_count < MAX_BRACKETS) {
        within->pending |= (uint64_t)1 << within->bracket_count;
        memcpy(&within->brackets[within->bracket_count++], bracket, sizeof *bracket);
    }
}

/* Select a pending bracket, those of terminal events first; 0 if there is none. */
static int select_bracket(const Task *task, WithinStep *within)
{
    int selected = -1;
    for (int k = 0; k < within->bracket_count; k++) {
        if (within->pending >> k & 1 && (selected < 0
                || task->events[within->brackets[k].event].terminal
                    > task->events[within->brackets[selected].event].terminal)) {
            selected = k;
        }
    }
    within->bracket = selected < 0 ? NULL : &within->brackets[selected];
    within->pending &= selected < 0 ? 0 : ~((uint64_t)1 << selected);
    within->substeps = within->side = 0;
    return selected >= 0;
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
        memcpy(within->end, bracket->far_state, sizeof within->end);
    } else {
        record_event(task, within->trajectory, event, bracket->far_state);
    }
}

/* The h of the next substep, or 0 when the work within the step is complete. */
static double next_h(const Task *task, WithinStep *within, double t, double t_low)
{
    for (;;) {
        if (within->mode == LOCATE) {
            const Bracket *bracket = within->bracket;
            const int is_wide = fabs(bracket->far - bracket->near) > 2*within->resolution;
            if (is_wide && within->substeps < MAX_SUBSTEPS && !bracket->is_void) {
                return next_event_h(within);
            }
            if (!bracket->is_void) {
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
    within->pending = 0;
    within->bracket_count = 0;
    within->bracket = NULL;
    within->terminal = -1;
}

/* Use the value at an extremum: if its sign differs, there is a crossing on either side. */
static void use_probe(
    const Task *task, WithinStep *within, double h, const double *state, double value)
{
    Bracket *bracket = within->bracket;
    const Event *event = &task->events[bracket->event];
    const double x = bracket->near_value, y = bracket->far_value, full = within->full_h;
    if (value*x < 0) {
        Bracket second;
        memcpy(&second, bracket, sizeof second);
        second.probes = bracket->probes = 0;
        second.near = bracket->far = h;
        second.near_value = bracket->far_value = value;
        memcpy(bracket->far_state, state, sizeof bracket->far_state);
        bracket->is_void = !is_crossed(event, x, value);
        if (is_crossed(event, value, y)) {
            add_bracket(within, &second);
        }
        return;
    }
    bracket->is_void = --bracket->probes == 0;
    bracket->aim = full*quartic_extremum(
        x, bracket->near_slope, y, bracket->far_slope, h/full, value);
}

/* Use a substep of length h that ends at `state`, where the event being located has `value`. */
static void use_substep(
    const Task *task, WithinStep *within, double h, const double *state, double value)
{
    if (within->mode == SAMPLE) {
        append_row(task, within->trajectory, state);
        return;
    }
    Bracket *bracket = within->bracket;
    if (bracket->probes) {
        use_probe(task, within, h, state, value);
        return;
    }
    within->substeps++;
    if ((value < 0) == (bracket->near_value < 0) && value != 0) {
        bracket->near = h;
        bracket->near_value = value;
        bracket->far_value *= within->side < 0 ? 0.5 : 1;
        within->side = -1;
    } else {
        bracket->far = h;
        bracket->far_value = value;
        memcpy(bracket->far_state, state, sizeof bracket->far_state);
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
