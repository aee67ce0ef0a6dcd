/* One step with arbitrary numbers, in a process of its own before a new library is used: a library
   that cannot run on this processor ends that process only. */
void probe(void)
{
    static Trajectory trajectory;
    const int64_t stop = 0;
    Task task = {.count = 1, .trajectories = &trajectory, .rtol = 1e-3, .atol = 1e-3};
    task.max_steps = 1;
    task.stop = &stop;
    for (int k = 1; k < MOTION_SIZE; k++) {     /* the first one is the time, which begins at 0 */
        trajectory.motion[k] = 0.5;
    }
    run(&task);
}
