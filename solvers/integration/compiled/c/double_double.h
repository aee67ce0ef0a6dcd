/* Sums of two doubles in every lane of a vector, of which the second is the rounding error of the
   first (T. J. Dekker, Numerische Mathematik 18 (1971) 224-242; D. E. Knuth, The Art of Computer
   Programming 2, 4.2.2). Errors of products and quotients are a few 2^-106 of the result, those of
   sums of the larger term.

   Products and sums must not be fused by the compiler. */

typedef double lanes __attribute__((vector_size(8*STAGES)));
typedef double half_lanes __attribute__((vector_size(4*STAGES)));
typedef struct {
    lanes high, low;
} double_double;

static inline lanes splat(double x) { return (lanes){0} + x; }

#ifndef __has_builtin
#define __has_builtin(name) 0
#endif

/* a b + c, rounded once. */
static inline lanes fused(lanes a, lanes b, lanes c)
{
#if __has_builtin(__builtin_elementwise_fma)
    return __builtin_elementwise_fma(a, b, c);
#elif defined __AVX512F__
    return __builtin_ia32_vfmaddpd512_mask(a, b, c, -1, 4);     /* in all lanes, as usual rounded */
#elif defined __FMA__
    union {
        lanes all;
        half_lanes half[2];
    } x = {a}, y = {b}, z = {c};
    for (int k = 0; k < 2; k++) {
        z.half[k] = __builtin_ia32_vfmaddpd256(x.half[k], y.half[k], z.half[k]);
    }
    return z.all;
#else
    for (int i = 0; i < STAGES; i++) {
        c[i] = fma(a[i], b[i], c[i]);
    }
    return c;
#endif
}

/* a + b, where a is not smaller than b. */
static inline double_double ordered_sum(lanes a, lanes b)
{
    const lanes sum = a + b;
    return (double_double){sum, b - (sum - a)};
}

static inline double_double sum_of_doubles(lanes a, lanes b)
{
    const lanes sum = a + b, part = sum - a;
    return (double_double){sum, (a - (sum - part)) + (b - part)};
}

static inline double_double add(double_double a, double_double b)
{
    const double_double sum = sum_of_doubles(a.high, b.high);
    return ordered_sum(sum.high, sum.low + (a.low + b.low));
}

static inline double_double negative(double_double a) { return (double_double){-a.high, -a.low}; }

static inline double_double subtract(double_double a, double_double b)
{
    return add(a, negative(b));
}

static inline double_double multiply(double_double a, double_double b)
{
    const lanes product = a.high*b.high, error = fused(a.high, b.high, -product);
    return ordered_sum(product, fused(a.low, b.high, fused(a.high, b.low, error)));
}

static inline double_double divide(double_double a, double_double b)
{
    const lanes inverse = 1/b.high, quotient = a.high*inverse;
    const lanes rest = fused(-quotient, b.high, a.high) + fused(-quotient, b.low, a.low);
    return ordered_sum(quotient, rest*inverse);
}

/* A number that is the same in all lanes. */
static inline double_double constant(double high, double low)
{
    return (double_double){splat(high), splat(low)};
}

/* a + b c, with doubles c. */
static inline double_double add_product(double_double a, double_double b, lanes c)
{
    const lanes product = b.high*c, error = fused(b.low, c, fused(b.high, c, -product));
    const double_double sum = sum_of_doubles(a.high, product);
    return (double_double){sum.high, sum.low + (a.low + error)};
}

/* The sum of all lanes, added to the sum of two doubles. */
static inline void add_lanes(double_double a, double *high, double *low)
{
    double sum = *high, rest = *low;
    for (int i = 0; i < STAGES; i++) {
        const double before = sum, part = (sum = before + a.high[i]) - before;
        rest += ((before - (sum - part)) + (a.high[i] - part)) + a.low[i];
    }
    *high = sum + rest;
    *low = rest - (*high - sum);
}
