/* Vectors that hold a number for each stage, and polynomials over a step.

   Defined before this file, beside that of step.h: STAGES and the types of vectors. */

static const double ZERO[DIM];
/* A number that counts as 0, but whose reciprocal has a square. */
static const double SMALLEST = 1e-100;

static inline stage_vector splat_stages(double x) { return (stage_vector){0} + x; }

static inline double sum_of(stage_vector x)
{
    typedef double half_vector __attribute__((vector_size(4*STAGES)));
    const union { stage_vector whole; half_vector halves[2]; } lanes = {.whole = x};
    const half_vector pairs = lanes.halves[0] + lanes.halves[1];
    double sum = 0;
    for (int i = 0; i < STAGES/4; i++) {
        sum += pairs[i] + pairs[i + STAGES/4];
    }
    return sum;
}

/* Binary logarithm of a positive normal number within 0.09, more than step control needs: linear
   between powers of two. */
static inline double rough_log2(double x) { return (as_mask(x) - as_mask(1.0))*0x1p-52; }

/* The inverse of this function, for |x| < 1000. */
static inline double rough_exp2(double x) { return as_real((int64_t)(x*0x1p52) + as_mask(1.0)); }

/* For each component, `first` plus a matrix, given by its columns, times a vector. */
static inline void multiply(
    const stage_vector *columns, const void *vectors, const double *first, stage_vector *products)
{
    /* numbers are read from memory: to load one into all lanes takes less than to permute lanes */
    const double *numbers = vectors;
    __asm__("" : "+r"(numbers) : : "memory");
    for (int n = 0; n < DIM; n++) {
        const double *number = numbers + n*STAGES;
        stage_vector even = first[n] + columns[0]*number[0], odd = columns[1]*number[1];
        for (int j = 2; j < STAGES; j += 2) {
            even += columns[j]*number[j];
            odd += columns[j + 1]*number[j + 1];
        }
        products[n] = even + odd;
    }
}

/* The Legendre polynomials times `scale` at x from -1 to 1, beyond it by extrapolation. */
static inline void legendre_polynomials(stage_vector x, stage_vector scale, stage_vector *values)
{
    values[0] = scale;
    values[1] = x*scale;
    for (int k = 1; k < STAGES - 1; k++) {
        values[k + 1] = ((2*k + 1)/(k + 1.0)*x)*values[k] - (k/(k + 1.0))*values[k - 1];
    }
}

/* The polynomial of a motion that starts with a derivative and a first step. */
static void start_polynomial(State *state, double h, const double *derivative)
{
    memset(state->polynomial, 0, sizeof state->polynomial);
    for (int n = 0; n < DIM; n++) {
        state->polynomial[n*STAGES] = h*derivative[n];
    }
    state->length[0] = h;
    state->origin[0] = 1;
}

/* The polynomial of a rejected step, which ends at `end`, predicts a shorter one. */
static void keep_polynomial(State *state, const State *end)
{
    memcpy(state->polynomial, end->polynomial, sizeof state->polynomial);
    state->length[0] = end->length[0];
    state->origin[0] = 0;
}
