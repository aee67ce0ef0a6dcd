/* Motions in lanes and in memory, and the rows that they write. */

/* One lane of `count` reals, from or into memory. */
static inline void read_lane(const void *reals, int count, int lane, double *numbers)
{
    for (int k = 0; k < count; k++) {
        numbers[k] = LANE(((const real *)reals)[k], lane);
    }
}

static inline void write_lane(void *reals, int count, int lane, const double *numbers)
{
    for (int k = 0; k < count; k++) {
        LANE(((real *)reals)[k], lane) = numbers[k];
    }
}

/* `state` is one lane of a State. */
static void write_row(Row *row, const double *state)
{
    row->t = state[0];
    memcpy(row->z, state + offsetof(State, z)/sizeof(real), sizeof row->z);
    memcpy(row->turns, state + offsetof(State, turns)/sizeof(real), sizeof row->turns);
    memcpy(row->scale, state + offsetof(State, scale)/sizeof(real), sizeof row->scale);
}

/* Time of the next sample of a motion, or of a later one. */
static inline double sample_time(const Task *task, const Trajectory *trajectory, int64_t later)
{
    const int64_t motion = trajectory - task->trajectories;
    return task->times[motion*task->own_times + trajectory->rows + later];
}

static void append_row(const Task *task, Trajectory *trajectory, const double *state)
{
    const int64_t motion = trajectory - task->trajectories;
    if (trajectory->rows < task->capacity) {
        write_row(task->rows + motion*task->capacity + trajectory->rows, state);
    }
    trajectory->rows++;
}

static double extremum_value(const Event *event, const Row *row)
{
    const int64_t i = event->extremum_index;
    const double *z = row->z;
    return event->extremum_is_angle
        ? atan2(z[SINE[i]], z[SINE[i] + 1]) + 2*PI*row->turns[i] : z[i];
}

static void update_extremes(const Event *event, Row *rows, int is_first, const double *state)
{
    Row row;
    write_row(&row, state);
    const double value = extremum_value(event, &row);
    if (is_first || value < extremum_value(event, &rows[0])) {
        memcpy(&rows[0], &row, sizeof row);
    }
    if (is_first || value > extremum_value(event, &rows[1])) {
        memcpy(&rows[1], &row, sizeof row);
    }
}

static void record_event(const Task *task, Trajectory *trajectory, int event, const double *state)
{
    const int64_t series = (trajectory - task->trajectories)*task->event_count + event;
    Row *rows = task->event_rows + series*task->event_capacity;
    const int64_t row = trajectory->occurred[event]++ - task->events[event].skip;
    if (row < 0) {
        return;
    }
    if (task->events[event].extremes_only) {
        update_extremes(&task->events[event], rows, row == 0, state);
    } else if (row < task->event_capacity) {
        write_row(rows + row, state);
    }
}

#if HAS_SWITCHES
/* Largest difference of 1 - s^2 from its change by the slopes at both ends of a step. */
static const double COARSE = 0.1;

/* A switching function less its level, whose sign is that behind the parameters also at 0; of one
   that stays 0 the positive number 1 - s^2. */
static real switching_function(int64_t index, const State *state, const real *params)
{
    const real sign = params[FIRST_SIGN + index];
    const mask stays = is_zero(sign);
    Sliding sliding;
    if (any(stays)) {
        slide(state->t, state->z, params, &sliding);
    } else {
        SWITCHING(state->t, state->z, params, sliding.values);
        sliding.signs[index] = sign;
    }
    const real margin = 1.0 - sliding.signs[index]*sliding.signs[index];
    const real value = select(stays, margin, sliding.values[index]) - params[FIRST_LEVEL + index];
    const real least = lane_copysign(splat(DBL_MIN), sign);
    return select(less_than(lane_fabs(value), splat(DBL_MIN)), least, value);
}

/* Its rate of change, of 1 - s^2 by the difference over a small part of a step of length h. */
static real switching_rate(int64_t index, const State *state, const real *params, real h)
{
    Sliding now, later;
    slide(state->t, state->z, params, &now);
    const mask stays = is_zero(params[FIRST_SIGN + index]);
    if (!any(stays)) {
        return now.values[RATES + index];
    }
    const real part = h*0x1p-20;
    real z[DIM];
    for (int n = 0; n < DIM; n++) {
        z[n] = state->z[n] + part*now.derivative[n];
    }
    slide(state->t + part, z, params, &later);
    const real s = now.signs[index], change = later.signs[index] - s;
    return select(stays, -change*(2.0*s + change)/part, now.values[RATES + index]);
}

/* Whether a step is too long to follow a sign by which a function stays 0: the error of the state
   does not show it. */
static mask is_coarse(const State *start, const State *end, real h, const real *params)
{
    mask coarse = {0};
    for (int k = 0; k < SWITCHES; k++) {
        const mask stays = is_zero(params[FIRST_SIGN + k]);
        if (any(stays)) {
            const real change = switching_function(k, end, params)
                - switching_function(k, start, params);
            const real slopes =
                switching_rate(k, start, params, h) + switching_rate(k, end, params, h);
            coarse |= stays & less_than(splat(COARSE), lane_fabs(change - 0.5*h*slopes));
        }
    }
    return coarse;
}
#endif

/* The angle of index i, with its turns, within 0.08. */
static inline real unwrapped_angle(const State *state, int64_t i)
{
    return approximate_angle(state, (int)i) + 2*PI*state->turns[i];
}

/* Of the sine of an angle's difference from an event, what rounding leaves at the event itself. */
static const double ROUNDED_SINE = 5e-16;

/* The value of an event, of an angle by its approximation: its difference from the event, but near
   that the sine of the difference. */
static inline real value_of(const Event *event, const State *state, const real *params, real angle)
{
    const int64_t i = event->index;
#if HAS_SWITCHES
    if (event->is_switch) {
        return switching_function(i, state, params);
    }
#endif
    (void)params;
    if (!event->is_angle) {
        return state->z[i] - event->value;
    }
    const real s = state->z[SINE[i]], c = state->z[SINE[i] + 1];
    const real rough = angle - event->value;
    const real sine = s*event->cosine - c*event->sine;
    const real exact = select(less_than(lane_fabs(sine), splat(ROUNDED_SINE)), splat(0.0), sine);
    return select(less_than(lane_fabs(rough), splat(1.0)), exact, rough);
}

/* A function whose sign changes at the event. Far from it an angle need not be exact. */
static real event_value(const Event *event, const State *state, const real *params)
{
    const real angle = event->is_angle ? unwrapped_angle(state, event->index) : splat(0.0);
    return value_of(event, state, params, angle);
}

/* Its derivative, up to a positive factor for an angle. */
static double event_slope(
    const Event *event, const State *state, const real *params, double h, int lane)
{
    real derivative[DIM];
#if HAS_SWITCHES
    if (event->is_switch) {
        const real rate = switching_rate(event->index, state, params, splat(h));
        return ((const double *)&rate)[lane];
    }
#endif
    (void)h;
    RHS(state->t, state->z, params, derivative);
    return event->is_angle ? LANE(state->z[RATE[event->index]], lane)
                           : LANE(derivative[event->index], lane);
}

/* Whether the event lies between a value x before a step and a value y after it. */
static inline mask has_crossed(const Event *event, real x, real y)
{
    const real zero = splat(0.0);
    const mask up = less_than(x, zero) & ~less_than(y, zero);
    const mask down = less_than(zero, x) & ~less_than(zero, y);
    return event->direction > 0 ? up : event->direction < 0 ? down : up | down;
}

/* The same for numbers. */
static inline int is_crossed(const Event *event, double x, double y)
{
    const int up = x < 0 && !(y < 0), down = x > 0 && !(y > 0);
    return event->direction > 0 ? up : event->direction < 0 ? down : up || down;
}
