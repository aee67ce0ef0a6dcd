/* Motions in memory and in lanes, and what is asked of them. Python lays out the same structures:
   every member is eight bytes long. */

enum { MOST_EVENTS = 8 };

/* A motion in every lane: where it is, how it goes, where it is to go. */
typedef struct {
    Place place;
    real h, previous, steps, rejected, trials, rounds, cuts;
    real t_end, shortest, params[PARAMETERS];
} Motion;

enum { MOTION = sizeof(Motion)/sizeof(real) };

enum Status { WAITING, RUNNING, FINISHED, EVENT, STEP_LIMIT, NOT_FINITE, STEP_TOO_SMALL,
              NO_CONVERGENCE };

/* A motion in memory. */
typedef struct {
    double numbers[MOTION];         /* as in Motion */
    int64_t status, rows;           /* rows: how many were written */
    int64_t occurred[MOST_EVENTS];
} Trajectory;

typedef struct {
    double value, sine, cosine;     /* where the event is; its sine and cosine if it is an angle */
    int64_t is_angle, index;        /* which angle, or else which number of the state */
    int64_t direction, terminal;
    int64_t keeps_extremes;         /* whether only two rows are kept, of the smallest and largest */
    int64_t kept_is_angle, kept;    /* value of what these say, named as the event's own */
} Event;

enum { ROW = 1 + STATE + ANGLES + SCALES };     /* t, z, turns, scale */

typedef struct {
    int64_t count;                  /* of trajectories */
    Trajectory *trajectories;
    int64_t next;                   /* the first that no lane has taken yet */
    double rtol, atol;
    double fixed;                   /* length of steps that are not controlled, else 0 */
    int64_t most_steps;
    int64_t samples;                /* number of times asked for, or -1 for the end of every step */
    const double *times;
    int64_t capacity;               /* rows for each trajectory */
    double *rows;
    int64_t events;
    const Event *event;
    int64_t occurrences;            /* rows for each event of each trajectory */
    double *event_rows;
    int64_t pauses;                 /* whether a motion waits when its rows are full */
    double patience;                /* seconds after which all motions wait, or 0 */
    const volatile int64_t *stop;   /* anything but 0 makes them wait, too */
} Task;

/* Copy numbers between a lane and memory. */
static inline void from_lane(const void *reals, int count, int lane, double *numbers)
{
    for (int k = 0; k < count; k++) {
        numbers[k] = NUMBER(((const real *)reals)[k], lane);
    }
}

static inline void to_lane(void *reals, int count, int lane, const double *numbers)
{
    for (int k = 0; k < count; k++) {
        NUMBER(((real *)reals)[k], lane) = numbers[k];
    }
}

static void write_row(double *row, const double *place)
{
    row[0] = place[0];
    memcpy(row + 1, place + offsetof(Place, z)/sizeof(real), STATE*sizeof(double));
    row += 1 + STATE;
    memcpy(row, place + offsetof(Place, turns)/sizeof(real), ANGLES*sizeof(double));
    memcpy(row + ANGLES, place + offsetof(Place, scale)/sizeof(real), SCALES*sizeof(double));
}

static void keep_row(const Task *task, Trajectory *trajectory, const double *place)
{
    const int64_t which = trajectory - task->trajectories;
    if (trajectory->rows < task->capacity) {
        write_row(task->rows + (which*task->capacity + trajectory->rows)*ROW, place);
    }
    trajectory->rows++;
}

/* What the extremes of an event are extremes of, where a row says. */
static double kept_value(const Event *event, const double *row)
{
    const int64_t i = event->kept;
    const double *z = row + 1, *turns = z + STATE;
    return event->kept_is_angle ? atan2(z[SINE[i]], z[SINE[i] + 1]) + 2*PI*turns[i] : z[i];
}

static void keep_extremes(const Event *event, double *rows, int is_first, const double *place)
{
    double row[ROW];
    write_row(row, place);
    const double value = kept_value(event, row);
    if (is_first || value < kept_value(event, rows)) {
        memcpy(rows, row, sizeof row);
    }
    if (is_first || value > kept_value(event, rows + ROW)) {
        memcpy(rows + ROW, row, sizeof row);
    }
}

static void keep_event(const Task *task, Trajectory *trajectory, int event, const double *place)
{
    const int64_t which = (trajectory - task->trajectories)*task->events + event;
    double *rows = task->event_rows + which*task->occurrences*ROW;
    const int64_t row = trajectory->occurred[event]++;
    if (task->event[event].keeps_extremes) {
        keep_extremes(&task->event[event], rows, row == 0, place);
    } else if (row < task->occurrences) {
        write_row(rows + row*ROW, place);
    }
}

/* What changes its sign where the event occurs. An angle far from it need not be exact. */
static real event_value(const Event *event, const Place *place)
{
    const int64_t i = event->index;
    if (!event->is_angle) {
        return place->z[i] - event->value;
    }
    const real s = place->z[SINE[i]], c = place->z[SINE[i] + 1];
    const real rough = rough_angle(place, (int)i) + 2*PI*place->turns[i] - event->value;
    /* on the event itself rounding leaves a few parts in 1e16: that is not before it */
    const real sine = s*event->cosine - c*event->sine;
    const real exact = chosen(below(size(sine), every(5e-16)), every(0.0), sine);
    return chosen(below(size(rough), every(1.0)), exact, rough);
}

/* Where a value that was x and is y has passed the event. */
static inline mask has_passed(const Event *event, real x, real y)
{
    const real zero = every(0.0);
    const mask up = below(x, zero) & ~below(y, zero), down = below(zero, x) & ~below(zero, y);
    return event->direction > 0 ? up : event->direction < 0 ? down : up | down;
}
