/* Motions, as many at once as there are lanes, each with its own step size.

   Every iteration of run() makes one step in every lane, from the state of the lane's motion:
   either to advance the motion, or within an accepted step. A lane whose motion ends loads the next
   one. The result of a motion depends on no other motion. */

enum { STEPS_BETWEEN_CHECKS = 64 };

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
        const mask plain = lanes.dense & ~lanes.crossed;
        if (any(plain)) {
            sample_lanes(&lanes, plain, lanes.h, lanes.h);
        }
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
