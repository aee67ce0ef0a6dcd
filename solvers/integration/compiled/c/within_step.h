/* Work within an accepted step, before its motion continues from the end: locate events and compute
   states at sample times. Each substep is a step of the same method from the same state, with a
   shorter h. */

enum { MAX_BRACKETS = (MAX_ROOTS + 1)*MAX_EVENTS };

typedef enum { IDLE, ADVANCE, LOCATE, SAMPLE } Mode;

/* A part of a step with at most one crossing of an event. Those of an event are adjacent. */
typedef struct {
    int event;
    int is_pending;                         /* not selected yet */
    int tries;                              /* to find an extremum at its end; then that is closed */
    double curvature;                       /* second derivative there, by a polynomial */
    double near, near_value;                /* an h before the event */
    double far, far_value;                  /* and one not before it */
    double aim, slope;                      /* estimates of the h of the event and of dvalue/dh */
} Bracket;

typedef struct {
    Mode mode;
    Trajectory *trajectory;
    int64_t rows, occurred[MAX_EVENTS];     /* before the step */
    double full_h, full_end[STATE_SIZE];    /* length of the step, and the state at its end */
    double h, end[STATE_SIZE];              /* the same up to a terminal event */
    double after[MAX_EVENTS];               /* event values at its end */
    int terminal;                           /* the event that ends the motion, or -1 */
    int is_dense;                           /* whether an extension gives the samples */
    Bracket *brackets;                      /* of each event in ascending order */
    int bracket_count;
    Bracket *bracket;                       /* the one being reduced, or NULL */
    double near_state[STATE_SIZE], far_state[STATE_SIZE];       /* at its ends */
    double last_h, last_value;              /* of the last substep within it */
    double start[STATE_SIZE];               /* state at the start of the step */
    double extremum_h, extremum[STATE_SIZE];        /* between two brackets, and the state there */
    int knows_near;                         /* whether near_state is known */
    int substeps, side;
    double resolution;                      /* difference below which times are equal */
} WithinStep;

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

/* Discard the rows and events that were written within the step. */
static void discard_step(WithinStep *within)
{
    within->terminal = -1;
    within->trajectory->rows = within->rows;
    memcpy(within->trajectory->occurred, within->occurred, sizeof within->occurred);
}
