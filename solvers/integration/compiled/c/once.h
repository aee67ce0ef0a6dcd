/* One motion from beginning to end, without anything else to do with it. */

enum { NOT_NUMBERS = -1 };

/* The only trajectory of the task goes from y0 at t0 to t1, where its state is y1. Returns its
   status; while that is RUNNING, call again with y0 = NULL. */
int64_t once(Task *task, double t0, double t1, const double *y0, double *y1)
{
    Trajectory *trajectory = task->trajectories;
    Motion *motion = (Motion *)trajectory->numbers;
    Place *place = &motion->place;
    if (y0) {
        double all = t0 - t0 + t1 - t1;
        for (int n = 0; n < ORDINARY; n++) {
            all += y0[n] - y0[n];
        }
        if (all != 0.0) {
            return NOT_NUMBERS;
        }
        const double largest = fmax(fabs(t0), fabs(t1));
        memset(motion, 0, offsetof(Motion, params));
        place->t = t0;
        motion->t_end = t1;
        motion->shortest = SHORTEST*(nextafter(largest, INFINITY) - largest);
        enter(t0, y0, place->z, place->turns, motion->params);
        trajectory->status = WAITING;
        trajectory->rows = 0;
    }
    task->next = 0;
    run(task);
    leave(place->t, place->z, place->turns, y1, motion->params);
    return trajectory->status;
}
