/* The location of an event in a narrow bracket, by the cubic through the states and derivatives at its
   ends. */

typedef struct {
    double start, width;        /* the h of the first state, and from there to the second */
    double begin[DIM], change[DIM];
    double first[DIM], last[DIM];       /* derivatives times width, less the change */
} Cubic;

/* The cubic of a lane; `state` becomes the one at its end. */
static Cubic cubic_of(Lanes *lanes, int lane, const WithinStep *within, State *state)
{
    const Bracket *bracket = within->bracket;
    Cubic cubic = {.start = bracket->near, .width = bracket->far - bracket->near};
    double end[DIM];
    real derivative[DIM];
    write_lane(state, STATE_SIZE, lane, within->near_state);
    read_lane(state->z, DIM, lane, cubic.begin);
    RHS(state->t, state->z, lanes->motion.params, derivative);
    read_lane(derivative, DIM, lane, cubic.first);
    write_lane(state, STATE_SIZE, lane, within->far_state);
    read_lane(state->z, DIM, lane, end);
    RHS(state->t, state->z, lanes->motion.params, derivative);
    read_lane(derivative, DIM, lane, cubic.last);
    LANE(lanes->motion.evaluations, lane) += 2;
    for (int n = 0; n < DIM; n++) {
        cubic.change[n] = end[n] - cubic.begin[n];
        cubic.first[n] = cubic.width*cubic.first[n] - cubic.change[n];
        cubic.last[n] = cubic.width*cubic.last[n] - cubic.change[n];
    }
    return cubic;
}

/* Component n at the part x of a cubic. */
static inline double cubic_component(const Cubic *cubic, double x, int64_t n)
{
    const double bend = (1 - x)*cubic->first[n] - x*cubic->last[n];
    return cubic->begin[n] + x*(cubic->change[n] + (1 - x)*bend);
}

/* Move the state of a lane to h by a cubic. */
static void interpolate(
    const Cubic *cubic, const State *start, double h, int lane, const real *params, State *state)
{
    const double x = (h - cubic->start)/cubic->width;
    for (int n = 0; n < DIM; n++) {
        LANE(state->z[n], lane) = cubic_component(cubic, x, n);
    }
    for (int n = 0; n < LOW_DIM; n++) {
        LANE(state->z_low[n], lane) = 0;
    }
    state->t = two_sum(start->t, h + start->t_low, &state->t_low);
    project(state, params);
    count_turns(start, splat(h), state);
}

/* The value of an event at the part x of a cubic, without the state there if that suffices. */
static inline double cubic_value(const Cubic *cubic, const Event *event, double x)
{
    if (!event->is_angle) {
        return cubic_component(cubic, x, event->index) - event->value;
    }
    const int64_t n = SINE[event->index];
    const double sine = cubic_component(cubic, x, n)*event->cosine
        - cubic_component(cubic, x, n + 1)*event->sine;
    return fabs(sine) < ROUNDED_SINE ? 0 : sine;
}

SELDOM static void locate_by_cubic(Lanes *lanes, int lane, WithinStep *within)
{
    const Event *event = &lanes->task->events[within->bracket->event];
    const State *start = &lanes->motion.state;
    Bracket *bracket = within->bracket;
    State state = *start;
    const Cubic cubic = cubic_of(lanes, lane, within, &state);
    bracket->aim = NAN;
    within->side = 0;
    while (is_wide(within)) {
        const double h = next_event_h(within);
        double value;
        if (CORRECTIONS > 0 || event->is_switch) {
            interpolate(&cubic, start, h, lane, lanes->motion.params, &state);
            const real values = event_value(event, &state, lanes->motion.params);
            value = LANE(values, lane);
        } else {
            value = cubic_value(&cubic, event, (h - cubic.start)/cubic.width);
        }
        reduce_bracket(within, h, value);
    }
    interpolate(&cubic, start, bracket->far, lane, lanes->motion.params, &state);
    read_lane(&state, STATE_SIZE, lane, within->far_state);
}
