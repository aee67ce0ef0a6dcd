/* The end of a lane's step, at which its motion may end or pause, and the next one be loaded. */

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
#if HAS_SWITCHES
    if (LANE(motion->reductions, lane) == IS_UNDETERMINED) {
        return UNDETERMINED;
    }
#endif
    const double reductions = LANE(motion->reductions, lane);
    if (reductions > (task->fixed_h ? 0 : MAX_REDUCTIONS)) {
        return IS_EXPLICIT || reductions > MAX_REDUCTIONS + 1 ? NOT_FINITE : NO_CONVERGENCE;
    }
    if (LANE(motion->steps, lane) >= (double)task->max_steps) {
        return STEP_LIMIT;
    }
    if (h < task->collapse*LANE(motion->longest, lane) && h < left) {
        return SINGULAR;
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
    if (held >= task->holds || isnan(task->hold_ends[held])) {
        return 0;
    }
    for (int64_t u = 0; u < task->inputs; u++) {
        LANE(motion->params[task->first_input + u], lane) = task->hold_values[held*task->inputs + u];
    }
    LANE(motion->held, lane) = (double)held;
    LANE(motion->t_end, lane) = task->hold_ends[held];
    MASK_LANE(lanes->starting, lane) = -1;
#if HAS_SWITCHES
    start_signs(motion, lane);
    MASK_LANE(lanes->loaded, lane) = -1;
#endif
    return 1;
}

/* If a switching function ended the step of a lane, let its motion go on from there. */
static void pass_switch(Lanes *lanes, int lane)
{
#if HAS_SWITCHES
    WithinStep *within = &lanes->within[lane];
    if (within->terminal >= 0 && lanes->task->events[within->terminal].is_switch) {
        within->trajectory->occurred[within->terminal] = 0;
        switch_signs(&lanes->motion, lane, (int)lanes->task->events[within->terminal].index);
        within->terminal = -1;
        MASK_LANE(lanes->starting, lane) = MASK_LANE(lanes->loaded, lane) = -1;
    }
#else
    (void)lanes; (void)lane;
#endif
}

/* After a step, store a lane's motion if it ends or pauses, and load the next one; returns whether
   the lane becomes idle. */
static int finish_step(Lanes *lanes, int lane, int returning)
{
    WithinStep *within = &lanes->within[lane];
    Trajectory *trajectory = within->trajectory;
    const int advances = within->mode == ADVANCE;
    if (advances) {
        pass_switch(lanes, lane);
    }
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
