/* The motions in the lanes: loaded one after the other, and started. */

enum { MAX_REDUCTIONS = 25 };

/* Not set before they are needed, since they are large. */
typedef struct {
    real coefficients[MAX_EVENTS][EXTENSION_DEGREE + 1];    /* of the polynomial of each event */
    real states[EXTENSION_NODES][DIM];                      /* see extended_states() */
    Bracket brackets[LANES][MAX_BRACKETS];
} Workspace;

typedef struct {
    Task *task;
    Workspace *workspace;
    Motion motion;
    State end;
    real h;                                     /* length of the step */
    real before[MAX_EVENTS], after[MAX_EVENTS]; /* event values at its start and end */
    real next_sample;                           /* time of the next sample, or NaN */
    real dense_sample;                          /* and of the last of LEAST_SAMPLES, or NaN */
    mask several[MAX_EVENTS];                   /* whether an event may occur several times */
    mask dense;                                 /* whether an extension gives the samples */
    mask crossed;                               /* whether events may occur in the step */
    mask advancing, starting, loaded;           /* starting motions are new; loaded ones resume */
    WithinStep within[LANES];
} Lanes;

/* Load the next unfinished motion into a lane, if there is one. */
static __attribute__((noinline)) void load_motion(Lanes *lanes, int lane)
{
    Task *task = lanes->task;
    WithinStep *within = &lanes->within[lane];
    int64_t motion;
    within->mode = IDLE;
    while ((motion = __atomic_fetch_add(&task->next, 1, __ATOMIC_RELAXED)) < task->count) {
        Trajectory *trajectory = &task->trajectories[motion];
        if (trajectory->status <= RUNNING) {
            within->mode = ADVANCE;
            within->trajectory = trajectory;
            write_lane(&lanes->motion, MOTION_SIZE, lane, trajectory->motion);
            within->resolution = 0.4*LANE(lanes->motion.min_h, lane);
            within->terminal = -1;
            MASK_LANE(lanes->starting, lane) = trajectory->status == WAITING ? -1 : 0;
            MASK_LANE(lanes->loaded, lane) = -1;
            if (LANE(lanes->motion.attempts, lane) == 0) {
                keep_integrals(&lanes->motion, lane);
            }
#if HAS_SWITCHES
            if (trajectory->status == WAITING) {
                start_signs(&lanes->motion, lane);
            }
#endif
            return;
        }
    }
}

/* Copy a lane's mode and next sample into the vectors of all lanes. */
static void update_lane(Lanes *lanes, int lane)
{
    const Task *task = lanes->task;
    const WithinStep *within = &lanes->within[lane];
    const int has_sample = within->mode == ADVANCE && within->trajectory->rows < task->samples;
    LANE(lanes->next_sample, lane) = has_sample ? sample_time(task, within->trajectory, 0) : NAN;
    const int64_t later = LEAST_SAMPLES - 1;
    const int is_dense = LEAST_SAMPLES && within->mode == ADVANCE
        && within->trajectory->rows + later < task->samples;
    LANE(lanes->dense_sample, lane) = is_dense ? sample_time(task, within->trajectory, later) : NAN;
    MASK_LANE(lanes->advancing, lane) = within->mode == ADVANCE ? -1 : 0;
}

/* Event values of the motions just loaded. */
SELDOM static void evaluate_events(Lanes *lanes)
{
    const Task *task = lanes->task;
    for (int e = 0; e < task->event_count; e++) {
        const real value = event_value(&task->events[e], &lanes->motion.state,
                                       lanes->motion.params);
        lanes->before[e] = select(lanes->loaded, value, lanes->before[e]);
    }
    lanes->loaded = (mask){0};
}

/* Derivatives and first step sizes of the starting motions. One that resumes with other parameters
   keeps its step size, and has recorded its state. */
static void start_motions(Lanes *lanes)
{
    const Task *task = lanes->task;
    Motion *motion = &lanes->motion;
    State *state = &motion->state;
    real derivative[DIM];
    RHS(state->t, state->z, motion->params, derivative);
    for (int n = 0; n < DIM && IS_FSAL; n++) {
        state->derivative[n] = select(lanes->starting, derivative[n], state->derivative[n]);
    }
    const real duration = motion->t_end - state->t, zero = splat(0.0);
    const mask resuming = lanes->starting & less_than(zero, motion->attempts);
    const mask new = lanes->starting & ~resuming;
    real h = splat(task->fixed_h);
    if (!task->fixed_h && any(new)) {
        h = initial_step(state, derivative, motion->params, duration, new, task->rtol, task->atol);
        h = lane_fmax(h, 2.0*motion->min_h);
    }
    if (!task->fixed_h && any(resuming)) {
        const real longest = lane_fabs(duration), last = lane_fabs(motion->h);
        h = select(resuming, select(less_than(last, longest), last, longest), h);
    }
    motion->evaluations += select(resuming, splat(1.0), zero);
    motion->h = select(lanes->starting, lane_copysign(h, duration), motion->h);
#if HAS_POLYNOMIAL
    if (any(lanes->starting)) {
        start_polynomial(state, motion->h, derivative);
    }
#endif
    for (int lane = 0; lane < LANES; lane++) {
        WithinStep *within = &lanes->within[lane];
        const int is_sample = MASK_LANE(new, lane) && (task->samples < 0
            || (task->samples > 0
                && sample_time(task, within->trajectory, 0) == LANE(state->t, lane)));
        if (is_sample) {
            double start[STATE_SIZE];
            read_lane(state, STATE_SIZE, lane, start);
            append_row(task, within->trajectory, start);
        }
    }
    real check = splat(0.0);
    for (int n = 0; n < DIM; n++) {
        check += (derivative[n] - derivative[n]) + (state->z[n] - state->z[n]);
    }
    /* a motion without a finite derivative cannot start */
    const mask not_finite = lanes->starting & ~less_than(lane_fabs(check), splat(1.0));
    motion->reductions = select(not_finite, splat(MAX_REDUCTIONS + 2), motion->reductions);
}
