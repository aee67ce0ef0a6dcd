/* One step in every lane, and the step control. */

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
#if HAS_SWITCHES
        const mask coarse = *accepted & is_coarse(state, end, lanes->h, motion->params);
        motion->h = select(coarse, 0.5*lanes->h, motion->h);
        *accepted &= ~coarse;
#endif
#if INTERPOLATES
        if (advancing & ~*failed & ~*accepted) {
            keep_polynomial(state, end);
        }
#endif
#if VARIES_ORDER
        choose_order(state, result.contraction, factor, end);
#endif
    }
    project(end, motion->params);
    rescale_variation(state, end);
    check = count_turns(state, lanes->h, end);
    *failed |= ~less_than(lane_fabs(check), splat(1.0));
    *accepted &= ~*failed;
    const real one = splat(1.0);
    motion->attempts += one;
    motion->rejected += select(advancing & ~*accepted, one, splat(0.0));
    motion->reductions = select(*accepted, splat(0.0), motion->reductions);
    mask attention = *failed | last | ~advancing | less_than(lane_fabs(motion->h), motion->min_h);
    if (CORRECTIONS > 0) {
        const real longest = lane_fmax(motion->longest, lane_fabs(lanes->h));
        motion->longest = select(*accepted, longest, motion->longest);
        attention |= less_than(lane_fabs(motion->h), task->collapse*motion->longest);
    }
    mask several = {0};
    mask crossed = {0};
    if (task->event_count) {
        crossed = *accepted & events_in_step(lanes, &result, &several);
        attention |= crossed;
    }
    lanes->crossed = crossed;
    const mask dense = *accepted & less_than(lane_fabs(lanes->dense_sample - state->t),
                                             lane_fabs(lanes->h));
    lanes->dense = dense;
    if (any(several | dense)) {
        extend_steps(lanes, &result, several);
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
