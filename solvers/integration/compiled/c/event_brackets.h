/* Events within a step: where they may occur, and parts of it in which each occurs at most once. */

/* Extend the steps of the lanes in which an event may occur several times, or which are dense. */
static __attribute__((noinline)) void extend_steps(
    Lanes *lanes, const StepResult *result, mask several)
{
    const Task *task = lanes->task;
    const State *start = &lanes->motion.state, *end = &lanes->end;
    const real *params = lanes->motion.params;
    Workspace *workspace = lanes->workspace;
    real changes[EXTENSION_NODES][DIM];
    lanes->motion.evaluations +=
        select(several | lanes->dense, splat(ROUNDS*EXTENSION_NODES), splat(0.0));
    extend(start, end, result, lanes->h, params, changes);
    for (int e = 0; e < task->event_count && any(several); e++) {
        const Event *event = &task->events[e];
        real coefficients[EXTENSION_DEGREE + 1];
        memcpy(coefficients, workspace->coefficients[e], sizeof coefficients);
        if (ROUNDS > 0 && !event->is_switch) {
            extended_polynomial(event, start, changes, lanes->before[e], coefficients);
        }
        switching_polynomial(event, start, end, lanes->h, params, lanes->before[e],
                             lanes->after[e], EXTENSION_DEGREE, coefficients);
        for (int k = 0; k <= EXTENSION_DEGREE; k++) {   /* other lanes keep their polynomials */
            real *kept = &workspace->coefficients[e][k];
            *kept = select(lanes->several[e], coefficients[k], *kept);
        }
    }
    if (any(lanes->dense)) {
        extended_states(changes, lanes->dense, workspace->states);
    }
}

/* Evaluate the events at the end of a step. Returns the lanes in which one may occur; `several`
   receives those in which one may do so several times. */
static __attribute__((noinline)) mask events_in_step(
    Lanes *lanes, const StepResult *result, mask *several)
{
    const Task *task = lanes->task;
    const State *start = &lanes->motion.state, *end = &lanes->end;
    const real *params = lanes->motion.params, zero = splat(0.0);
    mask occurring = {0}, all_examined = {0};
    real angle = zero, mean = zero, slack = zero;
    for (int e = 0; e < task->event_count; e++) {
        const Event *event = &task->events[e];
        const int is_new = e == 0 || event->index != event[-1].index
            || event->is_angle != event[-1].is_angle || event->is_switch;
        if (is_new && event->is_angle) {
            angle = unwrapped_angle(end, event->index);
        }
        const real before = lanes->before[e];
        const real after = value_of(event, end, params, angle);
        lanes->after[e] = after;
        const mask moves = less_than(before, zero) | less_than(zero, before);
        const mask crossed = has_crossed(event, before, after);
        mask examined = lanes->advancing;
        if (IS_EXPLICIT && !event->is_switch) {
            if (is_new) {
                slope_bounds(event, start, end, result, lanes->h, &mean, &slack);
            }
            const real speed = lane_fabs(mean), reach = lane_fabs(lanes->h)*(speed + slack);
            const mask once = less_than(slack, speed) | less_than(reach, lane_fabs(before));
            examined &= crossed | ~moves | ~once;
        }
        occurring |= crossed;
        all_examined |= lanes->several[e] = examined;
    }
    for (int e = 0; e < task->event_count && any(all_examined); e++) {
        const real before = lanes->before[e];
        if (!any(lanes->several[e])) {
            continue;
        }
        const mask moves = less_than(before, zero) | less_than(zero, before);
        lanes->several[e] &= ~moves
            | has_several(&task->events[e], start, end, result, lanes->h, params, before,
                          lanes->after[e], lanes->workspace->coefficients[e]);
        *several |= lanes->several[e];
    }
    return occurring | *several;
}

/* Estimate the event in a bracket by a polynomial, if that has another sign at its ends. */
static void estimate_event(int degree, const double *coefficients, double full_h, Bracket *bracket)
{
    const double x = bracket->near/full_h, y = bracket->far/full_h;
    double slope;
    bracket->aim = NAN;
    bracket->slope = 0;
    if (value_at(degree, coefficients, x)*value_at(degree, coefficients, y) < 0) {
        const double part = root_between(degree, coefficients, x, y, 0.1*BEYOND, &slope);
        bracket->aim = part*full_h;
        bracket->slope = slope/full_h;
    }
}

/* Bracket all crossings of an event within the step of a lane. */
SELDOM static void bracket_crossings(const Lanes *lanes, int lane, WithinStep *within, int e)
{
    const Event *event = &lanes->task->events[e];
    const double before = LANE(lanes->before[e], lane), after = within->after[e];
    const int recurs = MASK_LANE(lanes->several[e], lane) != 0;
    const int degree = recurs ? EXTENSION_DEGREE : DEGREE;
    double coefficients[EXTENSION_DEGREE + 1];
    Extremum extrema[MAX_ROOTS];
    Bracket bracket = {.event = e, .is_pending = 1, .tries = MAX_TRIES, .near_value = before};
    int count = 0;
    if (!recurs && !is_crossed(event, before, after)) {
        return;
    }
    read_lane(lanes->workspace->coefficients[e], degree + 1, lane, coefficients);
    if (recurs) {
        count = separate_crossings(coefficients, extrema);
    }
    if (count == 0 && !is_crossed(event, before, after)) {
        return;     /* an event at the start is not in this step */
    }
    for (int k = 0; k < count; k++) {
        bracket.far = extrema[k].part*within->full_h;
        bracket.curvature = extrema[k].curvature/(within->full_h*within->full_h);
        estimate_event(degree, coefficients, within->full_h, &bracket);
        add_bracket(within, &bracket);
        bracket.near = bracket.far;
    }
    bracket.tries = 0;
    bracket.far = within->full_h;
    bracket.far_value = after;
    estimate_event(degree, coefficients, within->full_h, &bracket);
    add_bracket(within, &bracket);
}
