/* What is left to do within a step that was accepted, before its motion goes on from its end: find
   the times of events, give the states at times that were asked for. Each try is a step of the same
   method from the same place, with a shorter h. */

enum { MOST_TRIES = 100 };

typedef enum { IDLE, ADVANCE, LOCATE, SAMPLE } Mode;

typedef struct {
    Mode mode;
    Trajectory *trajectory;
    int64_t rows, occurred[MOST_EVENTS];    /* when the step began */
    double whole, whole_end[PLACE];         /* length of the step, and its end */
    double until, end[PLACE];               /* the same for the part of it that counts */
    double before[MOST_EVENTS], after[MOST_EVENTS];  /* values of the events */
    int waiting;                            /* events that are still to be located, a bit each */
    int stopping;                           /* the event that ends the motion, or -1 */
    int event, tries, side;                 /* the one being located */
    double near, near_value;                /* not yet past it */
    double far, far_value, far_place[PLACE];
    double resolution;                      /* times closer than this are the same */
} Errand;

/* The next try within the bracket of an event: regula falsi, with the value of an end that stays
   halved (M. Dowell and P. Jarratt, BIT 11 (1971) 168-174); bisection if that takes long; never so
   close to an end that times cannot be told apart. */
static double next_try(const Errand *errand)
{
    const double x = errand->near, y = errand->far;
    const double u = errand->near_value, v = errand->far_value;
    const double aim = errand->tries < MOST_TRIES/2 ? (x*v - y*u)/(v - u) : (x + y)/2;
    const double closest = copysign(errand->resolution, y - x);
    return closest > 0 ? fmin(fmax(aim, x + closest), y - closest)
                       : fmax(fmin(aim, x + closest), y - closest);
}

/* The length of the next try for a sample, or 0 when all that lie in the step are kept. */
static double next_sample(const Task *task, Errand *errand, double t, double t_low)
{
    Trajectory *trajectory = errand->trajectory;
    while (trajectory->rows < task->samples) {
        const double wait = (task->times[trajectory->rows] - t) - t_low;
        if (fabs(wait) > fabs(errand->until) + errand->resolution) {
            return 0;
        }
        if (fabs(wait - errand->until) > errand->resolution) {
            return wait;
        }
        keep_row(task, trajectory, errand->end);
    }
    if (task->samples < 0) {
        keep_row(task, trajectory, errand->end);
    }
    return 0;
}

/* Begin with an event that changed its sign, one that ends the motion first. */
static int next_event(const Task *task, Errand *errand)
{
    errand->event = -1;
    for (int e = 0; e < task->events; e++) {
        if (errand->waiting >> e & 1 && (errand->event < 0
                || task->event[e].terminal > task->event[errand->event].terminal)) {
            errand->event = e;
        }
    }
    if (errand->event < 0) {
        return 0;
    }
    errand->waiting &= ~(1 << errand->event);
    errand->tries = errand->side = 0;
    errand->near = 0;
    errand->near_value = errand->before[errand->event];
    errand->far = errand->whole;
    errand->far_value = errand->after[errand->event];
    memcpy(errand->far_place, errand->whole_end, sizeof errand->far_place);
    return 1;
}

/* The event is found: it ends the motion, or it is kept, unless the motion ends before. */
static void found_event(const Task *task, Errand *errand)
{
    /* of events at the same time those count that come first in their list */
    const double later = fabs(errand->far) - fabs(errand->until);
    if (later > 0 || (later == 0 && errand->stopping >= 0 && errand->event > errand->stopping)) {
        return;
    }
    if (task->event[errand->event].terminal) {
        errand->stopping = errand->event;
        errand->until = errand->far;
        memcpy(errand->end, errand->far_place, sizeof errand->end);
    } else {
        keep_event(task, errand->trajectory, errand->event, errand->far_place);
    }
}

/* The length of the next try, or 0 when nothing is left to do. */
static double next_length(const Task *task, Errand *errand, double t, double t_low)
{
    for (;;) {
        if (errand->mode == LOCATE) {
            if (fabs(errand->far - errand->near) > 2*errand->resolution
                    && errand->tries < MOST_TRIES) {
                return next_try(errand);
            }
            found_event(task, errand);
        }
        if (errand->mode == SAMPLE || !next_event(task, errand)) {
            break;
        }
        errand->mode = LOCATE;
    }
    if (errand->mode != SAMPLE && errand->stopping >= 0) {
        keep_event(task, errand->trajectory, errand->stopping, errand->end);
    }
    errand->mode = SAMPLE;
    return next_sample(task, errand, t, t_low);
}

/* A step was accepted that ends at `end`, past the events in `waiting`. */
static void begin_errand(Errand *errand, double length, const double *end, int waiting)
{
    errand->rows = errand->trajectory->rows;
    memcpy(errand->occurred, errand->trajectory->occurred, sizeof errand->occurred);
    errand->whole = errand->until = length;
    memcpy(errand->whole_end, end, sizeof errand->whole_end);
    memcpy(errand->end, end, sizeof errand->end);
    errand->waiting = waiting;
    errand->stopping = -1;
}

/* A try of length h ended at `place`, where the event that is being located has this value. */
static void take_try(const Task *task, Errand *errand, double h, const double *place, double value)
{
    if (errand->mode == SAMPLE) {
        keep_row(task, errand->trajectory, place);
        return;
    }
    errand->tries++;
    if ((value < 0) == (errand->near_value < 0) && value != 0) {
        errand->near = h;
        errand->near_value = value;
        errand->far_value *= errand->side < 0 ? 0.5 : 1;
        errand->side = -1;
    } else {
        errand->far = h;
        errand->far_value = value;
        memcpy(errand->far_place, place, sizeof errand->far_place);
        errand->near_value *= errand->side > 0 ? 0.5 : 1;
        errand->side = 1;
    }
}

/* Forget what the step has kept. */
static void undo_errand(Errand *errand)
{
    errand->stopping = -1;
    errand->trajectory->rows = errand->rows;
    memcpy(errand->trajectory->occurred, errand->occurred, sizeof errand->occurred);
}
