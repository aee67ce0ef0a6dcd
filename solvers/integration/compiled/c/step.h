/* One step in every lane, and how long the next one is.

   Before this file stand the right-hand side RHS, the sizes STATE, PARAMETERS and ANGLES, how many
   numbers at the end of the state are a small change whose size may be taken out (CHANGES), where in
   the state the sine of each angle (its cosine follows) and its velocity are (SINE, RATE), and the
   method: STAGES, IS_FSAL, IS_EXPLICIT, ERROR_ORDER, ESTIMATES, stages(), increment(), estimate() and,
   where there are two, second_estimate(). */

static const double SAFETY = 0.9, SHRINK = 0.2, GROW = 5.0;
static const double PI = 3.14159265358979324;

/* Where a motion is. Nothing but numbers, so that it can be copied number by number. */
enum { SCALES = CHANGES > 0 };

typedef struct {
    real t, t_low;                          /* time, and what it was rounded by */
    real z[STATE], low[COMPENSATED*STATE];  /* state, and what it was rounded by */
    real turns[ANGLES];                     /* whole turns of angles known by sine and cosine */
    real first[IS_FSAL*STATE];              /* the slope here, left by the last step */
    real scale[SCALES];                     /* power of two that was taken out of the change */
} Place;

enum { PLACE = sizeof(Place)/sizeof(real) };

/* x + change; `low` receives what the sum is rounded by (D. E. Knuth, The Art of Computer
   Programming, volume 2, theorem 4.2.2B). */
static inline real sum(real x, real change, real *low)
{
    const real total = x + change, part = total - x;
    *low = (x - (total - part)) + (change - part);
    return total;
}

static inline void add(Place *place, int n, real change)
{
#if COMPENSATED
    real low;
    place->z[n] = sum(place->z[n], change + place->low[n], &low);
    place->low[n] = low;
#else
    place->z[n] += change;
#endif
}

/* Bring sin^2 + cos^2 back to 1: by the series of 1/sqrt(1 - d) where d is small, as it nearly
   always is, after a division where it is not. */
static inline void settle(Place *place)
{
    for (int a = 0; a < ANGLES; a++) {
        real s = place->z[SINE[a]], c = place->z[SINE[a] + 1], square = s*s + c*c;
        const mask far = below(every(1e-4), size(1.0 - square));
        if (any(far)) {
            const real length = root(square, far);
            place->z[SINE[a]] = s = chosen(far, s/length, s);
            place->z[SINE[a] + 1] = c = chosen(far, c/length, c);
            square = s*s + c*c;
        }
        const real d = 1.0 - square, excess = d*(0.5 + d*(0.375 + d*0.3125));
        add(place, SINE[a], s*excess);
        add(place, SINE[a] + 1, c*excess);
    }
}

/* A small change may grow without end, but not the numbers for it: where it is large, take a power of
   two out of it. That is exact. */
static inline void rescale(const Place *start, Place *end)
{
    for (int k = 0; k < SCALES; k++) {
        real largest = every(0.0);
        for (int n = STATE - CHANGES; n < STATE; n++) {
            largest = larger(largest, size(end->z[n]));
        }
        const mask large = below(every(0x1p64), largest);
        const real part = chosen(large, every(0x1p-64), every(1.0));
        for (int n = STATE - CHANGES; n < STATE; n++) {
            end->z[n] *= part;
#if COMPENSATED
            end->low[n] *= part;
#endif
        }
        for (int n = STATE - CHANGES; n < STATE && IS_FSAL; n++) {
            end->first[n] *= part;
        }
        end->scale[k] = start->scale[k] + chosen(large, every(64.0), every(0.0));
    }
}

/* The angle within 0.08 of its value between -pi and pi: enough to count turns. */
static inline real rough_angle(const Place *place, int a)
{
    const real s = place->z[SINE[a]], c = place->z[SINE[a] + 1];
    const real acute = s*(PI/2 - (PI/2 - 1)*size(c));
    return chosen(below(c, every(0.0)), signed_as(every(PI), s) - acute, acute);
}

/* An angle turns by about its mean velocity times h; the rest is whole turns. Returns 0, or NaN
   where they cannot be counted. */
static inline real count_turns(const Place *start, real h, Place *end)
{
    real nothing = every(0.0);
    for (int a = 0; a < ANGLES; a++) {
        const real turned = h*(start->z[RATE[a]] + end->z[RATE[a]])*0.5;
        const real gap = rough_angle(start, a) + turned - rough_angle(end, a);
        end->turns[a] = start->turns[a] + nearest_whole(gap*(0.5/PI));
        nothing += gap - gap;
    }
    return nothing;
}

/* The place after h, and the estimate of the local error. Returns how many rounds of all stages were
   made, which is one unless the method is implicit. */
static __attribute__((noinline)) real step(
    const Place *restrict start, real h, const real *restrict params, int estimates,
    Place *restrict end, real (*restrict error)[STATE])
{
    real k[STAGES][STATE];
    for (int n = 0; n < STATE && IS_FSAL; n++) {
        k[0][n] = start->first[n];
    }
    if (!IS_FSAL) {
        RHS(start->t, start->z, params, k[0]);
    }
    for (int i = 1; i < STAGES && !IS_EXPLICIT; i++) {
        memcpy(k[i], k[0], sizeof k[0]);
    }
    const real rounds = stages(start->t, start->z, h, k, params);
    for (int n = 0; n < STATE; n++) {
        end->z[n] = start->z[n];
#if COMPENSATED
        end->low[n] = start->low[n];
#endif
        add(end, n, increment(h, k, n));
    }
    for (int n = 0; n < STATE && IS_FSAL; n++) {
        end->first[n] = k[STAGES - 1][n];
    }
    for (int n = 0; n < STATE && estimates; n++) {
        error[0][n] = estimate(h, k, n);
        if (ESTIMATES > 1) {
            error[1][n] = second_estimate(h, k, n);
        }
    }
    end->t = sum(start->t, h + start->t_low, &end->t_low);
    return rounds;
}

/* Mean square of `values` in parts of what is allowed at states x and y. */
static inline real mean_square(
    const real *values, const real *x, const real *y, double rtol, double atol)
{
    real allowed[STATE], total = every(0.0);
    for (int n = 0; n < STATE; n++) {
        allowed[n] = larger(atol + rtol*larger(size(x[n]), size(y[n])), every(1e-75));
    }
    /* two parts by one division, which takes as long as a dozen products */
    for (int n = 0; n + 1 < STATE; n += 2) {
        const real u = values[n]*allowed[n + 1], v = values[n + 1]*allowed[n];
        const real both = allowed[n]*allowed[n + 1];
        total += (u*u + v*v)/(both*both);
    }
    if (STATE % 2) {
        const real part = values[STATE - 1]/allowed[STATE - 1];
        total += part*part;
    }
    return total*(1.0/STATE);
}

/* Mean square of the error; of two estimates combined (E. Hairer, S. P. Norsett, G. Wanner, Solving
   Ordinary Differential Equations I, section II.10). */
static inline real error_square(
    real (*error)[STATE], const real *x, const real *y, double rtol, double atol)
{
    const real first = mean_square(error[0], x, y, rtol, atol);
    if (ESTIMATES < 2) {
        return first;
    }
    const real second = mean_square(error[1], x, y, rtol, atol);
    return first*first/(first + 0.01*second + 1e-300);
}

/* By what the step changes after an error of this mean square: PI control if it was kept, else the
   plain rule. `previous` is the binary logarithm of the last kept step's error. */
static inline real factor(real square, mask kept, real *previous)
{
    const double share = 1.0/(ERROR_ORDER + 1);
    const real now = 0.5*binary_logarithm(square + 1e-20);
    const real exponent = chosen(kept, share*(0.4**previous - 0.7*now), -share*now);
    const real least = every(log2(SHRINK/SAFETY)), most = every(log2(GROW/SAFETY));
    *previous = chosen(kept, now, *previous);
    return SAFETY*power_of_two(smaller(larger(exponent, least), most));
}

/* In some lanes, a step to begin with, from how the slope changes over a very short one (E. Hairer,
   S. P. Norsett, G. Wanner, Solving Ordinary Differential Equations I, section II.4). */
static real first_step(
    const Place *place, const real *slope, const real *params, real duration, mask where,
    double rtol, double atol)
{
    const real *z = place->z;
    real ahead[STATE], later[STATE];
    const real allowance = root(mean_square(z, z, z, rtol, atol), where);
    const real speed = root(mean_square(slope, z, z, rtol, atol), where);
    const mask usual =
        below(every(1e-5), smaller(allowance, speed)) & below(speed, every(INFINITY));
    real h = chosen(usual, 0.01*allowance/speed, every(1e-6));
    h = smaller(h, size(duration));
    for (int n = 0; n < STATE; n++) {
        ahead[n] = z[n] + signed_as(h, duration)*slope[n];
    }
    RHS(place->t + signed_as(h, duration), ahead, params, later);
    for (int n = 0; n < STATE; n++) {
        later[n] -= slope[n];
    }
    const real bend = larger(speed, root(mean_square(later, z, z, rtol, atol), where)/h);
    const real longer =
        power_of_two(binary_logarithm(0.01/larger(bend, every(1e-15)))*(1.0/(ERROR_ORDER + 1)));
    const real found = smaller(smaller(100.0*h, longer), size(duration));
    return chosen(below(bend, every(INFINITY)), found, h);
}
