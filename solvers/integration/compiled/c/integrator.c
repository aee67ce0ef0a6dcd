/* Motions, as many at once as there are lanes, each with its own step size.

   Every turn of the loop makes one step in every lane from the place where the lane's motion
   stands: to advance it, or on an errand within a step that was accepted. A lane whose motion ends
   takes the next one. What a lane computes depends on nothing but its own motion. */

enum { MOST_CUTS = 25, TURNS_BETWEEN_LOOKS = 64 };

typedef struct {
    Task *task;
    Motion motion;
    Place end;
    real trial;                             /* length of the step that is made */
    real before[MOST_EVENTS], after[MOST_EVENTS];   /* values of the events, here and at the end */
    real due;                               /* time of the next sample, NaN if there is none */
    mask advancing, fresh, taken;           /* fresh motions begin; those taken were put down before */
    Errand errands[LANES];
} Lanes;

/* Give the lane the next motion that waits, if there is one. */
static void take_next(Lanes *lanes, int lane)
{
    Task *task = lanes->task;
    Errand *errand = &lanes->errands[lane];
    int64_t which;
    errand->mode = IDLE;
    while ((which = __atomic_fetch_add(&task->next, 1, __ATOMIC_RELAXED)) < task->count) {
        Trajectory *trajectory = &task->trajectories[which];
        if (trajectory->status <= RUNNING) {
            errand->mode = ADVANCE;
            errand->trajectory = trajectory;
            to_lane(&lanes->motion, MOTION, lane, trajectory->numbers);
            errand->resolution = 0.4*NUMBER(lanes->motion.shortest, lane);
            errand->stopping = -1;
            WORD(lanes->fresh, lane) = trajectory->status == WAITING ? -1 : 0;
            WORD(lanes->taken, lane) = -1;
            return;
        }
    }
}

/* Note for all lanes at once what a lane's errand says. */
static void note(Lanes *lanes, int lane)
{
    const Task *task = lanes->task;
    const Errand *errand = &lanes->errands[lane];
    const int is_due = errand->mode == ADVANCE && errand->trajectory->rows < task->samples;
    NUMBER(lanes->due, lane) = is_due ? task->times[errand->trajectory->rows] : NAN;
    WORD(lanes->advancing, lane) = errand->mode == ADVANCE ? -1 : 0;
}

/* Values of the events where motions are that lanes have just taken. */
static void watch(Lanes *lanes)
{
    const Task *task = lanes->task;
    for (int e = 0; e < task->events; e++) {
        const real value = event_value(&task->event[e], &lanes->motion.place);
        lanes->before[e] = chosen(lanes->taken, value, lanes->before[e]);
    }
    lanes->taken = (mask){0};
}

/* Slopes and first steps of motions that have just begun. */
static void begin(Lanes *lanes)
{
    const Task *task = lanes->task;
    Motion *motion = &lanes->motion;
    Place *place = &motion->place;
    real slope[STATE];
    RHS(place->t, place->z, motion->params, slope);
    for (int n = 0; n < STATE && IS_FSAL; n++) {
        place->first[n] = chosen(lanes->fresh, slope[n], place->first[n]);
    }
    const real duration = motion->t_end - place->t;
    real h = every(task->fixed);
    if (!task->fixed) {
        h = first_step(place, slope, motion->params, duration, lanes->fresh, task->rtol,
                       task->atol);
        h = larger(h, 2.0*motion->shortest);
    }
    motion->h = chosen(lanes->fresh, signed_as(h, duration), motion->h);
    for (int lane = 0; lane < LANES; lane++) {
        Errand *errand = &lanes->errands[lane];
        const int keeps = task->samples < 0
            || (task->samples > 0 && task->times[0] == NUMBER(place->t, lane));
        if (WORD(lanes->fresh, lane) && keeps) {
            double start[PLACE];
            from_lane(place, PLACE, lane, start);
            keep_row(task, errand->trajectory, start);
        }
    }
    real nothing = every(0.0);
    for (int n = 0; n < STATE; n++) {
        nothing += (slope[n] - slope[n]) + (place->z[n] - place->z[n]);
    }
    /* a motion without a slope has used up all its tries */
    const mask hopeless = lanes->fresh & ~below(size(nothing), every(1.0));
    motion->cuts = chosen(hopeless, every(MOST_CUTS + 1), motion->cuts);
}

/* Decide over the step that a lane has made; return whether its motion moves to its end. */
static int attend(Lanes *lanes, int lane, int kept, int broken)
{
    const Task *task = lanes->task;
    Motion *motion = &lanes->motion;
    Errand *errand = &lanes->errands[lane];
    if (errand->mode == IDLE) {
        return 0;
    }
    double end[PLACE];
    from_lane(&lanes->end, PLACE, lane, end);
    const double length = NUMBER(lanes->trial, lane);
    if (broken) {
        if (errand->mode != ADVANCE) {
            undo_errand(errand);
        }
        NUMBER(motion->h, lane) = (errand->mode == ADVANCE ? length : errand->whole)/4;
        NUMBER(motion->cuts, lane) += 1;
        errand->mode = ADVANCE;
        return 0;
    }
    if (errand->mode == ADVANCE) {
        if (!kept) {
            return 0;
        }
        int waiting = 0;
        for (int e = 0; e < task->events; e++) {
            const mask passed = has_passed(&task->event[e], lanes->before[e], lanes->after[e]);
            waiting |= (int)(WORD(passed, lane) & 1) << e;
            errand->before[e] = NUMBER(lanes->before[e], lane);
            errand->after[e] = NUMBER(lanes->after[e], lane);
        }
        begin_errand(errand, length, end, waiting);
    } else {
        const int e = errand->event;
        take_try(task, errand, length, end, e < 0 ? 0 : NUMBER(lanes->after[e], lane));
    }
    const double next = next_length(task, errand, NUMBER(motion->place.t, lane),
                                    NUMBER(motion->place.t_low, lane));
    if (next != 0) {
        NUMBER(lanes->trial, lane) = next;
        return 0;
    }
    errand->mode = ADVANCE;
    to_lane(&lanes->end, PLACE, lane, errand->end);
    for (int e = 0; e < task->events; e++) {
        NUMBER(lanes->after[e], lane) = errand->after[e];
    }
    return 1;
}

/* How a lane's motion stands after the step: RUNNING if it is to go on. */
static enum Status status(const Lanes *lanes, int lane)
{
    const Task *task = lanes->task;
    const Motion *motion = &lanes->motion;
    const Errand *errand = &lanes->errands[lane];
    const double left = fabs(NUMBER(motion->t_end, lane) - NUMBER(motion->place.t, lane));
    const double h = fabs(NUMBER(motion->h, lane));
    if (errand->stopping >= 0) {
        return EVENT;
    }
    if (left == 0) {
        return FINISHED;
    }
    if (NUMBER(motion->cuts, lane) > (task->fixed ? 0 : MOST_CUTS)) {
        return IS_EXPLICIT || NUMBER(motion->cuts, lane) > MOST_CUTS ? NOT_FINITE : NO_CONVERGENCE;
    }
    if (NUMBER(motion->steps, lane) >= (double)task->most_steps) {
        return STEP_LIMIT;
    }
    return h < NUMBER(motion->shortest, lane) && h < left ? STEP_TOO_SMALL : RUNNING;
}

/* Whether there is no room for what the next step may give. */
static int is_full(const Task *task, const Trajectory *trajectory)
{
    int full = task->samples < 0 && trajectory->rows >= task->capacity;
    for (int e = 0; e < task->events; e++) {
        full |= trajectory->occurred[e] >= task->occurrences;
    }
    return full && task->pauses;
}

/* After its step a lane's motion goes on, or is put down and the lane takes the next; returns
   whether there is none. */
static int conclude(Lanes *lanes, int lane, int leaving)
{
    Errand *errand = &lanes->errands[lane];
    if (errand->mode == ADVANCE) {
        Trajectory *trajectory = errand->trajectory;
        const enum Status now = status(lanes, lane);
        if (now != RUNNING || leaving || is_full(lanes->task, trajectory)) {
            from_lane(&lanes->motion, MOTION, lane, trajectory->numbers);
            trajectory->status = now;
            errand->mode = IDLE;
            if (!leaving) {
                take_next(lanes, lane);
            }
            note(lanes, lane);
            return errand->mode == IDLE;
        }
    }
    note(lanes, lane);
    return 0;
}

/* One step in every lane; returns the lanes that must be looked at one by one. */
static __attribute__((noinline)) mask advance(Lanes *lanes, mask *kept, mask *broken)
{
    const Task *task = lanes->task;
    Motion *motion = &lanes->motion;
    Place *place = &motion->place, *end = &lanes->end;
    const mask advancing = lanes->advancing;
    const real left = (motion->t_end - place->t) - place->t_low;
    const mask last = advancing & ~below(size(motion->h)*(1 + 1e-9), size(left));
    lanes->trial = chosen(advancing, chosen(last, left, motion->h), lanes->trial);
    real error[2][STATE];
    motion->rounds += step(place, lanes->trial, motion->params, !task->fixed, end, error);
    end->t = chosen(last, motion->t_end, end->t);
    end->t_low = chosen(last, every(0.0), end->t_low);
    real nothing = every(0.0);
    for (int n = 0; n < STATE; n++) {
        nothing += end->z[n] - end->z[n];
    }
    *broken = ~below(size(nothing), every(1.0));
    *kept = advancing & ~*broken;
    if (!task->fixed) {
        const real square = error_square(error, place->z, end->z, task->rtol, task->atol);
        *broken |= advancing & ~below(square, every(INFINITY));
        *kept &= ~below(every(1.0), square) & ~*broken;
        const real change = factor(square, *kept, &motion->previous);
        const real h = chosen(*kept, motion->h, lanes->trial)*change;
        motion->h = chosen(advancing & ~*broken, h, motion->h);
    }
    settle(end);
    rescale(place, end);
    nothing = count_turns(place, lanes->trial, end);
    *broken |= ~below(size(nothing), every(1.0));
    *kept &= ~*broken;
    const real one = every(1.0);
    motion->trials += one;
    motion->rejected += chosen(advancing & ~*kept, one, every(0.0));
    motion->cuts = chosen(*kept, every(0.0), motion->cuts);
    mask attention = *broken | last | ~advancing | below(size(motion->h), motion->shortest);
    for (int e = 0; e < task->events; e++) {
        lanes->after[e] = event_value(&task->event[e], end);
        attention |= *kept & has_passed(&task->event[e], lanes->before[e], lanes->after[e]);
    }
    attention |= below(every((double)task->most_steps), motion->steps + 2.0);
    if (task->samples < 0) {
        attention |= *kept;
    }
    return attention | below(size(lanes->due - place->t), size(lanes->trial) + motion->shortest);
}

/* Move the motions that are kept to where their steps end. */
static void move(Lanes *lanes, mask kept)
{
    if (!any(kept)) {
        return;
    }
    real *to = (real *)&lanes->motion.place;
    const real *from = (const real *)&lanes->end;
    for (int k = 0; k < PLACE; k++) {
        to[k] = chosen(kept, from[k], to[k]);
    }
    for (int e = 0; e < lanes->task->events; e++) {
        lanes->before[e] = chosen(kept, lanes->after[e], lanes->before[e]);
    }
    lanes->motion.steps += chosen(kept, every(1.0), every(0.0));
}

static int must_leave(const Task *task, clock_t started)
{
    return *task->stop
        || (task->patience > 0 && (double)(clock() - started) > task->patience*CLOCKS_PER_SEC);
}

/* Go on with all motions of the task that wait or run, until none is left or it is time to leave.
   Several threads may do this with one task. */
void run(Task *task)
{
    Lanes lanes = {.task = task};
    const clock_t started = clock();
    int leaving = 0, busy = 0;
    for (int lane = 0; lane < LANES; lane++) {
        take_next(&lanes, lane);
        note(&lanes, lane);
        busy += lanes.errands[lane].mode != IDLE;
    }
    for (int64_t turn = 0; busy; turn++) {
        /* a motion may be over where it begins, and the next one, too */
        while (any(lanes.fresh)) {
            const mask fresh = lanes.fresh;
            begin(&lanes);
            lanes.fresh = (mask){0};
            for (int lane = 0; lane < LANES; lane++) {
                if (WORD(fresh, lane)) {
                    busy -= conclude(&lanes, lane, leaving);
                }
            }
        }
        if (any(lanes.taken)) {
            watch(&lanes);
        }
        if (turn % TURNS_BETWEEN_LOOKS == 0) {
            leaving |= must_leave(task, started);
        }
        mask kept, broken;
        const mask attention = advance(&lanes, &kept, &broken) | ((mask){0} - leaving);
        if (!any(attention)) {
            move(&lanes, kept);
            continue;
        }
        for (int lane = 0; lane < LANES; lane++) {
            if (WORD(attention, lane)) {
                const int moves =
                    attend(&lanes, lane, WORD(kept, lane) != 0, WORD(broken, lane) != 0);
                WORD(kept, lane) = -moves;
            }
        }
        move(&lanes, kept);
        for (int lane = 0; lane < LANES; lane++) {
            if (WORD(attention, lane)) {
                busy -= conclude(&lanes, lane, leaving);
            }
        }
    }
}

int64_t trajectory_size(void)
{
    return sizeof(Trajectory);
}
