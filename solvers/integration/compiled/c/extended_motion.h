/* A motion in numbers of type `real`, and sums whose rounding errors are kept.

   Stages are first computed in a shorter or equal type `lower`. The state is that of the form, of DIM
   components, followed by the ANGLES that it knows by sine and cosine. Defined before this file:
   real, lower, EPSILON, LOWER_EPSILON; DIM, ANGLES, PARAMETERS, STAGES. */

enum { SIZE = DIM + ANGLES, ORDER = 2*STAGES };
enum { MOST_SWEEPS = 60, MOST_CORRECTIONS = 12 };

/* Magnitude of a component above which it is resolved relatively. */
static const double SMALL = 1e-3;
/* Part of the residuals to which their correction is solved. */
static const double CORRECTED = 1e-8;

/* Legendre coefficients of the derivative over a step, on [0, 1]. */
typedef lower Polynomial[DIM][STAGES];

typedef struct {
    real t, t_low, y[SIZE], y_low[SIZE];            /* _low: rounding errors */
    real params[PARAMETERS + 1], params_low[PARAMETERS + 1];
    Polynomial polynomial;          /* of the last step */
    lower h, last_h, longest;       /* lengths of the next, the last and the longest step */
    double steps;
    int64_t rows;                   /* samples written */
} Motion;

/* x + y; `low` is the rounding error of x before, and of the sum afterwards. Both are added after y:
   their sum with y would lose digits of `low`. */
static inline real compensated_sum(real x, real y, real *low)
{
    const real sum = x + y, part = sum - x;
    const real rest = *low + ((x - (sum - part)) + (y - part)), total = sum + rest;
    *low = rest - (total - sum);
    return total;
}

static inline double magnitude(lower x) { return fabs((double)x); }

/* Part of the size of component n that is x. */
static inline double relative(lower x, lower y) { return magnitude(x)/(magnitude(y) + SMALL); }
