/* Real roots of the polynomial of an event within a step, isolated.

   A polynomial with Bernstein coefficients b has at most as many roots in (0, 1) as b has changes of
   sign, and differs from this number by an even one; the coefficients on a part of the interval
   follow by de Casteljau's algorithm (F. Rouillier and P. Zimmermann, Journal of Computational and
   Applied Mathematics 162 (2004) 33-50).

   Defined before this file: BERNSTEIN, column m with the coefficients of the integral of the Legendre
   polynomial m from 0. */

/* Roots that are closer to each other count as a double one. */
static const double CLOSE_ROOTS = 0x1p-24;
enum { MAX_DEPTH = 25, MAX_ROOTS = 2*STAGES, SAMPLES = 8 };

/* Bernstein coefficients of the value of an event over the step from `start`, where it is `before`,
   to `end`; of an angle, of the sine of its difference from the event. */
static void event_polynomial(
    const Event *event, const State *start, const State *end, double before, double *coefficients)
{
    const int n = event->is_angle ? SINE[event->index] : (int)event->index;
    const double *first = end->polynomial + n*STAGES;
    const double *second = first + (event->is_angle ? STAGES : 0);
    const double u = event->is_angle ? event->cosine : 1, v = event->is_angle ? event->sine : 0;
    const double value = event->is_angle
        ? u*start->z[n] - v*start->z[n + 1] : start->z[n] - event->value;
    for (int k = 0; k <= STAGES; k++) {
        double sum = value;
        for (int m = 0; m < STAGES; m++) {
            sum += BERNSTEIN[m][k]*(u*first[m] - v*second[m]);
        }
        coefficients[k] = sum;
    }
    coefficients[0] = before != 0 ? coefficients[0] : 0;    /* also without its rounding error */
}

/* The first coefficient that is not 0. */
static double first_sign(const double *coefficients)
{
    int k = 0;
    while (k < STAGES && coefficients[k] == 0) {
        k++;
    }
    return coefficients[k];
}

static int sign_changes(const double *coefficients)
{
    int changes = 0;
    double last = 0;
    for (int k = 0; k <= STAGES; k++) {
        changes += last*coefficients[k] < 0;
        last = coefficients[k] != 0 ? coefficients[k] : last;
    }
    return changes;
}

/* Replace the coefficients on an interval by those on its right part, from `part` on; `left` receives
   those on its left part. */
static void subdivide(double part, double *coefficients, double *left)
{
    for (int level = 0; level <= STAGES; level++) {
        left[level] = coefficients[0];
        for (int k = 0; k < STAGES - level; k++) {
            coefficients[k] += part*(coefficients[k + 1] - coefficients[k]);
        }
    }
}

static double value_at(const double *coefficients, double x)
{
    double copy[STAGES + 1], left[STAGES + 1];
    memcpy(copy, coefficients, sizeof copy);
    subdivide(x, copy, left);
    return copy[0];
}

/* The only root between two parts of the interval. */
static double root_between(const double *coefficients, double begin, double end)
{
    double rightmost = value_at(coefficients, end);
    while (end - begin > CLOSE_ROOTS) {
        const double middle = 0.5*(begin + end), value = value_at(coefficients, middle);
        if ((value < 0) == (rightmost < 0) && value != 0) {
            end = middle;
            rightmost = value;
        } else {
            begin = middle;
        }
    }
    return 0.5*(begin + end);
}

/* Roots in ascending order, a nearly double one twice. Returns their number. */
static int isolate_roots(const double *coefficients, double *roots)
{
    double stack[MAX_DEPTH + 1][STAGES + 1], begin[MAX_DEPTH + 1], end[MAX_DEPTH + 1];
    int top = 0, count = 0;
    memcpy(stack[0], coefficients, sizeof stack[0]);
    begin[0] = 0;
    end[0] = 1;
    while (top >= 0 && count < MAX_ROOTS - 1) {
        const int changes = sign_changes(stack[top]);
        if (changes > 1 && end[top] - begin[top] > CLOSE_ROOTS) {
            /* the left part is on top; a root at the middle would be in none of them */
            double part = 0.5, right[STAGES + 1];
            memcpy(right, stack[top], sizeof right);
            subdivide(part, right, stack[top + 1]);
            while (right[0] == 0 && part > 0.25) {
                part -= 0.03125;
                memcpy(right, stack[top], sizeof right);
                subdivide(part, right, stack[top + 1]);
            }
            memcpy(stack[top], right, sizeof right);
            begin[top + 1] = begin[top];
            begin[top] += part*(end[top] - begin[top]);
            end[top + 1] = begin[top];
            top++;
            continue;
        }
        if (changes == 1) {
            roots[count++] = root_between(coefficients, begin[top], end[top]);
        } else if (changes > 1) {
            roots[count++] = begin[top];
            roots[count++] = end[top];
        }
        top--;
    }
    return count;
}

/* A part of the interval between every two roots, where the value is largest of some: its sign
   decides whether there are roots on both sides. Returns the number of roots, with one at the start:
   there rounding errors decide the sign of the value. */
static int separate_roots(const double *coefficients, double *parts)
{
    double roots[MAX_ROOTS + 1] = {0};
    const int first = coefficients[0] == 0, count = first + isolate_roots(coefficients, roots + first);
    for (int k = 0; k + 1 < count; k++) {
        double largest = -1;
        for (int i = 1; i < SAMPLES; i++) {
            const double x = roots[k] + (roots[k + 1] - roots[k])*i/SAMPLES;
            const double value = fabs(value_at(coefficients, x));
            if (value > largest) {
                largest = value;
                parts[k] = x;
            }
        }
    }
    return count;
}
