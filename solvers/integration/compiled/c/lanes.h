/* Numbers of which LANES are computed at once: one double, or a vector of doubles.

   A mask is all ones in lanes where something holds and all zeros where it does not. */

#include <math.h>
#include <stdint.h>

#ifdef ONE_LANE
enum { LANES = 1 };
typedef double real;
typedef int64_t mask;
#else
/* Two registers: the second fills the gaps that the first leaves, waiting for its results. */
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
#endif

/* one lane of a number or mask */
#define NUMBER(values, lane) (((double *)&(values))[lane])
#define WORD(values, lane) (((int64_t *)&(values))[lane])

typedef union {
    real number;
    mask word;
} Bits;

static inline mask word(real x)
{
    return (Bits){.number = x}.word;
}

/* Bits moved towards the high end, as of an unsigned number. */
static inline mask moved_up(mask x, int places)
{
#ifdef ONE_LANE
    return (mask)((uint64_t)x << places);
#else
    return x << places;
#endif
}

static inline real number(mask x)
{
    return (Bits){.word = x}.number;
}

/* Where x < y; register by register, for GCC 12 compares longer vectors number by number. */
static inline mask below(real x, real y)
{
#ifdef ONE_LANE
    return -(mask)(x < y);
#else
    const union { real all; half part[2]; } a = {x}, b = {y};
    const union { half_mask part[2]; mask all; } found = {{
        (half_mask)(a.part[0] < b.part[0]), (half_mask)(a.part[1] < b.part[1]),
    }};
    return found.all;
#endif
}

static inline real every(double x)
{
    return (real){0} + x;
}

static inline real chosen(mask where, real there, real elsewhere)
{
#ifdef ONE_LANE
    return where ? there : elsewhere;
#else
    return number((word(there) & where) | (word(elsewhere) & ~where));
#endif
}

static inline int any(mask where)
{
#ifdef ONE_LANE
    return where != 0;
#else
    const union { mask all; half_mask part[2]; } masks = {where};
    half_mask found = masks.part[0] | masks.part[1];
    for (int lane = 1; lane < LANES/2; lane++) {
        found[0] |= found[lane];
    }
    return found[0] != 0;
#endif
}

static inline real size(real x)
{
    return number(word(x) & INT64_MAX);
}

/* `x` with the sign of `sign` */
static inline real signed_as(real x, real sign)
{
    return number((word(x) & INT64_MAX) | (word(sign) & INT64_MIN));
}

static inline real larger(real x, real y)
{
    return chosen(below(y, x), x, y);
}

static inline real smaller(real x, real y)
{
    return chosen(below(x, y), x, y);
}

/* Added to a number of moderate size, it leaves the nearest whole number in the last bits. */
static const double ROUND = 0x1.8p52;

static inline real nearest_whole(real x)
{
    return (x + ROUND) - ROUND;
}

/* Square root in some lanes, one by one: it is seldom needed. */
static real root(real x, mask where)
{
    for (int lane = 0; lane < LANES; lane++) {
        if (WORD(where, lane)) {
            NUMBER(x, lane) = sqrt(NUMBER(x, lane));
        }
    }
    return x;
}

/* Binary logarithm of a positive normal number within 1e-7, more than the control of steps needs.

   The mantissa m is taken between the roots of 1/2 and 2; with u = (m - 1)/(m + 1),
   ln m = 2 (u + u^3/3 + u^5/5 + ...), and u^2 < 0.03. */
static inline real binary_logarithm(real x)
{
    const double scale = 2.8853900817779268;    /* 2/ln 2 */
    const mask exponent = (word(x) - 0x3fe6a09e667f3bcd) >> 52;
    const real m = number(word(x) - moved_up(exponent, 52));
    const real whole = number(exponent + 0x4338000000000000) - ROUND;
    const real u = (m - 1.0)/(m + 1.0), s = u*u;
    return whole + u*((scale + s*(scale/3)) + (s*s)*(scale/5 + s*(scale/7)));
}

/* 2^x within 1e-8 for |x| < 1000: 2^n by the exponent, the rest by the exponential series. */
static inline real power_of_two(real x)
{
    const real shifted = x + ROUND;
    const real f = (x - (shifted - ROUND))*0.6931471805599453, f2 = f*f;
    const real low = (1.0 + f) + f2*(1.0/2 + f*(1.0/6));
    const real high = (1.0/24 + f*(1.0/120)) + f2*(1.0/720 + f*(1.0/5040));
    return number(word(low + (f2*f2)*high) + moved_up(word(shifted), 52));
}
