/* Work within an accepted step, before its motion continues from the end: locate events and compute
   states at sample times. Each substep is a step of the same method from the same state, with a
   shorter h. */

enum { MAX_SUBSTEPS = 100 };

typedef enum { IDLE, ADVANCE, LOCATE, SAMPLE } Mode;

typedef struct {
    Mode mode;
    Trajectory *trajectory;
    int64_t rows, occurred[MAX_EVENTS];     /* before the step */
    double full_h, full_end[STATE_SIZE];    /* length of the step, and the state at its end */
    double h, end[STATE_SIZE];              /* the same up to a terminal event */
    double before[MAX_EVENTS], after[MAX_EVENTS];   /* event values at both ends */
    int pending;                            /* events to be located, one bit each */
    int terminal;                           /* the event that ends the motion, or -1 */
    int event, substeps, side;              /* the event being located */
    double near, near_value;                /* bracket: an h before the event */
    double far, far_value, far_state[STATE_SIZE];   /* and one not before it */
    double resolution;                      /* difference below which times are equal */
} WithinStep;

/* The next h within the bracket of an event: regula falsi, with the value at an end that stays
   halved (M. Dowell and P. Jarratt, BIT 11 (1971) 168-174); bisection if that converges slowly;
   never so close to an end that the times are equal. */
static double next_event_h(const WithinStep *within)
{
    const double x = within->near, y = within->far;
    const double u = within->near_value, v = within->far_value;
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

/* Select a pending event, terminal ones first; 0 if there is none. */
static int select_event(const Task *task, WithinStep *within)
{
    within->event = -1;
    for (int e = 0; e < task->event_count; e++) {
        if (within->pending >> e & 1 && (within->event < 0
                || task->events[e].terminal > task->events[within->event].terminal)) {
            within->event = e;
        }
    }
    if (within->event < 0) {
        return 0;
    }
    within->pending &= ~(1 << within->event);
    within->substeps = within->side = 0;
    within->near = 0;
    within->near_value = within->before[within->event];
    within->far = within->full_h;
    within->far_value = within->after[within->event];
    memcpy(within->far_state, within->full_end, sizeof within->far_state);
    return 1;
}

/* Use a located event: it ends the motion or is recorded, unless the motion ends before it. */
static void use_event(const Task *task, WithinStep *within)
{
    /* of simultaneous events those before the terminal one in the list count */
    const double later = fabs(within->far) - fabs(within->h);
    if (later > 0 || (later == 0 && within->terminal >= 0 && within->event > within->terminal)) {
        return;
    }
    if (task->events[within->event].terminal) {
        within->terminal = within->event;
        within->h = within->far;
        memcpy(within->end, within->far_state, sizeof within->end);
    } else {
        record_event(task, within->trajectory, within->event, within->far_state);
    }
}

/* The h of the next substep, or 0 when the work within the step is complete. */
static double next_h(const Task *task, WithinStep *within, double t, double t_low)
{
    for (;;) {
        if (within->mode == LOCATE) {
            if (fabs(within->far - within->near) > 2*within->resolution
                    && within->substeps < MAX_SUBSTEPS) {
                return next_event_h(within);
            }
            use_event(task, within);
        }
        if (within->mode == SAMPLE || !select_event(task, within)) {
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

/* Start the work within an accepted step of length h that crosses the events in `pending`. */
static void begin_within_step(WithinStep *within, double h, const double *end, int pending)
{
    within->rows = within->trajectory->rows;
    memcpy(within->occurred, within->trajectory->occurred, sizeof within->occurred);
    within->full_h = within->h = h;
    memcpy(within->full_end, end, sizeof within->full_end);
    memcpy(within->end, end, sizeof within->end);
    within->pending = pending;
    within->terminal = -1;
}

/* Use a substep of length h that ends at `state`, where the event being located has `value`. */
static void use_substep(
    const Task *task, WithinStep *within, double h, const double *state, double value)
{
    if (within->mode == SAMPLE) {
        append_row(task, within->trajectory, state);
        return;
    }
    within->substeps++;
    if ((value < 0) == (within->near_value < 0) && value != 0) {
        within->near = h;
        within->near_value = value;
        within->far_value *= within->side < 0 ? 0.5 : 1;
        within->side = -1;
    } else {
        within->far = h;
        within->far_value = value;
        memcpy(within->far_state, state, sizeof within->far_state);
        within->near_value *= within->side > 0 ? 0.5 : 1;
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
