/* Functions of the mathematical library in every lane, for generated right-hand sides.

   Sine and cosine are computed in all lanes at once, the others lane by lane. */

/* Beyond this size of an argument sine and cosine are those of the library. */
static const double MODERATE = 1e5;

#define LANE_BY_LANE(name) \
    static real vector_##name(real x) \
    { \
        for (int lane = 0; lane < LANES; lane++) { \
            LANE(x, lane) = name(LANE(x, lane)); \
        } \
        return x; \
    }
#define PAIR_BY_PAIR(name) \
    static inline real vector_##name(real x, real y) \
    { \
        for (int lane = 0; lane < LANES; lane++) { \
            LANE(x, lane) = name(LANE(x, lane), LANE(y, lane)); \
        } \
        return x; \
    }
#define HOLONOMIC_CALL(name) vector_##name

LANE_BY_LANE(tan)
LANE_BY_LANE(exp)
LANE_BY_LANE(log)
LANE_BY_LANE(sqrt)
LANE_BY_LANE(sinh)
LANE_BY_LANE(cosh)
LANE_BY_LANE(tanh)
LANE_BY_LANE(atan)
PAIR_BY_PAIR(atan2)
PAIR_BY_PAIR(pow)

/* An angle less a multiple of pi/2, as the sum of r and low; the result ends in the bits of the
   multiple. The first two parts of pi/2 have 33 bits each, so that their products are exact. */
static inline mask reduce_angle(real x, real *r, real *low)
{
    const double first = 0x1.921fb544p0, second = 0x1.0b4611a6p-34, third = 0x1.3198a2e037073p-69;
    const real shifted = x*0x1.45f306dc9c883p-1 + ROUND, n = shifted - ROUND;
    const real start = x - n*first, middle = start - n*second;
    const real rest = ((start - middle) - n*second) - n*third;
    *r = middle + rest;
    *low = (middle - *r) + rest;
    return as_mask(shifted);
}

/* Sine and cosine of r + low for |r| < 0.8, by their series. */
static inline real sine_near_0(real r, real low)
{
    const real s = r*r;
    const real tail = 1.0/120 + s*(-1.0/5040 + s*(1.0/362880 + s*(-1.0/39916800
        + s*(1.0/6227020800 + s*(-1.0/1307674368000 + s*(1.0/355687428096000))))));
    return r + (low*(1.0 - 0.5*s) + (r*s)*(-1.0/6 + s*tail));
}

static inline real cosine_near_0(real r, real low)
{
    const real s = r*r, half_square = 0.5*s, rough = 1.0 - half_square;
    const real tail = 1.0/24 + s*(-1.0/720 + s*(1.0/40320 + s*(-1.0/3628800
        + s*(1.0/479001600 + s*(-1.0/87178291200 + s*(1.0/20922789888000))))));
    return rough + (((1.0 - rough) - half_square) + ((s*s)*tail - r*low));
}

/* The sine of x plus `quarters` quarter turns. */
static inline real shifted_sine(real x, int64_t quarters)
{
    real r, low;
    const mask quadrant = reduce_angle(x, &r, &low) + quarters, is_odd = -(quadrant & 1);
    const real size = select(is_odd, cosine_near_0(r, low), sine_near_0(r, low));
    return as_real(as_mask(size) ^ shift_left(quadrant & 2, 62));
}

#define SINE_OR_COSINE(name, quarters) \
    static real vector_##name(real x) \
    { \
        real result = shifted_sine(x, quarters); \
        const mask is_large = ~less_than(lane_fabs(x), splat(MODERATE)); \
        for (int lane = 0; lane < LANES && any(is_large); lane++) { \
            if (MASK_LANE(is_large, lane)) { \
                LANE(result, lane) = name(LANE(x, lane)); \
            } \
        } \
        return result; \
    }
SINE_OR_COSINE(sin, 0)
SINE_OR_COSINE(cos, 1)
