/* Extrema of the polynomial of an event within a step, isolated: there is at most one crossing
   between two of them.

   A polynomial with Bernstein coefficients b has at most as many roots in (0, 1) as b has changes of
   sign, and differs from this number by an even one; the coefficients on a part of the interval
   follow by de Casteljau's algorithm (F. Rouillier and P. Zimmermann, Journal of Computational and
   Applied Mathematics 162 (2004) 33-50). */

/* Roots that are closer to each other count as a double one. */
static const double CLOSE_ROOTS = 0x1p-24;
/* Error of a polynomial, relative to the largest distance of its control points from the chord. */
static const double MARGIN = 0.5;
enum { MAX_DEPTH = 25, MAX_ROOTS = 2*EXTENSION_DEGREE, MAX_NEWTON = 50 };

static int sign_changes(int degree, const double *coefficients)
{
    int changes = 0;
    double last = 0;
    for (int k = 0; k <= degree; k++) {
        changes += last*coefficients[k] < 0;
        last = coefficients[k] != 0 ? coefficients[k] : last;
    }
    return changes;
}

/* Replace the coefficients on an interval by those on its right part, from `part` on; `left` receives
   those on its left part. */
static void subdivide(int degree, double part, double *coefficients, double *left)
{
    for (int level = 0; level <= degree; level++) {
        left[level] = coefficients[0];
        for (int k = 0; k < degree - level; k++) {
            coefficients[k] += part*(coefficients[k + 1] - coefficients[k]);
        }
    }
}

/* The value at x, and the slope there, by de Casteljau's algorithm. */
static inline double value_and_slope(
    int degree, const double *coefficients, double x, double *slope)
{
    double c[EXTENSION_DEGREE + 1];
    memcpy(c, coefficients, (size_t)(degree + 1)*sizeof *c);
    for (int level = degree; level > 1; level--) {
        for (int k = 0; k < level; k++) {
            c[k] += x*(c[k + 1] - c[k]);
        }
    }
    *slope = degree*(c[1] - c[0]);
    return c[0] + x*(c[1] - c[0]);
}

static double value_at(int degree, const double *coefficients, double x)
{
    double slope;
    return x == 0 ? coefficients[0] : x == 1 ? coefficients[degree]
        : value_and_slope(degree, coefficients, x, &slope);
}

/* The only root between two parts of the interval within a tolerance, and the slope near it; by
   Newton's iteration, or bisection where that leaves the interval. */
static double root_between(
    int degree, const double *coefficients, double begin, double end, double tolerance, double *slope)
{
    const double u = value_at(degree, coefficients, begin), v = value_at(degree, coefficients, end);
    double x = u*v < 0 ? (begin*v - end*u)/(v - u) : 0.5*(begin + end);
    *slope = (v - u)/(end - begin);
    for (int k = 0; k < MAX_NEWTON && end - begin > tolerance; k++) {
        const double last = x, value = value_and_slope(degree, coefficients, x, slope);
        if ((value < 0) == (v < 0) && value != 0) {
            end = x;
        } else {
            begin = x;
        }
        x -= value/(*slope);
        if (!(x > begin && x < end)) {
            x = 0.5*(begin + end);
        } else if (fabs(x - last) < tolerance) {
            break;
        }
    }
    return x;
}

/* Roots in ascending order, a nearly double one twice. Returns their number. */
static int isolate_roots(int degree, const double *coefficients, double *roots)
{
    double stack[MAX_DEPTH + 1][EXTENSION_DEGREE + 1], begin[MAX_DEPTH + 1], end[MAX_DEPTH + 1];
    int top = 0, count = 0;
    memcpy(stack[0], coefficients, (size_t)(degree + 1)*sizeof **stack);
    begin[0] = 0;
    end[0] = 1;
    while (top >= 0 && count < MAX_ROOTS - 1) {
        const int changes = sign_changes(degree, stack[top]);
        if (changes > 1 && end[top] - begin[top] > CLOSE_ROOTS) {
            /* the left part is on top; a root at the middle would be in none of them */
            double part = 0.5, right[EXTENSION_DEGREE + 1];
            memcpy(right, stack[top], sizeof right);
            subdivide(degree, part, right, stack[top + 1]);
            while (right[0] == 0 && part > 0.25) {
                part -= 0.03125;
                memcpy(right, stack[top], sizeof right);
                subdivide(degree, part, right, stack[top + 1]);
            }
            memcpy(stack[top], right, sizeof right);
            begin[top + 1] = begin[top];
            begin[top] += part*(end[top] - begin[top]);
            end[top + 1] = begin[top];
            top++;
            continue;
        }
        if (changes == 1) {
            double slope;
            roots[count++] = root_between(
                degree, coefficients, begin[top], end[top], CLOSE_ROOTS, &slope);
        } else if (changes > 1) {
            roots[count++] = begin[top];
            roots[count++] = end[top];
        }
        top--;
    }
    return count;
}

/* A part of the step, and the second derivative there, if the unit of time is the step. */
typedef struct {
    double part, curvature;
} Extremum;

/* Distance from 0 below which the sign of an extremum may be another one. */
static double margin_of(const double *coefficients)
{
    const double rise = coefficients[EXTENSION_DEGREE] - coefficients[0];
    double largest = 0;
    for (int k = 1; k < EXTENSION_DEGREE; k++) {
        const double chord = coefficients[0] + rise*k/EXTENSION_DEGREE;
        largest = fmax(largest, fabs(coefficients[k] - chord));
    }
    return MARGIN*largest;
}

/* Parts of the step at which the event is evaluated, since its sign may differ from that before:
   extrema within the margin of 0, and the first of successive ones with the same sign, unless the
   start or the end has it, too. Returns their number. */
static int separate_crossings(const double *coefficients, Extremum *extrema)
{
    enum { SLOPES = EXTENSION_DEGREE, CURVATURES = EXTENSION_DEGREE - 1 };
    double slopes[SLOPES + 1], curvatures[SLOPES], roots[MAX_ROOTS];
    for (int k = 0; k < SLOPES; k++) {
        slopes[k] = SLOPES*(coefficients[k + 1] - coefficients[k]);
    }
    for (int k = 0; k < CURVATURES; k++) {
        curvatures[k] = CURVATURES*(slopes[k + 1] - slopes[k]);
    }
    const int found = isolate_roots(SLOPES - 1, slopes, roots);
    const double end = coefficients[EXTENSION_DEGREE], margin = margin_of(coefficients);
    double last = coefficients[0];      /* 0 after a value near 0 */
    int count = 0;
    for (int k = 0; k < found; k++) {
        const double value = value_at(EXTENSION_DEGREE, coefficients, roots[k]);
        const int is_near = fabs(value) <= margin;
        if (is_near || !(value*last > 0)) {
            extrema[count++] = (Extremum){roots[k], value_at(CURVATURES - 1, curvatures, roots[k])};
            last = is_near ? 0 : value;
        }
    }
    return count - (count > 0 && last*end > 0);
}
