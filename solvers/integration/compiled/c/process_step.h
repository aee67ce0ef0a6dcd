/* A step of one lane: its events and samples, or its failure. */

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
            slope = event_slope(event, state, lanes->motion.params, h, lane);
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
    project(state, motion->params);
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

/* Append the samples before `limit` within steps of length `full`, of several lanes at once, by the
   extension; returns the lanes where they are not finite. */
static __attribute__((noinline)) mask sample_lanes(
    Lanes *lanes, mask sampled, real full, real limit)
{
    const Task *task = lanes->task;
    const State *start = &lanes->motion.state;
    mask failed = {0};
    for (;;) {
        real h = splat(0.0), change[DIM], check = h;
        for (int lane = 0; lane < LANES; lane++) {
            const WithinStep *within = &lanes->within[lane];
            if (!MASK_LANE(sampled, lane) || within->trajectory->rows >= task->samples) {
                MASK_LANE(sampled, lane) = 0;
                continue;
            }
            const double t = sample_time(task, within->trajectory, 0);
            const double next = (t - LANE(start->t, lane)) - LANE(start->t_low, lane);
            const int is_inside = fabs(next) < fabs(LANE(limit, lane)) - within->resolution;
            MASK_LANE(sampled, lane) = -is_inside;
            LANE(h, lane) = is_inside ? next : 0;
        }
        if (!any(sampled)) {
            return failed;
        }
        State state = *start;
        change_within(lanes->workspace->states, h/full, change);
        for (int n = 0; n < DIM; n++) {
            move_component(start, &state, n, change[n]);
            check += change[n] - change[n];
        }
        state.t = two_sum(start->t, h + start->t_low, &state.t_low);
        project(&state, lanes->motion.params);
        rescale_variation(start, &state);
        count_turns(start, h, &state);
        failed |= sampled & ~less_than(lane_fabs(check), splat(1.0));
        sampled &= ~failed;
        for (int lane = 0; lane < LANES; lane++) {
            if (MASK_LANE(sampled, lane)) {
                double numbers[STATE_SIZE];
                read_lane(&state, STATE_SIZE, lane, numbers);
                append_row(task, lanes->within[lane].trajectory, numbers);
            }
        }
    }
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
        within->is_dense = MASK_LANE(lanes->dense, lane) != 0;
        for (int e = 0; e < task->event_count; e++) {
            within->after[e] = LANE(lanes->after[e], lane);
            bracket_crossings(lanes, lane, within, e);
        }
        if (within->bracket_count) {
            read_lane(&motion->state, STATE_SIZE, lane, within->start);
        }
    } else {
        use_state(lanes, lane, h, &lanes->end, end);
    }
    double next;
    while ((next = next_h(task, within, LANE(motion->state.t, lane),
                          LANE(motion->state.t_low, lane))) != 0) {
        if (within->mode == LOCATE && is_narrow(within)) {
            locate_by_cubic(lanes, lane, within);
            continue;
        }
        if (within->mode == SAMPLE && within->is_dense) {
            mask one = {0};
            MASK_LANE(one, lane) = -1;
            if (any(sample_lanes(lanes, one, splat(within->full_h), splat(within->h)))) {
                fail_step(motion, within, lane, h);
                return 0;
            }
            continue;
        }
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
