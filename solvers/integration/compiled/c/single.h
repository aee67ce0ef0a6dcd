/* A single motion from start to end, called without preparation in Python. */

enum { NOT_FINITE_INPUT = -1 };

/* Integrate the task's only trajectory from y0 at t0 to t1, where its state is y1. Returns its
   status; while that is RUNNING, call again with y0 = NULL. */
int64_t single(Task *task, double t0, double t1, const double *y0, double *y1)
{
    Trajectory *trajectory = task->trajectories;
    Motion *motion = (Motion *)trajectory->motion;
    State *state = &motion->state;
    if (y0) {
        double check = t0 - t0 + t1 - t1;
        for (int n = 0; n < ORDINARY; n++) {
            check += y0[n] - y0[n];
        }
        if (check != 0.0) {
            return NOT_FINITE_INPUT;
        }
        const double largest = fmax(fabs(t0), fabs(t1));
        memset(motion, 0, offsetof(Motion, params));
        state->t = t0;
        motion->t_end = t1;
        motion->min_h = MIN_H_ULPS*(nextafter(largest, INFINITY) - largest);
        from_ordinary(t0, y0, state->z, state->turns, motion->params);
        trajectory->status = WAITING;
        trajectory->rows = 0;
    }
    task->next = 0;
    run(task);
    to_ordinary(state->t, state->z, state->turns, y1, motion->params);
    return trajectory->status;
}
