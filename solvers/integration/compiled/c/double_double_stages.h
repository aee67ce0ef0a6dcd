/* Stages of Gauss collocation, each in a lane of a vector, by a fixed-point iteration in doubles.

   Defined before this file, beside extended_motion.h and double_double.h: RHS, for double_double,
   LOWER_RHS, for lanes of doubles; columns of A, LOWER_A and LOWER_LEGENDRE, which takes values at the
   nodes to Legendre coefficients; B, C, B_REST = b (1 - c), LOWER_C; the indices RATE. */

typedef union {
    lanes vector[DIM];
    double number[DIM][STAGES];
} Vectors;
typedef Vectors Stages[1];
typedef double_double RefinedStages[DIM];

static inline double sum_of_lanes(lanes x)
{
    return ((x[0] + x[4]) + (x[2] + x[6])) + ((x[1] + x[5]) + (x[3] + x[7]));
}

/* For each component a matrix, given by its columns, times a vector. */
static inline void product(const lanes *columns, Vectors *vectors, lanes *products)
{
    /* numbers are read from memory: to load one into all lanes takes less than to permute lanes */
    __asm__("" : "+m"(*vectors));
    for (int n = 0; n < DIM; n++) {
        const double *number = vectors->number[n];
        lanes even = columns[0]*number[0], odd = columns[1]*number[1];
        for (int j = 2; j < STAGES; j += 2) {
            even = fused(columns[j], splat(number[j]), even);
            odd = fused(columns[j + 1], splat(number[j + 1]), odd);
        }
        products[n] = even + odd;
    }
}

/* Size of x, relative to the magnitudes of which the reciprocals are given; NaN if x is. */
static inline double relative_size(const lanes *x, const double *inverse)
{
    lanes squares = splat(0);
    for (int n = 0; n < DIM; n++) {
        const lanes part = x[n]*inverse[n];
        squares += part*part;
    }
    return sqrt(sum_of_lanes(squares));
}

/* h divided by the magnitudes of components in a step. */
static void inverse_sizes(const Motion *motion, double h, double *inverse)
{
    for (int n = 0; n < DIM; n++) {
        const double change = fabs(h*motion->polynomial[n][0]);
        inverse[n] = h/(fabs(motion->y[n]) + change + SMALL);
    }
}

static void lanes_of_numbers(const double *numbers, int count, lanes *vectors)
{
    for (int n = 0; n < count; n++) {
        vectors[n] = splat(numbers[n]);
    }
}

/* A first approximation of the stages: polynomials at the nodes of a step that has a start and a
   length in units of their own step. */
static void predict(Polynomial polynomial, double start, double length, Stages k)
{
    const lanes x = 2*(start + length*LOWER_C) - 1;
    lanes before = splat(0), now = splat(1);
    for (int n = 0; n < DIM; n++) {
        k->vector[n] = splat(polynomial[n][0]);
    }
    for (int m = 1; m < STAGES; m++) {
        const lanes next = ((2*m - 1.0)/m)*(x*now) - ((m - 1.0)/m)*before;
        before = now;
        now = next;
        for (int n = 0; n < DIM; n++) {
            k->vector[n] = fused(now, splat(polynomial[n][m]), k->vector[n]);
        }
    }
}

/* Solve the stages k of a step in doubles, from a first approximation, as far as one correction
   needs it; returns whether it converges. */
static int solve(const Motion *motion, double h, double rtol, Stages k)
{
    const lanes t = motion->t + h*LOWER_C;
    const double enough = fmax(4*DBL_EPSILON, fmin(rtol/CORRECTED, 1e-12));
    double inverse[DIM], last = INFINITY;
    lanes params[PARAMETERS + 1];
    inverse_sizes(motion, h, inverse);
    lanes_of_numbers(motion->params, PARAMETERS, params);
    for (int sweep = 0; sweep < MOST_SWEEPS; sweep++) {
        lanes stage[DIM], value[DIM], change[DIM];
        product(LOWER_A, k, stage);
        for (int n = 0; n < DIM; n++) {
            stage[n] = fused(stage[n], splat(h), splat(motion->y[n]));
        }
        LOWER_RHS(t, stage, params, value);
        for (int n = 0; n < DIM; n++) {
            change[n] = value[n] - k->vector[n];
            k->vector[n] = value[n];
        }
        const double size = relative_size(change, inverse);
        if (!(size < INFINITY)) {
            return 0;
        }
        const int stagnates = size > last/2;
        if (size <= enough || (stagnates && size < 1e-10)) {
            return 1;
        }
        if (stagnates && sweep > 4) {
            return 0;
        }
        last = size;
    }
    return 0;
}

/* Legendre coefficients of the polynomials with the values k at the nodes. */
static void transform(Stages k, Polynomial polynomial)
{
    lanes coefficients[DIM];
    product(LOWER_LEGENDRE, k, coefficients);
    memcpy(polynomial, coefficients, sizeof coefficients);
}

/* The state, and whole changes of angles: h times the mean velocity, with stages y + h A k and
   b A = b (1 - c). */
static void move(Motion *motion, double h, const RefinedStages k)
{
    const double_double length = constant(h, 0);
    for (int a = 0; a < ANGLES; a++) {
        const int n = RATE[a];
        const double_double start = constant(motion->y[n], motion->y_low[n]);
        /* the weights b have the sum 1 */
        const double_double mean = add(multiply(B, start), multiply(multiply(B_REST, k[n]), length));
        add_lanes(multiply(mean, length), motion->y + DIM + a, motion->y_low + DIM + a);
    }
    for (int n = 0; n < DIM; n++) {
        add_lanes(multiply(multiply(B, k[n]), length), motion->y + n, motion->y_low + n);
    }
    motion->t = compensated_sum(motion->t, h, &motion->t_low);
}

static void derivative_at_start(const Motion *motion, double *derivative)
{
    lanes y[DIM], params[PARAMETERS + 1], k[DIM];
    lanes_of_numbers(motion->y, DIM, y);
    lanes_of_numbers(motion->params, PARAMETERS, params);
    LOWER_RHS(splat(motion->t), y, params, k);
    for (int n = 0; n < DIM; n++) {
        derivative[n] = k[n][0];
    }
}

/* The spacing of numbers above 1; that of doubles where products are not rounded once. */
static double epsilon(void)
{
    const double_double x = constant(1 + 0x1p-30, 0), square = multiply(x, x);
    return square.low[0] == 0x1p-60 ? EPSILON : DBL_EPSILON;
}
