/* Stages of an implicit method by Newton's iteration, in one lane.

   The derivatives k of the stages fulfil k_i = f(t + c_i h, z + h sum_j a_ij k_j). A simplified
   iteration has one Jacobian J for all stages. With A = T M T^-1, where M has blocks of size 1 and 2
   for real eigenvalues and pairs of complex ones, its matrix I - h A (x) J falls apart into matrices
   I - h M_b (x) J (E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, section
   IV.8). The stages contain A itself: T and M decide only how fast the iteration converges.

   Defined before this file, beside that of step.h: JACOBIAN, and the method, by STAGES, A, C, T,
   T_INVERSE, M, BLOCKS, BLOCK_SIZES, FACTORS, and the reciprocal denominators of the Lagrange
   polynomials of the nodes, LAGRANGE, which are 0 for nodes that coincide. */

enum {
    UNKNOWNS = STAGES*DIM,
    MAX_CONTROLLED_ITERATIONS = 7 + 2*(STAGES - 3)*(STAGES > 3),
    MAX_FIXED_ITERATIONS = 50,
    MAX_FULL_ITERATIONS = 12
};

/* A Jacobian is kept for the next step while an iteration reduces the error to this part. */
static const double KEPT_RATE = 1e-3;
/* Error of the stages of a controlled step, relative to the tolerance. */
static const double SHARE = 0.01;
/* The iteration of fixed steps ends when the relative change is below CLOSE; numbers not much larger
   than TINY have fewer digits than others. */
static const double CLOSE = 1e-14, TINY = 1e-290;
/* The shortest part of a step by which a solution is continued. */
static const double SHORTEST_PART = 0x1p-12;

/* The last linearisation of this thread: motions depend on its point and h only. */
typedef struct {
    int is_valid, is_regular;
    double t, h, z[DIM], params[PARAMETERS + 1];
    double jacobian[DIM*DIM], largest;
    double factors[FACTORS];
    int pivots[UNKNOWNS];
} Linearisation;
static __thread Linearisation linearisation;
static __thread double full_matrix[UNKNOWNS*UNKNOWNS];

/* Provide the Jacobian at a point, and the factors of all blocks; 0 if a block is singular. */
static int linearise(double t, const double *z, double h, const double *params)
{
    Linearisation *now = &linearisation;
    const size_t params_size = PARAMETERS*sizeof *params;
    const int is_same = now->is_valid && now->t == t && !memcmp(now->z, z, sizeof now->z)
        && !memcmp(now->params, params, params_size);
    if (!is_same) {
        JACOBIAN(t, z, params, now->jacobian);
        now->t = t;
        memcpy(now->z, z, sizeof now->z);
        memcpy(now->params, params, params_size);
        now->largest = 0.0;
        for (int n = 0; n < DIM*DIM; n++) {
            now->largest = fmax(now->largest, fabs(now->jacobian[n]));
        }
    }
    if (is_same && now->h == h) {
        return now->is_regular;
    }
    now->h = h;
    now->is_valid = now->is_regular = 1;
    double *matrix = now->factors;
    for (int block = 0, first = 0; block < BLOCKS; block++) {
        const int size = BLOCK_SIZES[block], rows = size*DIM;
        for (int i = 0; i < rows; i++) {
            for (int j = 0; j < rows; j++) {
                const double weight = h*M[first + i/DIM][first + j/DIM];
                matrix[i*rows + j] = (i == j) - weight*now->jacobian[i % DIM*DIM + j % DIM];
            }
        }
        now->is_regular &= factorise(rows, matrix, now->pivots + first*DIM);
        matrix += rows*rows;
        first += size;
    }
    return now->is_regular;
}

/* Each row of `products` is the sum of rows of `rows` with weights from a row of `matrix`. */
static inline void multiply(
    const double (*matrix)[STAGES], const double (*rows)[DIM], double (*products)[DIM])
{
    for (int i = 0; i < STAGES; i++) {
        for (int n = 0; n < DIM; n++) {
            double sum = 0.0;
            for (int j = 0; j < STAGES; j++) {
                sum += matrix[i][j]*rows[j][n];
            }
            products[i][n] = sum;
        }
    }
}

/* Derivatives at all stages, minus k. */
static void residuals(
    const State *start, double h, const double *params, const double (*k)[DIM],
    double (*states)[DIM], double (*residual)[DIM])
{
    multiply(A, k, states);
    for (int i = 0; i < STAGES; i++) {
        for (int n = 0; n < DIM; n++) {
            states[i][n] = start->z[n] + h*states[i][n];
        }
        RHS(start->t + C[i]*h, states[i], params, residual[i]);
        for (int n = 0; n < DIM; n++) {
            residual[i][n] -= k[i][n];
        }
    }
}

/* The change of k by a simplified iteration, in place of its residual. */
static void solve_blocks(double (*residual)[DIM])
{
    double parts[STAGES][DIM];
    multiply(T_INVERSE, (const double (*)[DIM])residual, parts);
    const double *factors = linearisation.factors;
    for (int block = 0, first = 0; block < BLOCKS; block++) {
        const int size = BLOCK_SIZES[block];
        solve(size*DIM, factors, linearisation.pivots + first*DIM, parts[first]);
        factors += size*DIM*size*DIM;
        first += size;
    }
    multiply(T, (const double (*)[DIM])parts, residual);
}

static void add(double (*k)[DIM], const double (*change)[DIM])
{
    for (int i = 0; i < STAGES; i++) {
        for (int n = 0; n < DIM; n++) {
            k[i][n] += change[i][n];
        }
    }
}

/* Largest change relative to the state and its increments, NaN if one is not finite. */
static double relative_change(
    const double *z, double h, const double (*k)[DIM], const double (*change)[DIM])
{
    double largest = 0.0, largest_change = 0.0, largest_increment = 0.0, check = 0.0;
    for (int n = 0; n < DIM; n++) {
        largest = fmax(largest, fabs(z[n]));
    }
    for (int i = 0; i < STAGES; i++) {
        for (int n = 0; n < DIM; n++) {
            largest_change = fmax(largest_change, fabs(h*change[i][n]));
            largest_increment = fmax(largest_increment, fabs(h*k[i][n]));
            check += change[i][n] - change[i][n];
        }
    }
    return largest_change/(largest + largest_increment + TINY) + check;
}

/* Norm of the change of k relative to the tolerances. */
static double scaled_change(
    const Task *task, const double *z, double h, const double (*change)[DIM])
{
    double total = 0.0;
    for (int n = 0; n < DIM; n++) {
        const double inverse = h/fmax(task->atol + task->rtol*fabs(z[n]), 1e-75);
        for (int i = 0; i < STAGES; i++) {
            total += (change[i][n]*inverse)*(change[i][n]*inverse);
        }
    }
    return sqrt(total/UNKNOWNS);
}

/* Whether changes no longer decrease since rounding errors, multiplied by a large Jacobian, prevent
   it. */
static int is_rounding(double change, double previous, double steepest)
{
    return change <= CLOSE || (change < CLOSE*(100 + steepest) && change >= previous/2);
}

/* Iterate with the Jacobian of a point; `rate` is the part of the error that an iteration leaves.
   Returns whether it converges, early where it does not. */
static int iterate(
    const Task *task, const State *start, double h, const double *params, double t,
    const double *z, double (*k)[DIM], double *rate, StepResult *result)
{
    double states[STAGES][DIM], change[STAGES][DIM], previous = INFINITY;
    const int limit = task->fixed_h ? MAX_FIXED_ITERATIONS : MAX_CONTROLLED_ITERATIONS;
    if (!linearise(t, z, h, params)) {
        return 0;
    }
    /* not known before the second change: less certain than in the last step */
    *rate = sqrt(*rate);
    for (int iteration = 1; iteration <= limit; iteration++) {
        residuals(start, h, params, (const double (*)[DIM])k, states, change);
        result->evaluations += STAGES;
        solve_blocks(change);
        add(k, (const double (*)[DIM])change);
        const double size = task->fixed_h
            ? relative_change(start->z, h, (const double (*)[DIM])k, (const double (*)[DIM])change)
            : scaled_change(task, start->z, h, (const double (*)[DIM])change);
        if (iteration > 1) {
            *rate = size/previous;
        }
        if (task->fixed_h ? is_rounding(size, previous, fabs(h)*linearisation.largest)
                          : size == 0 || (*rate < 1 && size**rate < SHARE*(1 - *rate))) {
            *rate = fmin(*rate, 1);
            return 1;
        }
        if (!(size < INFINITY) || (iteration > 1 && *rate >= 1)) {
            return 0;
        }
        previous = size;
    }
    return 0;
}

/* Newton's iteration with a Jacobian for each stage. */
static int iterate_fully(
    const State *start, double h, const double *params, double (*k)[DIM], StepResult *result)
{
    double states[STAGES][DIM], change[STAGES][DIM], jacobian[DIM*DIM], previous = INFINITY;
    int pivots[UNKNOWNS];
    for (int iteration = 1; iteration <= MAX_FULL_ITERATIONS; iteration++) {
        residuals(start, h, params, (const double (*)[DIM])k, states, change);
        result->evaluations += STAGES;
        result->jacobians += STAGES;
        double steepest = 0.0;
        for (int i = 0; i < UNKNOWNS; i++) {
            if (i % DIM == 0) {
                JACOBIAN(start->t + C[i/DIM]*h, states[i/DIM], params, jacobian);
            }
            for (int j = 0; j < UNKNOWNS; j++) {
                const double slope = jacobian[i % DIM*DIM + j % DIM];
                full_matrix[i*UNKNOWNS + j] = (i == j) - h*A[i/DIM][j/DIM]*slope;
                steepest = fmax(steepest, fabs(h*slope));
            }
        }
        if (!factorise(UNKNOWNS, full_matrix, pivots)) {
            return 0;
        }
        solve(UNKNOWNS, full_matrix, pivots, change[0]);
        add(k, (const double (*)[DIM])change);
        const double size =
            relative_change(start->z, h, (const double (*)[DIM])k, (const double (*)[DIM])change);
        if (is_rounding(size, previous, steepest)) {
            return 1;
        }
        if (!(size < previous)) {
            return 0;
        }
        previous = size;
    }
    return 0;
}

/* Derivatives at the nodes of a step of `ratio` times the length, from those of the polynomial
   through `from`; the step starts at the part `begin` of the polynomial's. */
static void extrapolate(double begin, double ratio, const double (*from)[DIM], double (*k)[DIM])
{
    double weights[STAGES][STAGES];
    for (int i = 0; i < STAGES; i++) {
        const double x = begin + ratio*C[i];
        for (int j = 0; j < STAGES; j++) {
            weights[i][j] = LAGRANGE[j];
            for (int m = 0; m < STAGES; m++) {
                weights[i][j] *= m == j ? 1.0 : x - C[m];
            }
        }
    }
    multiply((const double (*)[STAGES])weights, from, k);
}

/* Follow the solution from that of a short step to that of the whole step, where a good first guess
   is needed: each part of the step gives one for a longer part. */
static int continue_from_short_steps(
    const State *start, double h, const double *params, const double *derivative,
    double (*k)[DIM], StepResult *result)
{
    double solved[STAGES][DIM], part = 0.0, advance = 0.5;
    while (advance >= SHORTEST_PART) {
        const double aim = fmin(part + advance, 1.0);
        if (part > 0 && LAGRANGE[0] != 0) {
            extrapolate(0.0, aim/part, (const double (*)[DIM])solved, k);
        }
        for (int i = 0; i < STAGES && !(part > 0 && LAGRANGE[0] != 0); i++) {
            memcpy(k[i], part > 0 ? solved[i] : derivative, sizeof k[i]);
        }
        if (!iterate_fully(start, aim*h, params, k, result)) {
            advance /= 2;
        } else if (aim == 1.0) {
            return 1;
        } else {
            memcpy(solved, k, sizeof solved);
            part = aim;
            advance *= 2;
        }
    }
    return 0;
}

/* The polynomial of a motion that starts with a derivative and a first step. */
static void start_polynomial(State *state, double h, const double *derivative)
{
    for (int i = 0; i < STAGES; i++) {
        memcpy(state->polynomial + i*DIM, derivative, DIM*sizeof *derivative);
    }
    state->length[0] = h;
    state->rate[0] = 1.0;
}

/* Solve the stages; NaN where that fails. `derivative` is the one at the start. */
static void solve_stages(
    const Task *task, const State *start, double h, const double *params,
    const double *derivative, double (*k)[DIM], State *end, StepResult *result)
{
    const double (*last)[DIM] = (const double (*)[DIM])start->polynomial;
    const int has_polynomial = LAGRANGE[0] != 0;
    end->jacobian_t[0] = start->jacobian_t[0];
    memcpy(end->jacobian_z, start->jacobian_z, sizeof end->jacobian_z);
    for (int is_new = start->rate[0] > KEPT_RATE; is_new < 2; is_new++) {
        if (is_new) {
            end->jacobian_t[0] = start->t;
            memcpy(end->jacobian_z, start->z, sizeof end->jacobian_z);
            result->jacobians += 1;
        }
        for (int i = 0; i < STAGES; i++) {
            memcpy(k[i], derivative, sizeof k[i]);
        }
        if (has_polynomial) {
            extrapolate(1.0, h/start->length[0], last, k);
        }
        end->rate[0] = start->rate[0];
        if (iterate(task, start, h, params, end->jacobian_t[0], end->jacobian_z, k, end->rate,
                    result)) {
            return;
        }
    }
    end->rate[0] = 1.0;
    if (task->fixed_h && continue_from_short_steps(start, h, params, derivative, k, result)) {
        return;
    }
    k[0][0] = NAN;
}
