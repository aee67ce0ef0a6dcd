/* One motion by Gauss collocation in numbers of type `real`, which are longer than doubles.

   The stages of a step are solved in the shorter type `lower` first, by a fixed-point iteration.
   Then their residuals are computed in `real`, and corrected in `lower`: each correction adds about
   half the digits of `lower`, and few evaluations in `real` are necessary.

   The state is that of the form, of DIM components, followed by the ANGLES that it knows by sine and
   cosine. Defined before this file: real, lower, EPSILON, LOWER_EPSILON, RHS, LOWER_RHS; DIM, ANGLES,
   PARAMETERS, ORDINARY, PARTS; the indices COLUMN of components of an ordinary state, and RATE of the
   velocities of angles; STAGES, A, B, C, and LEGENDRE, which takes values at the nodes C to Legendre
   coefficients, and LOWER_A etc. */

enum { SIZE = DIM + ANGLES, ORDER = 2*STAGES };
enum { MOST_SWEEPS = 60, MOST_CORRECTIONS = 12, STEPS_BETWEEN_CHECKS = 8 };

/* Samples within a step: parts of the time between checks. */
enum { SAMPLES_PER_STEP = 64 };

/* Factors of step lengths, and the relative change over the first step. */
static const double SAFETY = 0.85, SHRINK = 0.2, GROW = 1.5, FIRST = 0.05;
/* Magnitude of a component above which it is resolved relatively. */
static const double SMALL = 1e-3;

typedef struct {
    const double *times;
    int64_t count;
    double *rows;
    double rtol;
} Task;

typedef struct {
    real t, t_low, y[SIZE], y_low[SIZE], params[PARAMETERS + 1];    /* _low: rounding errors */
    lower polynomial[STAGES][DIM];  /* Legendre coefficients of the derivative over the last step */
    lower h, last_h;                /* lengths of the next and the last step */
    double steps, rejected;
    int64_t rows;                   /* samples written */
} Motion;

/* Upper halves of registers that are in use slow down the arithmetic of __float128. */
static inline void clear_upper_halves(void)
{
#ifdef __AVX__
    __builtin_ia32_vzeroupper();
#endif
}

/* x + y; `low` is the rounding error of x before, and of the sum afterwards. */
static inline real compensated_sum(real x, real y, real *low)
{
    const real change = y + *low, total = x + change, part = total - x;
    *low = (x - (total - part)) + (change - part);
    return total;
}

static inline double magnitude(lower x) { return fabs((double)x); }

/* Largest h |x| of a component relative to its magnitude; NaN if one is. */
static double relative_size(const lower *x, lower h, const lower *scale)
{
    double largest = 0;
    for (int n = 0; n < DIM; n++) {
        const double size = magnitude(h*x[n])/(magnitude(scale[n]) + SMALL);
        largest = size <= largest ? largest : size;
    }
    return largest;
}

/* Values at x of the polynomials with these Legendre coefficients. */
static void evaluate(lower x, lower (*coefficients)[DIM], lower *values)
{
    lower before = 0, now = 1;
    memcpy(values, coefficients[0], sizeof coefficients[0]);
    for (int m = 1; m < STAGES; m++) {
        const lower next = ((2*m - 1)*(2*x - 1)*now - (m - 1)*before)/m;
        before = now;
        now = next;
        for (int n = 0; n < DIM; n++) {
            values[n] += now*coefficients[m][n];
        }
    }
}

/* Solve the stages k of a step in `lower`, from a first approximation; returns whether it converges.
   Each stage is used by the following ones at once. */
static int solve(lower t, const lower *y, lower h, const lower *params, lower (*k)[DIM])
{
    double last = INFINITY;
    for (int sweep = 0; sweep < MOST_SWEEPS; sweep++) {
        double largest = 0;
        for (int i = 0; i < STAGES; i++) {
            lower stage[DIM], value[DIM], change[DIM];
            for (int n = 0; n < DIM; n++) {
                lower sum = 0;
                for (int j = 0; j < STAGES; j++) {
                    sum += LOWER_A[i][j]*k[j][n];
                }
                stage[n] = y[n] + h*sum;
            }
            LOWER_RHS(t + h*LOWER_C[i], stage, params, value);
            for (int n = 0; n < DIM; n++) {
                change[n] = value[n] - k[i][n];
                k[i][n] = value[n];
            }
            const double size = relative_size(change, h, stage);
            largest = size <= largest ? largest : size;
        }
        if (!(largest < INFINITY)) {
            return 0;
        }
        const int stagnates = largest > last/2;
        if (largest <= 4*(double)LOWER_EPSILON || (stagnates && largest < 1e-10)) {
            return 1;
        }
        if (stagnates && sweep > 4) {
            return 0;
        }
        last = largest;
    }
    return 0;
}

/* The correction d of stages in which the residuals r remain: d = r + J h A d, with products of the
   Jacobian J as differences of the right-hand side in `lower`. */
static void correct(
    lower t, lower (*stages)[DIM], lower h, const lower *params, lower (*r)[DIM], double size,
    lower (*d)[DIM])
{
    /* half the digits of `lower` are left to the difference */
    const double scale = exp2(floor(log2(sqrt((double)LOWER_EPSILON)/size)));
    lower values[STAGES][DIM];
    for (int i = 0; i < STAGES; i++) {
        LOWER_RHS(t + h*LOWER_C[i], stages[i], params, values[i]);
        memcpy(d[i], r[i], sizeof d[i]);
    }
    for (int sweep = 0; sweep < MOST_SWEEPS; sweep++) {
        double largest = 0;
        for (int i = 0; i < STAGES; i++) {
            lower stage[DIM], value[DIM], change[DIM];
            for (int n = 0; n < DIM; n++) {
                lower sum = 0;
                for (int j = 0; j < STAGES; j++) {
                    sum += LOWER_A[i][j]*d[j][n];
                }
                stage[n] = stages[i][n] + (lower)scale*h*sum;
            }
            LOWER_RHS(t + h*LOWER_C[i], stage, params, value);
            for (int n = 0; n < DIM; n++) {
                value[n] = r[i][n] + (value[n] - values[i][n])/(lower)scale;
                change[n] = value[n] - d[i][n];
                d[i][n] = value[n];
            }
            const double part = relative_size(change, h, stages[i]);
            largest = part <= largest ? largest : part;
        }
        if (!(largest > 1e-8*size)) {
            return;
        }
    }
}

/* Refine stages that are solved in `lower` to the tolerance; returns whether that succeeds, with the
   stages k. */
static int refine(
    const Motion *motion, real h, const lower *params, double rtol, lower (*solved)[DIM],
    real (*k)[DIM])
{
    for (int i = 0; i < STAGES; i++) {
        for (int n = 0; n < DIM; n++) {
            k[i][n] = solved[i][n];
        }
    }
    double last = INFINITY;
    for (int count = 0; count < MOST_CORRECTIONS; count++) {
        lower stages[STAGES][DIM], r[STAGES][DIM], d[STAGES][DIM];
        real values[STAGES][DIM];
        double size = 0;
        clear_upper_halves();
        for (int i = 0; i < STAGES; i++) {
            real stage[DIM];
            for (int n = 0; n < DIM; n++) {
                real sum = 0;
                for (int j = 0; j < STAGES; j++) {
                    sum += A[i][j]*k[j][n];
                }
                stage[n] = motion->y[n] + (h*sum + motion->y_low[n]);
                stages[i][n] = (lower)stage[n];
            }
            RHS(motion->t + h*C[i], stage, motion->params, values[i]);
            for (int n = 0; n < DIM; n++) {
                r[i][n] = (lower)(values[i][n] - k[i][n]);
            }
            const double part = relative_size(r[i], (lower)h, stages[i]);
            size = part <= size ? size : part;
        }
        if (!(size < 1)) {
            return 0;
        }
        const int stagnates = size > last/2;
        if (size <= 0.1*rtol || size <= 4*(double)EPSILON || stagnates) {
            memcpy(k, values, sizeof values);
            return size < sqrt((double)EPSILON);
        }
        last = size;
        correct((lower)motion->t, stages, (lower)h, params, r, size, d);
        for (int i = 0; i < STAGES; i++) {
            for (int n = 0; n < DIM; n++) {
                k[i][n] += d[i][n];
            }
        }
    }
    return 0;
}

/* Legendre coefficients of the polynomials with the values k at the nodes. */
static void transform(lower (*k)[DIM], lower (*coefficients)[DIM])
{
    for (int m = 0; m < STAGES; m++) {
        for (int n = 0; n < DIM; n++) {
            coefficients[m][n] = 0;
            for (int j = 0; j < STAGES; j++) {
                coefficients[m][n] += LOWER_LEGENDRE[m][j]*k[j][n];
            }
        }
    }
}

/* A first approximation of the stages: polynomials at the nodes of a step that has a start and a
   length in units of their own step. */
static void predict(lower (*polynomial)[DIM], lower start, lower length, lower (*k)[DIM])
{
    for (int i = 0; i < STAGES; i++) {
        evaluate(start + length*LOWER_C[i], polynomial, k[i]);
    }
}

/* The state, and whole changes of angles: h times the mean velocity, with stages y + h A k and
   b A = b (1 - c). */
static void move(Motion *motion, real h, real (*k)[DIM])
{
    clear_upper_halves();
    for (int a = 0; a < ANGLES; a++) {
        real change = 0;
        for (int i = 0; i < STAGES; i++) {
            change += B[i]*(1 - C[i])*k[i][RATE[a]];
        }
        real *y = motion->y + DIM + a, *low = motion->y_low + DIM + a;
        *y = compensated_sum(*y, h*(motion->y[RATE[a]] + h*change), low);
    }
    for (int n = 0; n < DIM; n++) {
        real change = 0;
        for (int i = 0; i < STAGES; i++) {
            change += B[i]*k[i][n];
        }
        motion->y[n] = compensated_sum(motion->y[n], h*change, motion->y_low + n);
    }
    motion->t = compensated_sum(motion->t, h, &motion->t_low);
}

/* Write the ordinary state after a change. */
static void write_row(Motion *motion, const lower *change, const Task *task)
{
    for (int k = 0; k < ORDINARY; k++) {
        const int n = COLUMN[k];
        task->rows[motion->rows*ORDINARY + k] = (double)(motion->y[n] + change[n]);
    }
    motion->rows++;
}

/* Write the states at sample times within a step, by shorter steps in `lower`; returns whether these
   converge. */
static int write_samples(
    Motion *motion, lower h, lower (*polynomial)[DIM], const lower *y, const lower *params,
    const Task *task)
{
    while (motion->rows < task->count) {
        const real left = (task->times[motion->rows] - motion->t) - motion->t_low;
        const lower elapsed = (lower)left;
        if (magnitude(elapsed) >= magnitude(h)) {
            break;
        }
        lower k[STAGES][DIM], change[SIZE] = {0};
        real refined[STAGES][DIM];
        predict(polynomial, 0, elapsed/h, k);
        if (!solve((lower)motion->t, y, elapsed, params, k)) {
            return 0;
        }
        /* the equations themselves have rounding errors, which are too large in doubles */
        const int is_rough = (double)LOWER_EPSILON > DBL_EPSILON/2;
        if (is_rough && !refine(motion, left, params, task->rtol, k, refined)) {
            return 0;
        }
        for (int i = 0; i < STAGES; i++) {
            for (int n = 0; n < DIM && is_rough; n++) {
                k[i][n] = (lower)refined[i][n];
            }
            for (int n = 0; n < DIM; n++) {
                change[n] += elapsed*LOWER_B[i]*k[i][n];
            }
            for (int a = 0; a < ANGLES; a++) {
                const lower velocity = y[RATE[a]] + elapsed*(1 - LOWER_C[i])*k[i][RATE[a]];
                change[DIM + a] += elapsed*LOWER_B[i]*velocity;
            }
        }
        write_row(motion, change, task);
    }
    return 1;
}

/* One step of length h, unless its error is above the tolerance. Returns the factor for the next one,
   or 0 where the stages do not converge; it is negative where the step is too long. */
static double step(Motion *motion, real h, const Task *task)
{
    lower k[STAGES][DIM], polynomial[STAGES][DIM], y[DIM], params[PARAMETERS + 1];
    for (int n = 0; n < DIM; n++) {
        y[n] = (lower)motion->y[n];
    }
    for (int n = 0; n < PARAMETERS; n++) {
        params[n] = (lower)motion->params[n];
    }
    predict(motion->polynomial, 1, (lower)h/motion->last_h, k);
    if (!solve((lower)motion->t, y, (lower)h, params, k)) {
        return 0;
    }
    transform(k, polynomial);
    /* the last coefficient decreases as the power STAGES of h, and the error as its square */
    const double last = relative_size(polynomial[STAGES - 1], (lower)h, y);
    const double before = relative_size(polynomial[STAGES - 2], (lower)h, y);
    const double error = fmax(last*last, 0.01*before*before)/task->rtol;
    const double factor = SAFETY*pow(error + 1e-60, -1.0/ORDER);
    const double limited = fmin(fmax(factor, SHRINK), GROW);
    if (!(error <= 1)) {
        return -limited;
    }
    real stages[STAGES][DIM];
    const int64_t rows = motion->rows;
    if (!refine(motion, h, params, task->rtol, k, stages)
            || !write_samples(motion, (lower)h, polynomial, y, params, task)) {
        motion->rows = rows;
        return 0;
    }
    move(motion, h, stages);
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
    return (double)EPSILON;
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
        motion->params[n] = params[n] + params[n]*(changes[n]*EPSILON);
    }
    for (int n = 0; n < SIZE; n++) {
        motion->y_low[n] = state[n][0]*(changes[PARAMETERS + n]*EPSILON);
        for (int part = 0; part < PARTS; part++) {
            motion->y[n] = compensated_sum(motion->y[n], state[n][part], motion->y_low + n);
        }
    }
    real derivative[DIM];
    lower rate[DIM], y[DIM];
    RHS(motion->t, motion->y, motion->params, derivative);
    for (int n = 0; n < DIM; n++) {
        y[n] = (lower)motion->y[n];
        motion->polynomial[0][n] = rate[n] = (lower)derivative[n];
    }
    const double size = relative_size(rate, 1, y);
    const double first = size*fabs(duration) > FIRST ? copysign(FIRST/size, duration) : duration;
    motion->h = motion->last_h = first;
}

/* Continue a motion until the last sample, for some seconds of processor time. */
int64_t extended_advance(
    Motion *motion, const double *times, int64_t count, double *rows, double rtol, double shortest,
    int64_t max_steps, double seconds)
{
    const Task task = {.times = times, .count = count, .rows = rows, .rtol = rtol};
    const lower unchanged[SIZE] = {0};
    const clock_t started = clock();
    for (int64_t attempt = 1;; attempt++) {
        while (motion->rows < count && times[motion->rows] == motion->t) {
            write_row(motion, unchanged, &task);
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
        const real h = is_last ? left : (real)motion->h;
        const double factor = step(motion, h, &task);
        if (factor > 0) {
            motion->steps++;
            if (is_last) {
                motion->t = end;
                motion->t_low = 0;
            } else {
                motion->h *= factor;
            }
        } else {
            motion->rejected++;
            motion->h = (lower)h*(factor ? -factor : 0.25);
        }
    }
}

/* Time, samples, steps and rejected steps so far. */
void extended_progress(const Motion *motion, double *numbers)
{
    numbers[0] = (double)motion->t;
    numbers[1] = (double)motion->rows;
    numbers[2] = motion->steps;
    numbers[3] = motion->rejected;
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
    extended_advance(&motion, times, 2, *rows, 1e-10, 1e-10, 10, 1);
}
