/* Structures that C and Python share. memory_layout.py reads this file and builds the same: one member
   a line, of eight bytes or an array of such; a `real` is a double in memory. */

/* A state in every lane: nothing but numbers, so that it can be copied number by number. */
typedef struct {
    real t;                     /* time */
    real t_low;                 /* rounding error of t */
    real z[DIM];                /* state of the form */
    real z_low[LOW_DIM];        /* rounding errors of z */
    real turns[ANGLES];         /* whole turns of angles known by sine and cosine */
    real derivative[FSAL_DIM];  /* dz/dt, from the last stage of the step before */
    real polynomial[POLYNOMIAL_DIM];    /* of the last step, see parallel.h and predictor.h */
    real length[LENGTHS];       /* h of that step */
    real origin[ORIGINS];       /* part of it at which the next step starts, see parallel.h */
    real jacobian_t[JACOBIANS]; /* point at which the Jacobian was evaluated */
    real jacobian_z[JACOBIAN_DIM];
    real rate[JACOBIANS];       /* part of the error that an iteration with it leaves */
    real order[VARIABLE_ORDERS];        /* index of the method of the next step, see order_choice.h */
    real last_order[VARIABLE_ORDERS];   /* the same of `polynomial` */
    real contraction[VARIABLE_ORDERS];  /* of Newton's iteration, in the last steps */
    real scale[SCALES];         /* exponent of the power of two taken out of the variation */
} State;

/* A motion in every lane. */
typedef struct {
    State state;
    real h;                     /* length of the next step */
    real previous_error;        /* binary logarithm of the last accepted step's error */
    real steps;                 /* accepted steps */
    real rejected;              /* rejected steps */
    real attempts;              /* steps computed */
    real evaluations;           /* of the right-hand side, by steps */
    real jacobians;             /* evaluations of the Jacobian */
    real reductions;            /* consecutive failures, each of which shortens the step */
    real t_end;                 /* or the end of the inputs in params, if these are held */
    real held;                  /* index of the values of held inputs that are in params */
    real min_h;                 /* shortest step */
    real longest;               /* longest accepted step */
    real last_switch;           /* time at which signs of switching functions changed last */
    real brief_parts;           /* number of such changes in next to no time */
    real recent;                /* functions that changed then, a bit each */
    real params[PARAMETERS];
} Motion;

enum { STATE_SIZE = sizeof(State)/sizeof(real), MOTION_SIZE = sizeof(Motion)/sizeof(real) };

/* A motion in memory. */
typedef struct {
    double motion[MOTION_SIZE]; /* one lane of a Motion */
    int64_t status;
    int64_t rows;               /* rows written */
    int64_t occurred[MAX_EVENTS];
} Trajectory;

/* A sample or an event of a motion. */
typedef struct {
    double t;
    double z[DIM];
    double turns[ANGLES];
    double scale[SCALES];
} Row;

typedef struct {
    double value;               /* value of the component at the event */
    double sine;                /* sine and cosine of the value, for an angle */
    double cosine;
    int64_t is_angle;           /* whether `index` counts angles, or else components of z */
    int64_t index;
    int64_t direction;
    int64_t terminal;
    int64_t extremes_only;      /* whether only the rows of smallest and largest value are kept */
    int64_t skip;               /* number of occurrences that come first and are not recorded */
    int64_t extremum_is_angle;  /* component whose extremes are kept, as above */
    int64_t extremum_index;
    int64_t is_switch;          /* whether `index` counts switching functions, see motion.h */
} Event;

typedef struct {
    int64_t count;              /* number of trajectories */
    Trajectory *trajectories;
    int64_t next;               /* first trajectory that no lane has loaded yet */
    double rtol;
    double atol;
    double fixed_h;             /* length of fixed steps, or 0 for step control */
    double collapse;            /* part of the longest step below which constraints are singular */
    int64_t max_steps;
    int64_t samples;            /* number of sample times, or -1 for the end of every step */
    const double *times;
    int64_t own_times;          /* `samples` if each motion has its own times, one row each; else 0 */
    int64_t capacity;           /* rows of each trajectory */
    Row *rows;
    int64_t event_count;
    const Event *events;
    int64_t event_capacity;     /* rows of each event of each trajectory */
    Row *event_rows;
    int64_t pauses;             /* whether a motion pauses when its rows are full */
    double time_limit;          /* seconds of processor time after which run() returns, or 0 */
    const volatile int64_t *stop;   /* run() returns once this is not 0 */
    int64_t holds;              /* number of values that held inputs have, one after the other */
    int64_t first_input;        /* index of the first input in params, and number of inputs */
    int64_t inputs;
    const double *hold_ends;    /* time at which each value ends; NaN behind the last of a motion */
    const double *hold_values;  /* values of all inputs, one after the other */
} Task;

/* Sizes for the comparison with Python's structures. */
const int64_t LAYOUT_SIZES[] = {sizeof(Trajectory), sizeof(Row), sizeof(Event), sizeof(Task)};
