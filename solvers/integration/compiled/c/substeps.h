/* The order of work within a step, and the use of each substep. */

/* Select a pending bracket, those of terminal events first; 0 if there is none. */
static int select_bracket(const Task *task, WithinStep *within)
{
    Bracket *selected = NULL;
    for (int k = 0; k < within->bracket_count; k++) {
        Bracket *bracket = &within->brackets[k];
        if (bracket->is_pending && (!selected || task->events[bracket->event].terminal
                                        > task->events[selected->event].terminal)) {
            selected = bracket;
        }
    }
    within->bracket = selected;
    if (selected) {
        const int is_first = selected->near == 0;
        selected->is_pending = 0;
        within->knows_near = is_first || selected->near == within->extremum_h;
        memcpy(within->near_state, is_first ? within->start : within->extremum,
               sizeof within->near_state);
        memcpy(within->far_state, within->full_end, sizeof within->far_state);
    }
    within->substeps = within->side = 0;
    return selected != NULL;
}

/* Use a located event: it ends the motion or is recorded, unless the motion ends before it. */
static void use_event(const Task *task, WithinStep *within)
{
    const Bracket *bracket = within->bracket;
    const int event = bracket->event;
    /* of simultaneous events those before the terminal one in the list count */
    const double later = fabs(bracket->far) - fabs(within->h);
    if (later > 0 || (later == 0 && within->terminal >= 0 && event > within->terminal)) {
        return;
    }
    if (task->events[event].terminal) {
        within->terminal = event;
        within->h = bracket->far;
        memcpy(within->end, within->far_state, sizeof within->end);
    } else {
        record_event(task, within->trajectory, event, within->far_state);
    }
}

/* The h of the next sample, or 0 when all samples within the step are written. */
static double next_sample_h(const Task *task, WithinStep *within, double t, double t_low)
{
    Trajectory *trajectory = within->trajectory;
    while (trajectory->rows < task->samples) {
        const double h = (sample_time(task, trajectory, 0) - t) - t_low;
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

/* The h of the next substep, or 0 when the work within the step is complete. */
static double next_h(const Task *task, WithinStep *within, double t, double t_low)
{
    for (;;) {
        if (within->mode == LOCATE) {
            const Bracket *bracket = within->bracket;
            if (bracket->tries) {
                return bracket->far;
            }
            if (is_crossed(&task->events[bracket->event], bracket->near_value, bracket->far_value)) {
                if (is_wide(within)) {
                    return next_event_h(within);
                }
                use_event(task, within);
            }
        }
        if (within->mode == SAMPLE || !select_bracket(task, within)) {
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

/* Use a substep of length h that ends at `state`, where the event being located has `value`, and the
   derivative `slope`. */
static void use_substep(
    const Task *task, WithinStep *within, double h, const double *state, double value,
    double slope)
{
    if (within->mode == SAMPLE) {
        append_row(task, within->trajectory, state);
        return;
    }
    const Bracket *bracket = within->bracket;
    if (bracket->tries) {
        within->substeps++;
        close_bracket(within, h, value, slope);
        memcpy(within->far_state, state, sizeof within->far_state);
        if (bracket[1].near == h) {
            within->extremum_h = h;
            memcpy(within->extremum, state, sizeof within->extremum);
        }
        return;
    }
    const int is_near = reduce_bracket(within, h, value);
    memcpy(is_near ? within->near_state : within->far_state, state, sizeof within->near_state);
    within->knows_near |= is_near;
    aim_beyond(within, h, value);
}
