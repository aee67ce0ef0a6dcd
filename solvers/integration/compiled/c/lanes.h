/* Numbers of which LANES are computed at once: one double, or a vector of doubles.

   A mask is all ones in lanes where a condition holds and all zeros elsewhere. */

#include <math.h>
#include <stdint.h>

/* A function that few steps need: it is compiled for size, in less time, and is called instead of
   inlined. */
#if defined __GNUC__
#define SELDOM __attribute__((cold, noinline))
#else
#define SELDOM
#endif

#ifdef ONE_LANE
enum { LANES = 1 };
typedef double real;
typedef int64_t mask;
typedef double half;
enum { PARTS = 1 };
#else
/* Two registers: the second one hides the latency of the first. */
#if defined __AVX512F__
enum { REGISTER = 64 };
#elif defined __AVX__
enum { REGISTER = 32 };
#else
enum { REGISTER = 16 };
#endif
enum { LANES = 2*REGISTER/8 };
typedef double real __attribute__((vector_size(2*REGISTER)));
typedef int64_t mask __attribute__((vector_size(2*REGISTER)));
typedef double half __attribute__((vector_size(REGISTER)));
typedef int64_t half_mask __attribute__((vector_size(REGISTER)));
enum { PARTS = 2 };
#endif

/* One register of a real; one lane of a real or of a mask. */
#define PART(values, part) (((half *)&(values))[part])
#define LANE(values, lane) (((double *)&(values))[lane])
#define MASK_LANE(values, lane) (((int64_t *)&(values))[lane])

typedef union {
    real value;
    mask bits;
} Bits;

static inline mask as_mask(real x) { return (Bits){.value = x}.bits; }
static inline real as_real(mask x) { return (Bits){.bits = x}.value; }

static inline real splat(double x) { return (real){0} + x; }

/* Bits shifted left, as of an unsigned number; x < y; x where the condition holds, y elsewhere;
   and whether it holds in any lane. */
#ifdef ONE_LANE
static inline mask shift_left(mask x, int count) { return (mask)((uint64_t)x << count); }
static inline mask less_than(real x, real y) { return -(mask)(x < y); }
static inline real select(mask condition, real x, real y) { return condition ? x : y; }
static inline int any(mask condition) { return condition != 0; }
#else
static inline mask shift_left(mask x, int count) { return x << count; }

/* Register by register, since GCC 12 compares longer vectors element by element. */
static inline mask less_than(real x, real y)
{
    const union { real all; half part[2]; } a = {x}, b = {y};
    const union { half_mask part[2]; mask all; } result = {{
        (half_mask)(a.part[0] < b.part[0]), (half_mask)(a.part[1] < b.part[1]),
    }};
    return result.all;
}

static inline real select(mask condition, real x, real y)
{
    return as_real((as_mask(x) & condition) | (as_mask(y) & ~condition));
}

static inline int any(mask condition)
{
    const union { mask all; half_mask part[2]; } masks = {condition};
    half_mask result = masks.part[0] | masks.part[1];
    for (int lane = 1; lane < LANES/2; lane++) {
        result[0] |= result[lane];
    }
    return result[0] != 0;
}
#endif

static inline real lane_fabs(real x) { return as_real(as_mask(x) & INT64_MAX); }

#ifdef ONE_LANE
static inline half half_fabs(half x) { return lane_fabs(x); }
static inline half half_fmax(half x, half y) { return y < x ? x : y; }
static inline half half_fmin(half x, half y) { return x < y ? x : y; }
#else
static inline half half_fabs(half x) { return (half)((half_mask)x & INT64_MAX); }

/* y < x ? x : y, and x < y ? x : y. GCC makes two or more instructions of a comparison. */
static inline half half_fmax(half x, half y)
{
#if defined __AVX512F__ && !defined __clang__
    return __builtin_ia32_maxpd512_mask(x, y, x, -1, 4);
#elif defined __AVX__ && !defined __clang__
    return __builtin_ia32_maxpd256(x, y);
#else
    const half_mask greater = y < x;
    return (half)(((half_mask)x & greater) | ((half_mask)y & ~greater));
#endif
}

static inline half half_fmin(half x, half y)
{
#if defined __AVX512F__ && !defined __clang__
    return __builtin_ia32_minpd512_mask(x, y, x, -1, 4);
#elif defined __AVX__ && !defined __clang__
    return __builtin_ia32_minpd256(x, y);
#else
    const half_mask less = x < y;
    return (half)(((half_mask)x & less) | ((half_mask)y & ~less));
#endif
}
#endif

static inline real lane_copysign(real x, real sign)
{
    return as_real((as_mask(x) & INT64_MAX) | (as_mask(sign) & INT64_MIN));
}

static inline real lane_fmax(real x, real y)
{
    real larger;
    for (int part = 0; part < PARTS; part++) {
        PART(larger, part) = half_fmax(PART(x, part), PART(y, part));
    }
    return larger;
}

static inline real lane_fmin(real x, real y)
{
    real smaller;
    for (int part = 0; part < PARTS; part++) {
        PART(smaller, part) = half_fmin(PART(x, part), PART(y, part));
    }
    return smaller;
}

/* The sum of this and a number of moderate size ends in the bits of the nearest integer. */
static const double ROUND = 0x1.8p52;

static inline real lane_round(real x) { return (x + ROUND) - ROUND; }

/* Square root where the condition holds, lane by lane: it is seldom needed. */
static real lane_sqrt(real x, mask condition)
{
    for (int lane = 0; lane < LANES; lane++) {
        if (MASK_LANE(condition, lane)) {
            LANE(x, lane) = sqrt(LANE(x, lane));
        }
    }
    return x;
}

/* Binary logarithm of a positive normal number within 1e-7, more than step control needs.

   The mantissa m is taken between the roots of 1/2 and 2; with u = (m - 1)/(m + 1),
   ln m = 2 (u + u^3/3 + u^5/5 + ...), and u^2 < 0.03. */
static inline real lane_log2(real x)
{
    const double scale = 2.8853900817779268;    /* 2/ln 2 */
    const mask exponent = (as_mask(x) - 0x3fe6a09e667f3bcd) >> 52;
    const real m = as_real(as_mask(x) - shift_left(exponent, 52));
    const real integer = as_real(exponent + 0x4338000000000000) - ROUND;
    const real u = (m - 1.0)/(m + 1.0), s = u*u;
    return integer + u*((scale + s*(scale/3)) + (s*s)*(scale/5 + s*(scale/7)));
}

/* 2^x within 1e-8 for |x| < 1000: 2^n by the exponent, the rest by the exponential series. */
static inline real lane_exp2(real x)
{
    const real shifted = x + ROUND;
    const real f = (x - (shifted - ROUND))*0.6931471805599453, f2 = f*f;
    const real low = (1.0 + f) + f2*(1.0/2 + f*(1.0/6));
    const real high = (1.0/24 + f*(1.0/120)) + f2*(1.0/720 + f*(1.0/5040));
    return as_real(as_mask(low + (f2*f2)*high) + shift_left(as_mask(shifted), 52));
}
