/* Motions, as many at once as there are lanes, each with its own step size.

   Every iteration of run() makes one step in every lane, from the state of the lane's motion:
   either to advance the motion, or within an accepted step. A lane whose motion ends loads the next
   one. The result of a motion depends on no other motion. */

/* An angle changes by about its mean velocity times h; the rest is whole turns. Returns 0, or NaN
   where they cannot be counted. */
static inline real count_turns(const State *start, real h, State *end)
{
    real check = splat(0.0);
    for (int a = 0; a < ANGLES; a++) {
        const real change = h*(start->z[RATE[a]] + end->z[RATE[a]])*0.5;
        const real excess = approximate_angle(start, a) + change - approximate_angle(end, a);
        end->turns[a] = start->turns[a] + lane_round(excess*(0.5/PI));
        check += excess - excess;
    }
    return check;
}

enum { MAX_REDUCTIONS = 25, STEPS_BETWEEN_CHECKS = 64 };

/* Of each event; not set before they are needed, since they are large. */
typedef struct {
    real coefficients[MAX_EVENTS][EXTENSION_DEGREE + 1];
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
    mask several[MAX_EVENTS];                   /* whether an event may occur several times */
    mask advancing, starting, loaded;           /* starting motions are new; loaded ones resume */
    WithinStep within[LANES];
} Lanes;

/* Load the next unfinished motion into a lane, if there is one. */
static void load_motion(Lanes *lanes, int lane)
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
    LANE(lanes->next_sample, lane) = has_sample ? next_sample_time(task, within->trajectory) : NAN;
    MASK_LANE(lanes->advancing, lane) = within->mode == ADVANCE ? -1 : 0;
}

/* Event values of the motions just loaded. */
static void evaluate_events(Lanes *lanes)
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
                && next_sample_time(task, within->trajectory) == LANE(state->t, lane)));
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

/* Shorten the step of a lane after a failure of the step, of size h, or within it. */
static void fail_step(Motion *motion, WithinStep *within, int lane, double h)
{
    if (within->mode != ADVANCE) {
        discard_step(within);
    }
    LANE(motion->h, lane) = (within->mode == ADVANCE ? h : within->full_h)/4;
    LANE(motion->reductions, lane) += 1;
    within->mode = ADVANCE;
#if VARIES_ORDER
    lower_order(&motion->state);
#endif
}

/* Use the end of a substep of a lane; `numbers` are those of its state. */
static void use_state(
    Lanes *lanes, int lane, double h, const State *state, const double *numbers)
{
    WithinStep *within = &lanes->within[lane];
    double value = 0, slope = 0;
    if (within->mode == LOCATE) {
        const Event *event = &lanes->task->events[within->bracket->event];
        const real values = event_value(event, state, lanes->motion.params);
        value = LANE(values, lane);
        if (within->bracket->tries) {
            slope = event_slope(event, state, lanes->motion.params, lane);
            LANE(lanes->motion.evaluations, lane) += 1;
        }
    }
    use_substep(lanes->task, within, h, numbers, value, slope);
}

#if INTERPOLATES
/* The state after a part h of the step of the only lane; returns whether it is finite. */
static int state_within(Lanes *lanes, WithinStep *within, double h, State *state)
{
    Motion *motion = &lanes->motion;
    const State *start = &motion->state, *full = (const State *)within->full_end;
    double check = 0;
    *state = *start;
    motion->evaluations += step_within(lanes->task, start, full, h, motion->params, state);
    for (int n = 0; n < DIM; n++) {
        check += state->z[n] - state->z[n];
    }
    normalise_angles(state);
    rescale_variation(start, state);
    return check + count_turns(start, h, state) == 0;
}

static int substep(Lanes *lanes, WithinStep *within, double h)
{
    const Task *task = lanes->task;
    State state;
    double numbers[STATE_SIZE];
    const int is_finite = state_within(lanes, within, h, &state);
    read_lane(&state, STATE_SIZE, 0, numbers);
    use_state(lanes, 0, h, &state, numbers);
    return is_finite;
}

#endif

/* Bracket all crossings of an event within the step of a lane. */
static void bracket_crossings(const Lanes *lanes, int lane, WithinStep *within, int e)
{
    const Event *event = &lanes->task->events[e];
    const double before = LANE(lanes->before[e], lane), after = within->after[e];
    double coefficients[EXTENSION_DEGREE + 1];
    Extremum extrema[MAX_ROOTS];
    Bracket bracket = {.event = e, .is_pending = 1, .tries = MAX_TRIES, .near_value = before};
    int count = 0;
    if (MASK_LANE(lanes->several[e], lane)) {
        read_lane(lanes->workspace->coefficients[e], EXTENSION_DEGREE + 1, lane, coefficients);
        count = separate_crossings(coefficients, extrema);
    }
    if (count == 0 && !is_crossed(event, before, after)) {
        return;     /* an event at the start is not in this step */
    }
    for (int k = 0; k < count; k++) {
        bracket.far = extrema[k].part*within->full_h;
        bracket.curvature = extrema[k].curvature/(within->full_h*within->full_h);
        add_bracket(within, &bracket);
        bracket.near = bracket.far;
    }
    bracket.tries = 0;
    bracket.far = within->full_h;
    bracket.far_value = after;
    add_bracket(within, &bracket);
}

/* Evaluate a lane's step; return whether its motion moves to the end of the step. */
static int process_step(Lanes *lanes, int lane, int accepted, int failed)
{
    const Task *task = lanes->task;
    Motion *motion = &lanes->motion;
    WithinStep *within = &lanes->within[lane];
    if (within->mode == IDLE) {
        return 0;
    }
    double end[STATE_SIZE];
    read_lane(&lanes->end, STATE_SIZE, lane, end);
    const double h = LANE(lanes->h, lane);
    if (failed) {
        fail_step(motion, within, lane, h);
        return 0;
    }
    if (within->mode == ADVANCE) {
        if (!accepted) {
            return 0;
        }
        begin_within_step(within, h, end);
        for (int e = 0; e < task->event_count; e++) {
            within->after[e] = LANE(lanes->after[e], lane);
            bracket_crossings(lanes, lane, within, e);
        }
    } else {
        use_state(lanes, lane, h, &lanes->end, end);
    }
    double next;
    while ((next = next_h(task, within, LANE(motion->state.t, lane),
                          LANE(motion->state.t_low, lane))) != 0) {
#if INTERPOLATES
        if (!substep(lanes, within, next)) {
            fail_step(motion, within, lane, h);
            return 0;
        }
#else
        LANE(lanes->h, lane) = next;
        return 0;
#endif
    }
    within->mode = ADVANCE;
    write_lane(&lanes->end, STATE_SIZE, lane, within->end);
    for (int e = 0; e < task->event_count; e++) {
        LANE(lanes->after[e], lane) = within->after[e];
    }
    return 1;
}

/* Status of a lane's motion after a step: RUNNING if it continues. */
static enum Status status(const Lanes *lanes, int lane)
{
    const Task *task = lanes->task;
    const Motion *motion = &lanes->motion;
    const WithinStep *within = &lanes->within[lane];
    const double left = fabs(LANE(motion->t_end, lane) - LANE(motion->state.t, lane));
    const double h = fabs(LANE(motion->h, lane));
    if (within->terminal >= 0) {
        return EVENT;
    }
    if (left == 0) {
        return FINISHED;
    }
    const double reductions = LANE(motion->reductions, lane);
    if (reductions > (task->fixed_h ? 0 : MAX_REDUCTIONS)) {
        return IS_EXPLICIT || reductions > MAX_REDUCTIONS + 1 ? NOT_FINITE : NO_CONVERGENCE;
    }
    if (LANE(motion->steps, lane) >= (double)task->max_steps) {
        return STEP_LIMIT;
    }
    return h < LANE(motion->min_h, lane) && h < left ? STEP_TOO_SMALL : RUNNING;
}

/* Whether the rows have no room for the next step. */
static int is_full(const Task *task, const Trajectory *trajectory)
{
    int full = task->samples < 0 && trajectory->rows >= task->capacity;
    for (int e = 0; e < task->event_count; e++) {
        full |= trajectory->occurred[e] >= task->event_capacity;
    }
    return full && task->pauses;
}

/* Let the motion of a lane resume with the next held inputs; returns whether there are any. */
static int change_inputs(Lanes *lanes, int lane)
{
    const Task *task = lanes->task;
    Motion *motion = &lanes->motion;
    const int64_t held = (int64_t)LANE(motion->held, lane) + 1;
    if (held >= task->holds) {
        return 0;
    }
    for (int64_t u = 0; u < task->inputs; u++) {
        LANE(motion->params[task->first_input + u], lane) = task->hold_values[held*task->inputs + u];
    }
    LANE(motion->held, lane) = (double)held;
    LANE(motion->t_end, lane) = task->hold_ends[held];
    MASK_LANE(lanes->starting, lane) = -1;
    return 1;
}

/* After a step, store a lane's motion if it ends or pauses, and load the next one; returns whether
   the lane becomes idle. */
static int finish_step(Lanes *lanes, int lane, int returning)
{
    WithinStep *within = &lanes->within[lane];
    Trajectory *trajectory = within->trajectory;
    const int advances = within->mode == ADVANCE;
    enum Status now = advances ? status(lanes, lane) : RUNNING;
    if (now == FINISHED && change_inputs(lanes, lane)) {
        now = RUNNING;
    }
    if (advances && (now != RUNNING || returning || is_full(lanes->task, trajectory))) {
        read_lane(&lanes->motion, MOTION_SIZE, lane, trajectory->motion);
        const int waits = now == RUNNING && MASK_LANE(lanes->starting, lane);
        trajectory->status = waits ? WAITING : now;
        MASK_LANE(lanes->starting, lane) = 0;
        within->mode = IDLE;
        if (!returning) {
            load_motion(lanes, lane);
        }
    }
    update_lane(lanes, lane);
    return advances && within->mode == IDLE;
}

/* Evaluate the events at the end of a step; returns the lanes in which one may occur. */
static __attribute__((noinline)) mask events_in_step(Lanes *lanes, const StepResult *result)
{
    const Task *task = lanes->task;
    const State *start = &lanes->motion.state, *end = &lanes->end;
    Workspace *workspace = lanes->workspace;
    mask occurring = {0}, several = {0};
    for (int e = 0; e < task->event_count; e++) {
        const Event *event = &task->events[e];
        const real before = lanes->before[e], after = lanes->after[e] =
            event_value(event, end, lanes->motion.params);
        const mask moves = less_than(before, splat(0.0)) | less_than(splat(0.0), before);
        const mask recurs = has_several(event, start, end, result, lanes->h, lanes->motion.params,
                                        before, after, workspace->coefficients[e]);
        lanes->several[e] = lanes->advancing & (recurs | ~moves);
        several |= lanes->several[e];
        occurring |= has_crossed(event, before, after);
    }
    if (!any(several)) {
        return occurring;
    }
    real changes[EXTENSION_NODES][DIM];
    lanes->motion.evaluations += select(several, splat(ROUNDS*EXTENSION_NODES), splat(0.0));
    extend(start, end, result, lanes->h, lanes->motion.params, changes);
    for (int e = 0; e < task->event_count; e++) {
        const Event *event = &task->events[e];
        real *coefficients = workspace->coefficients[e];
        if (ROUNDS > 0 && !event->is_switch) {
            extended_polynomial(event, start, changes, lanes->before[e], coefficients);
        }
        switching_polynomial(event, start, end, lanes->h, lanes->motion.params, lanes->before[e],
                             lanes->after[e], EXTENSION_DEGREE, coefficients);
    }
    return occurring | several;
}

/* One step in every lane; returns the lanes that need to be processed one by one. */
static __attribute__((noinline)) mask advance(Lanes *lanes, mask *accepted, mask *failed)
{
    const Task *task = lanes->task;
    Motion *motion = &lanes->motion;
    State *state = &motion->state, *end = &lanes->end;
    const mask advancing = lanes->advancing;
    const real left = (motion->t_end - state->t) - state->t_low;
    const mask last = advancing & ~less_than(lane_fabs(motion->h)*(1 + 1e-9), lane_fabs(left));
    lanes->h = select(advancing, select(last, left, motion->h), lanes->h);
    StepResult result;
    step(task, state, lanes->h, motion->params, end, &result);
    motion->evaluations += result.evaluations;
    motion->jacobians += result.jacobians;
    end->t = select(last, motion->t_end, end->t);
    end->t_low = select(last, splat(0.0), end->t_low);
    real check = splat(0.0);
    for (int n = 0; n < DIM; n++) {
        check += end->z[n] - end->z[n];
    }
    *failed = ~less_than(lane_fabs(check), splat(1.0));
    *accepted = advancing & ~*failed;
    if (!task->fixed_h) {
        *failed |= advancing & ~less_than(result.squared_error, splat(INFINITY));
        *accepted &= ~less_than(splat(1.0), result.squared_error) & ~*failed;
        const real factor =
            step_factor(&result, *accepted, lanes->h, state, &motion->previous_error);
        const real h = select(*accepted, motion->h, lanes->h)*factor;
        motion->h = select(advancing & ~*failed, h, motion->h);
#if INTERPOLATES
        if (advancing & ~*failed & ~*accepted) {
            keep_polynomial(state, end);
        }
#endif
#if VARIES_ORDER
        choose_order(state, result.contraction, factor, end);
#endif
    }
    normalise_angles(end);
    rescale_variation(state, end);
    check = count_turns(state, lanes->h, end);
    *failed |= ~less_than(lane_fabs(check), splat(1.0));
    *accepted &= ~*failed;
    const real one = splat(1.0);
    motion->attempts += one;
    motion->rejected += select(advancing & ~*accepted, one, splat(0.0));
    motion->reductions = select(*accepted, splat(0.0), motion->reductions);
    mask attention = *failed | last | ~advancing | less_than(lane_fabs(motion->h), motion->min_h);
    if (task->event_count) {
        attention |= *accepted & events_in_step(lanes, &result);
    }
    attention |= less_than(splat((double)task->max_steps), motion->steps + 2.0);
    if (task->samples < 0) {
        attention |= *accepted;
    }
    const real wait = lane_fabs(lanes->next_sample - state->t);
    return attention | less_than(wait, lane_fabs(lanes->h) + motion->min_h);
}

/* Move the motions of accepted steps to the ends of these steps. */
static void move(Lanes *lanes, mask accepted)
{
    if (!any(accepted)) {
        return;
    }
    real *to = (real *)&lanes->motion.state;
    const real *from = (const real *)&lanes->end;
    if (LANES == 1) {
        memcpy(to, from, sizeof lanes->end);
    }
    for (int k = 0; k < STATE_SIZE && LANES > 1; k++) {
        to[k] = select(accepted, from[k], to[k]);
    }
    for (int e = 0; e < lanes->task->event_count; e++) {
        lanes->before[e] = select(accepted, lanes->after[e], lanes->before[e]);
    }
    lanes->motion.steps += select(accepted, splat(1.0), splat(0.0));
}

static int must_return(const Task *task, clock_t started)
{
    return *task->stop || (task->time_limit > 0 && started
                           && (double)(clock() - started) > task->time_limit*CLOCKS_PER_SEC);
}

/* Continue all unfinished motions of the task, until none is left or it is time to return. Several
   threads may run one task. */
void run(Task *task)
{
#ifdef __AVX__
    /* upper halves of registers that Python left in use slow down functions of libm without AVX */
    __builtin_ia32_vzeroupper();
#endif
    Lanes lanes = {.task = task};
    Workspace workspace;
    lanes.workspace = &workspace;
    clock_t started = 0;
    int returning = 0, busy = 0;
    for (int lane = 0; lane < LANES; lane++) {
        lanes.within[lane].brackets = workspace.brackets[lane];
        load_motion(&lanes, lane);
        update_lane(&lanes, lane);
        busy += lanes.within[lane].mode != IDLE;
    }
    for (int64_t count = 0; busy; count++) {
        /* a motion may end where it starts, and the next one, too */
        while (any(lanes.starting)) {
            const mask starting = lanes.starting;
            start_motions(&lanes);
            lanes.starting = (mask){0};
            for (int lane = 0; lane < LANES; lane++) {
                if (MASK_LANE(starting, lane)) {
                    busy -= finish_step(&lanes, lane, returning);
                }
            }
        }
        if (any(lanes.loaded)) {
            evaluate_events(&lanes);
        }
        if (count % STEPS_BETWEEN_CHECKS == 0) {
            /* the clock takes as long as some steps: short runs do without */
            started = count == STEPS_BETWEEN_CHECKS ? clock() : started;
            returning |= must_return(task, started);
        }
        mask accepted, failed;
        const mask attention = advance(&lanes, &accepted, &failed) | ((mask){0} - returning);
        const int processed = any(attention) ? LANES : 0;
        for (int lane = 0; lane < processed; lane++) {
            if (MASK_LANE(attention, lane)) {
                const int has_failed = MASK_LANE(failed, lane) != 0;
                const int is_accepted = MASK_LANE(accepted, lane) != 0;
                MASK_LANE(accepted, lane) = -process_step(&lanes, lane, is_accepted, has_failed);
            }
        }
        move(&lanes, accepted);
        for (int lane = 0; lane < processed; lane++) {
            if (MASK_LANE(attention, lane)) {
                busy -= finish_step(&lanes, lane, returning);
            }
        }
    }
}

/* Whether the compiler fused a product with a sum, which decides the last bits of results. */
int64_t fuses_products(void);
int64_t fuses_products(void)
{
    const volatile double x = 1 + 0x1p-30;
    return x*x - (1 + 0x1p-29) != 0;
}
