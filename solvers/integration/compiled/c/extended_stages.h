/* Stages of Gauss collocation, one after the other, by a fixed-point iteration in `lower`.

   Defined before this file, beside extended_motion.h: RHS, LOWER_RHS; A, B, C, and LEGENDRE, which
   takes values at the nodes C to Legendre coefficients, and LOWER_A etc.; the indices RATE of the
   velocities of angles. */

typedef lower Stages[STAGES][DIM];
typedef real RefinedStages[STAGES][DIM];

/* Upper halves of registers that are in use slow down the arithmetic of __float128. */
static inline void clear_upper_halves(void)
{
#ifdef __AVX__
    __builtin_ia32_vzeroupper();
#endif
}

/* Largest h |x| of a component relative to its magnitude; NaN if one is. */
static double relative_size(const lower *x, lower h, const lower *scale)
{
    double largest = 0;
    for (int n = 0; n < DIM; n++) {
        const double size = relative(h*x[n], scale[n]);
        largest = size <= largest ? largest : size;
    }
    return largest;
}

static void lower_numbers(const real *x, int count, lower *numbers)
{
    for (int n = 0; n < count; n++) {
        numbers[n] = (lower)x[n];
    }
}

/* A first approximation of the stages: polynomials at the nodes of a step that has a start and a
   length in units of their own step. */
static void predict(Polynomial polynomial, lower start, lower length, Stages k)
{
    for (int i = 0; i < STAGES; i++) {
        const lower x = 2*(start + length*LOWER_C[i]) - 1;
        lower before = 0, now = 1;
        for (int n = 0; n < DIM; n++) {
            k[i][n] = polynomial[n][0];
        }
        for (int m = 1; m < STAGES; m++) {
            const lower next = ((2*m - 1)*x*now - (m - 1)*before)/m;
            before = now;
            now = next;
            for (int n = 0; n < DIM; n++) {
                k[i][n] += now*polynomial[n][m];
            }
        }
    }
}

/* Solve the stages k of a step in `lower`, from a first approximation; returns whether it converges.
   Each stage is used by the following ones at once. */
static int solve(const Motion *motion, lower h, double rtol, Stages k)
{
    const lower t = (lower)motion->t;
    lower y[DIM], params[PARAMETERS + 1];
    lower_numbers(motion->y, DIM, y);
    lower_numbers(motion->params, PARAMETERS, params);
    double last = INFINITY;
    (void)rtol;
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

/* Legendre coefficients of the polynomials with the values k at the nodes. */
static void transform(Stages k, Polynomial polynomial)
{
    for (int n = 0; n < DIM; n++) {
        for (int m = 0; m < STAGES; m++) {
            polynomial[n][m] = 0;
            for (int j = 0; j < STAGES; j++) {
                polynomial[n][m] += LOWER_LEGENDRE[m][j]*k[j][n];
            }
        }
    }
}

/* The state, and whole changes of angles: h times the mean velocity, with stages y + h A k and
   b A = b (1 - c). */
static void move(Motion *motion, real h, RefinedStages k)
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

static void derivative_at_start(const Motion *motion, lower *derivative)
{
    real rate[DIM];
    RHS(motion->t, motion->y, motion->params, rate);
    lower_numbers(rate, DIM, derivative);
}

/* The spacing of numbers above 1. */
static double epsilon(void) { return (double)EPSILON; }
