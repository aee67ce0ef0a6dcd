/* States at the ends of steps, and the length of the first step.

   Defined before this file: the right-hand side RHS; the structures in layout.h; the
   number of components at the end of the state that are a variation (VARIATIONS); the index of each
   angle's sine, which its cosine follows, and of its velocity (SINE, RATE). */

static const double PI = 3.14159265358979324;

/* x + y; `low` receives the rounding error of the sum (D. E. Knuth, The Art of Computer
   Programming, volume 2, theorem 4.2.2B). */
static inline real two_sum(real x, real y, real *low)
{
    const real total = x + y, part = total - x;
    *low = (x - (total - part)) + (y - part);
    return total;
}

static inline void add_to_component(State *state, int n, real change)
{
#if COMPENSATED
    real low;
    state->z[n] = two_sum(state->z[n], change + state->z_low[n], &low);
    state->z_low[n] = low;
#else
    state->z[n] += change;
#endif
}

/* Component n at the end of a step that changes it. */
static inline void move_component(const State *start, State *end, int n, real change)
{
    end->z[n] = start->z[n];
#if COMPENSATED
    end->z_low[n] = start->z_low[n];
#endif
    add_to_component(end, n, change);
}

/* 1 - sin^2 - cos^2 of an angle. Of compensated sums the result is that of the whole state, without
   rounding errors: these are not random, and a motion would drift. */
static inline real unit_defect(const State *state, int sine)
{
    const real s = state->z[sine], c = state->z[sine + 1];
#if COMPENSATED
    /* upper halves, whose squares are exact */
    const real u = (s + 0x1.8p27) - 0x1.8p27, v = (c + 0x1.8p27) - 0x1.8p27;
    const real rest = (s - u)*(s + u) + (c - v)*(c + v);
    return (1.0 - u*u - v*v) - (rest + 2*(s*state->z_low[sine] + c*state->z_low[sine + 1]));
#else
    return 1.0 - (s*s + c*c);
#endif
}

/* Restore sin^2 + cos^2 = 1: by the series of 1/sqrt(1 - d) where d is small, as it nearly always
   is, after a division elsewhere. */
static inline void normalise_angles(State *state)
{
    for (int a = 0; a < ANGLES; a++) {
        real s = state->z[SINE[a]], c = state->z[SINE[a] + 1], square = s*s + c*c;
        const mask is_large = less_than(splat(1e-4), lane_fabs(1.0 - square));
        if (any(is_large)) {
            const real length = lane_sqrt(square, is_large);
            state->z[SINE[a]] = s = select(is_large, s/length, s);
            state->z[SINE[a] + 1] = c = select(is_large, c/length, c);
        }
        const real d = unit_defect(state, SINE[a]), excess = d*(0.5 + d*(0.375 + d*0.3125));
        add_to_component(state, SINE[a], s*excess);
        add_to_component(state, SINE[a] + 1, c*excess);
    }
}

/* A variation may grow beyond all floating-point numbers: where it is large, take a power of two
   out of it, which is exact. */
static inline void rescale_variation(const State *start, State *end)
{
    for (int k = 0; k < SCALES; k++) {
        real largest = splat(0.0);
        for (int n = DIM - VARIATIONS; n < DIM; n++) {
            largest = lane_fmax(largest, lane_fabs(end->z[n]));
        }
        const mask is_large = less_than(splat(0x1p64), largest);
        const real factor = select(is_large, splat(0x1p-64), splat(1.0));
        for (int n = DIM - VARIATIONS; n < DIM; n++) {
            end->z[n] *= factor;
#if COMPENSATED
            end->z_low[n] *= factor;
#endif
        }
        for (int n = DIM - VARIATIONS; n < DIM && IS_FSAL; n++) {
            end->derivative[n] *= factor;
        }
        for (int j = POLYNOMIAL_DIM/DIM*(DIM - VARIATIONS); j < POLYNOMIAL_DIM; j++) {
            end->polynomial[j] *= factor;
        }
        end->scale[k] = start->scale[k] + select(is_large, splat(64.0), splat(0.0));
    }
}

/* The angle between -pi and pi within 0.08: enough to count turns. */
static inline real approximate_angle(const State *state, int a)
{
    const real s = state->z[SINE[a]], c = state->z[SINE[a] + 1];
    const real acute = s*(PI/2 - (PI/2 - 1)*lane_fabs(c));
    return select(less_than(c, splat(0.0)), lane_copysign(splat(PI), s) - acute, acute);
}

/* An angle changes by about its mean velocity times h; the rest is whole turns. Returns 0, or NaN
   where they cannot be counted. */
static inline real count_turns(const State *start, real h, State *end)
{
    real check = splat(0.0);
    for (int a = 0; a < ANGLES; a++) {
        const real change = h*(start->z[RATE[a]] + end->z[RATE[a]])*0.5;
        const real excess = approximate_angle(start, a) + change - approximate_angle(end, a);
        end->turns[a] = start->turns[a] + lane_round(excess*(0.5/PI));
        check += excess - excess;
    }
    return check;
}

/* Results of a step besides the state at its end. */
typedef struct {
    real squared_error;     /* squared norm of the estimated error, relative to the tolerances */
    real evaluations;       /* of the right-hand side */
    real jacobians;         /* evaluations of the Jacobian */
    real contraction;       /* of the iteration of the stages, by each of its evaluations */
    real k[IS_EXPLICIT*STAGES][DIM];    /* derivatives at the stages of an explicit method */
    real ends[ENDS][DIM];               /* and at the start and end of a step by Newton's iteration */
} StepResult;

/* Mean squares of `count` vectors, relative to the tolerances at states x and y. */
static inline void mean_squares(
    int count, const real (*vectors)[DIM], const real *x, const real *y, double rtol, double atol,
    real *means)
{
    real allowed[DIM];
    for (int n = 0; n < DIM; n++) {
        const real magnitude = lane_fmax(lane_fabs(x[n]), lane_fabs(y[n]));
        allowed[n] = lane_fmax(atol + rtol*magnitude, splat(1e-75));
    }
    for (int k = 0; k < count; k++) {
        means[k] = splat(0.0);
    }
    /* two components of all vectors by one division, which takes as long as a dozen products */
    for (int n = 0; n + 1 < DIM; n += 2) {
        const real both = allowed[n]*allowed[n + 1], inverse = (1.0/DIM)/(both*both);
        for (int k = 0; k < count; k++) {
            const real u = vectors[k][n]*allowed[n + 1], v = vectors[k][n + 1]*allowed[n];
            means[k] += (u*u + v*v)*inverse;
        }
    }
    for (int k = 0; k < count && DIM % 2; k++) {
        const real part = vectors[k][DIM - 1]/allowed[DIM - 1];
        means[k] += part*part*(1.0/DIM);
    }
}

static inline real mean_square(
    const real *values, const real *x, const real *y, double rtol, double atol)
{
    real mean;
    mean_squares(1, (const real (*)[DIM])values, x, y, rtol, atol, &mean);
    return mean;
}

/* Length of the first step in some lanes, from the change of the derivative over a very short step
   (E. Hairer, S. P. Norsett, G. Wanner, Solving Ordinary Differential Equations I, section
   II.4). */
static real initial_step(
    const State *state, const real *derivative, const real *params, real duration, mask lanes,
    double rtol, double atol)
{
    const real *z = state->z;
    real z1[DIM], difference[DIM];
    const real d0 = lane_sqrt(mean_square(z, z, z, rtol, atol), lanes);
    const real d1 = lane_sqrt(mean_square(derivative, z, z, rtol, atol), lanes);
    const mask regular =
        less_than(splat(1e-5), lane_fmin(d0, d1)) & less_than(d1, splat(INFINITY));
    real h0 = select(regular, 0.01*d0/d1, splat(1e-6));
    h0 = lane_fmin(h0, lane_fabs(duration));
    for (int n = 0; n < DIM; n++) {
        z1[n] = z[n] + lane_copysign(h0, duration)*derivative[n];
    }
    RHS(state->t + lane_copysign(h0, duration), z1, params, difference);
    for (int n = 0; n < DIM; n++) {
        difference[n] -= derivative[n];
    }
    const real d2 =
        lane_fmax(d1, lane_sqrt(mean_square(difference, z, z, rtol, atol), lanes)/h0);
    const real h1 =
        lane_exp2(lane_log2(0.01/lane_fmax(d2, splat(1e-15)))*(1.0/(ERROR_ORDER + 1)));
    const real h = lane_fmin(lane_fmin(100.0*h0, h1), lane_fabs(duration));
    return select(less_than(d2, splat(INFINITY)), h, h0);
}
