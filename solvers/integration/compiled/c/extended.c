/* One motion by Gauss collocation in numbers longer than doubles.

   Defined before this file: the motion of extended_motion.h; the types Stages and RefinedStages, with
   predict(), solve(), refine(), transform(), move() and derivative_at_start(); project(), which moves a
   motion onto its constraints; keep_integrals(), which lets it keep the values of its integrals;
   epsilon(); the indices COLUMN of components of an ordinary state; ORDINARY, PARTS. */

enum { STEPS_BETWEEN_CHECKS = 8 };

/* Samples within a step: parts of the time between checks. */
enum { SAMPLES_PER_STEP = 64 };

/* Factors of step lengths, and the relative change over the first step. */
static const double SAFETY = 0.85, SHRINK = 0.2, GROW = 1.5, FIRST = 0.05;

typedef struct {
    const double *times;
    int64_t count;
    double *rows;
    double rtol;
} Task;

/* Write the ordinary state into row k. */
static void write_row(const Motion *motion, int64_t row, const Task *task)
{
    for (int k = 0; k < ORDINARY; k++) {
        task->rows[row*ORDINARY + k] = (double)motion->y[COLUMN[k]];
    }
}

/* Write the states at sample times within a step, by shorter steps; returns the number of samples so
   far, or -1 where these do not converge. */
static int64_t write_samples(const Motion *motion, lower h, Polynomial polynomial, const Task *task)
{
    int64_t row = motion->rows;
    for (; row < task->count; row++) {
        const real elapsed = (task->times[row] - motion->t) - motion->t_low;
        if (magnitude((lower)elapsed) >= magnitude(h)) {
            break;
        }
        Stages k;
        RefinedStages refined;
        Motion moved = *motion;
        predict(polynomial, 0, (lower)elapsed/h, k);
        if (!solve(motion, (lower)elapsed, task->rtol, k)
                || !refine(motion, elapsed, task->rtol, k, refined)) {
            return -1;
        }
        move(&moved, elapsed, refined);
        project(&moved);
        write_row(&moved, row, task);
    }
    return row;
}

/* Largest change in a step by Legendre polynomial m. */
static double coefficient_size(Polynomial polynomial, int m, lower h, const real *y)
{
    double largest = 0;
    for (int n = 0; n < DIM; n++) {
        const double size = relative(h*polynomial[n][m], (lower)y[n]);
        largest = size <= largest ? largest : size;
    }
    return largest;
}

/* One step of length h, unless its error is above the tolerance. Returns the factor for the next one,
   or 0 where the stages do not converge; it is negative where the step is too long. */
static double step(Motion *motion, real h, const Task *task)
{
    Stages k;
    RefinedStages refined;
    Polynomial polynomial;
    predict(motion->polynomial, 1, (lower)h/motion->last_h, k);
    if (!solve(motion, (lower)h, task->rtol, k)) {
        return 0;
    }
    transform(k, polynomial);
    /* the last coefficient decreases as the power STAGES of h, and the error as its square */
    const double last = coefficient_size(polynomial, STAGES - 1, (lower)h, motion->y);
    const double before = coefficient_size(polynomial, STAGES - 2, (lower)h, motion->y);
    const double error = fmax(last*last, 0.01*before*before)/task->rtol;
    const double factor = SAFETY*pow(error + 1e-60, -1.0/ORDER);
    const double limited = fmin(fmax(factor, SHRINK), GROW);
    if (!(error <= 1)) {
        return -limited;
    }
    if (!refine(motion, h, task->rtol, k, refined)) {
        return 0;
    }
    const int64_t rows = write_samples(motion, (lower)h, polynomial, task);
    if (rows < 0) {
        return 0;
    }
    motion->rows = rows;
    move(motion, h, refined);
    project(motion);
    memcpy(motion->polynomial, polynomial, sizeof polynomial);
    motion->last_h = (lower)h;
    return limited;
}

/* Size of a motion in bytes. */
int64_t extended_size(void)
{
    return sizeof(Motion);
}

/* The spacing of numbers above 1. */
double extended_epsilon(void)
{
    return epsilon();
}

/* Start a motion at time t; a component of the state is a sum of PARTS doubles, the largest first.
   Parameters and components are changed by multiples of EPSILON of them. */
void extended_start(
    Motion *motion, double t, double duration, const double (*state)[PARTS], const double *params,
    const double *changes)
{
    memset(motion, 0, sizeof *motion);
    motion->t = t;
    for (int n = 0; n < PARAMETERS; n++) {
        motion->params[n] = compensated_sum(
            params[n], params[n]*(changes[n]*EPSILON), motion->params_low + n);
    }
    for (int n = 0; n < SIZE; n++) {
        motion->y_low[n] = state[n][0]*(changes[PARAMETERS + n]*EPSILON);
        for (int part = 0; part < PARTS; part++) {
            motion->y[n] = compensated_sum(motion->y[n], state[n][part], motion->y_low + n);
        }
    }
    keep_integrals(motion);
    project(motion);
    lower rate[DIM];
    derivative_at_start(motion, rate);
    for (int n = 0; n < DIM; n++) {
        motion->polynomial[n][0] = rate[n];
    }
    const double size = coefficient_size(motion->polynomial, 0, 1, motion->y);
    const double first = size*fabs(duration) > FIRST ? copysign(FIRST/size, duration) : duration;
    motion->h = motion->last_h = first;
}

/* Continue a motion until the last sample, for some seconds of processor time. It pauses as SINGULAR
   where steps fall below a part `collapse` of the longest one since the start or the last pause. */
int64_t extended_advance(
    Motion *motion, const double *times, int64_t count, double *rows, double rtol, double shortest,
    double collapse, int64_t max_steps, double seconds)
{
    const Task task = {.times = times, .count = count, .rows = rows, .rtol = rtol};
    const clock_t started = clock();
    for (int64_t attempt = 1;; attempt++) {
        while (motion->rows < count && times[motion->rows] == motion->t) {
            write_row(motion, motion->rows++, &task);
        }
        if (motion->rows >= count) {
            return FINISHED;
        }
        if (motion->steps >= (double)max_steps) {
            return STEP_LIMIT;
        }
        if (attempt % STEPS_BETWEEN_CHECKS == 0
                && (double)(clock() - started) > seconds*CLOCKS_PER_SEC) {
            return RUNNING;
        }
        /* not beyond the last sample, and not so far that samples take long */
        const int64_t next = motion->rows + SAMPLES_PER_STEP;
        const double end = times[next < count ? next : count - 1];
        const real left = (end - motion->t) - motion->t_low;
        const int is_last = magnitude(motion->h)*(1 + 1e-9) >= magnitude((lower)left);
        if (!is_last && !(magnitude(motion->h) >= shortest)) {
            return STEP_TOO_SMALL;
        }
        if (!is_last && magnitude(motion->h) < collapse*magnitude(motion->longest)) {
            motion->longest = motion->h;
            return SINGULAR;
        }
        const real h = is_last ? left : (real)motion->h;
        const double factor = step(motion, h, &task);
        if (factor > 0) {
            motion->steps++;
            if (magnitude((lower)h) > magnitude(motion->longest)) {
                motion->longest = (lower)h;
            }
            if (is_last) {      /* but for the rounding error of `left` */
                motion->t_low += motion->t - end;
                motion->t = end;
            } else {
                motion->h *= factor;
            }
        } else {
            motion->h = (lower)h*(factor ? -factor : 0.25);
        }
    }
}

/* The time, and the ordinary state. */
void extended_progress(const Motion *motion, double *numbers)
{
    for (int k = 0; k < ORDINARY; k++) {
        numbers[1 + k] = (double)motion->y[COLUMN[k]];
    }
    numbers[0] = (double)motion->t;
}

/* One step with arbitrary numbers, in a process of its own before a new library is used. */
void probe(void)
{
    static Motion motion;
    double state[SIZE][PARTS], params[PARAMETERS + 1], times[] = {0, 0.01}, rows[2][ORDINARY];
    const double changes[PARAMETERS + SIZE] = {0};
    for (int n = 0; n < SIZE; n++) {
        for (int part = 0; part < PARTS; part++) {
            state[n][part] = part ? 0 : 0.5;
        }
    }
    for (int n = 0; n < PARAMETERS; n++) {
        params[n] = 0.5;
    }
    extended_start(&motion, 0, 0.01, state, params, changes);
    extended_advance(&motion, times, 2, *rows, 1e-10, 1e-10, 0, 10, 1);
}
