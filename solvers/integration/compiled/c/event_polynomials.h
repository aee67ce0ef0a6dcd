/* Polynomials of events over a step, and steps within which an event may occur more than once.

   The stages of a step give a natural extension, at no cost; where it comes near the value of an
   event and back, the nodes of an explicit method's extension of its own order are evaluated.

   Where many samples lie in a step, LEAST_SAMPLES or more, this extension gives them, too.

   Defined before this file: of the natural extension DEGREE, and NATURAL, the Bernstein coefficients
   of its weights for each method of a family, or of a splitting for positions and for velocities,
   STAGES_OF of them; of the other one ROUNDS, EXTENSION_NODES, the nodes EXTENSION_C, FIRST and
   INTEGRALS, the weights of the states at the nodes in the first round and later, and EXTENDED,
   Bernstein coefficients; which of the natural weights are those of component n, weights_of(), and
   the change of component n that belongs to stage m, stage_change(). */

enum { EXTENSION_DEGREE = ROUNDS > 0 ? EXTENSION_NODES : DEGREE };

/* Slopes of the natural extension err by less than this factor. */
static const double SLACK = 1.5;

/* The component of an event, of an angle its sine, which the cosine follows. */
static inline int component_of(const Event *event)
{
    return event->is_angle ? SINE[event->index] : (int)event->index;
}

/* The value of an event at the start of a step, 0 without its rounding error; of an angle, the sine
   of its difference from the event. */
static inline real value_at_start(const Event *event, const State *start, real before)
{
    const int n = component_of(event);
    const mask is_zero = ~(less_than(before, splat(0.0)) | less_than(splat(0.0), before));
    const real value = event->is_angle
        ? event->cosine*start->z[n] - event->sine*start->z[n + 1] : start->z[n] - event->value;
    return select(is_zero, splat(0.0), value);
}

/* The Bernstein coefficients of a switching function, by its values and rates of change at the ends
   of the step; of another event nothing. */
static inline void switching_polynomial(
    const Event *event, const State *start, const State *end, real h, const real *params,
    real before, real after, int degree, real *coefficients)
{
#if HAS_SWITCHES
    if (!event->is_switch) {
        return;
    }
    coefficients[0] = before;
    coefficients[1] = before + h*switching_rate(event->index, start, params, h)*(1.0/3);
    coefficients[2] = after - h*switching_rate(event->index, end, params, h)*(1.0/3);
    coefficients[3] = after;
    for (int d = 4; d <= degree; d++) {     /* the same with a degree that is larger by one */
        coefficients[d] = after;
        for (int k = d - 1; k > 0; k--) {
            const double part = (double)k/d;
            coefficients[k] = part*coefficients[k - 1] + (1 - part)*coefficients[k];
        }
    }
#else
    (void)event; (void)start; (void)end; (void)h; (void)params;
    (void)before; (void)after; (void)degree; (void)coefficients;
#endif
}

/* Bounds of the slope of an event's value in a step of an explicit method, by the derivatives at its
   stages: the mean, and SLACK times the largest deviation from it. An angle has the slope of its
   velocity, which differs from the mean of both ends by at most half of its largest change. */
static inline void slope_bounds(
    const Event *event, const State *start, const State *end, const StepResult *result, real h,
    real *mean, real *slack)
{
    const int64_t n = event->is_angle ? RATE[event->index] : event->index;
    half most[PARTS], least[PARTS];
    for (int part = 0; part < PARTS; part++) {
        most[part] = least[part] = (half){0};
    }
    for (int m = 0; m < STAGES*IS_EXPLICIT; m++) {
        for (int part = 0; part < PARTS; part++) {
            const half slope = PART(result->k[m][n], part);
            most[part] = m ? half_fmax(most[part], slope) : slope;
            least[part] = m ? half_fmin(least[part], slope) : slope;
        }
    }
    for (int part = 0; part < PARTS; part++) {
        PART(*mean, part) = 0.5*(most[part] + least[part]);
        PART(*slack, part) = (0.5*SLACK)*(most[part] - least[part]);
    }
    if (event->is_angle) {
        const real largest = lane_fabs(*mean) + (1/SLACK)*(*slack);
        *slack = (0.5*SLACK)*lane_fabs(h)*largest;
        *mean = 0.5*(start->z[n] + end->z[n]);
    }
}

/* Whether the value of an event may have several zeros in a step.

   Its slopes differ by at most the sum of their changes; if these are smaller than the slopes, by a
   factor for the error of the extension, the value is monotonic. It differs from the chord by at
   most a quarter of that sum times the degree, which the curves of most steps do not half reach.
   `coefficients` receives the Bernstein coefficients.

   Sums are those of single registers, since GCC keeps longer vectors that change in memory. */
static __attribute__((noinline)) mask has_several(
    const Event *event, const State *start, const State *end, const StepResult *result, real h,
    const real *params, real before, real after, real *coefficients)
{
    const int is_switch = event->is_switch != 0, n = is_switch ? 0 : component_of(event);
    const int own = weights_of(start, n);
    const real first = is_switch ? before : value_at_start(event, start, before);
    real steepness, distance;
    real given[DEGREE + 1];
    switching_polynomial(event, start, end, h, params, before, after, DEGREE, given);
    for (int part = 0; part < PARTS; part++) {
        half c[DEGREE + 1], bend = {0};
        for (int k = 0; k <= DEGREE; k++) {
            c[k] = is_switch ? PART(given[k], part) : PART(first, part);
        }
        for (int m = 0; m < STAGES_OF[own] && !is_switch; m++) {
            half change = stage_change(end, result, &h, part, m, n);
            if (event->is_angle) {
                change = event->cosine*change
                    - event->sine*stage_change(end, result, &h, part, m, n + 1);
            }
            for (int k = 1; k <= DEGREE; k++) {
                c[k] += NATURAL[own][m][k]*change;
            }
        }
        for (int k = 1; k < DEGREE; k++) {
            bend += half_fabs((c[k + 1] + c[k - 1]) - 2.0*c[k]);
        }
        const half slopes = (c[1] - c[0]) + (c[DEGREE] - c[DEGREE - 1]);
        const half nearest = half_fabs(c[0] + c[DEGREE]) - half_fabs(c[DEGREE] - c[0]);
        PART(steepness, part) = half_fabs(slopes) - SLACK*bend;
        PART(distance, part) = 0.5*nearest - (0.25*DEGREE)*bend;
        for (int k = 0; k <= DEGREE; k++) {
            PART(coefficients[k], part) = c[k];
        }
    }
    const real zero = splat(0.0);
    return ~(less_than(zero, steepness) | less_than(zero, distance));
}

/* Changes h f at the nodes of the extension of the method's order. */
static __attribute__((noinline)) void extend(
    const State *start, const State *end, const StepResult *result, real h, const real *params,
    real (*changes)[DIM])
{
    real z[EXTENSION_NODES][DIM], own[STAGES][DIM];
    for (int m = 0; m < STAGES; m++) {
        for (int n = 0; n < DIM; n++) {
            for (int part = 0; part < PARTS; part++) {
                PART(own[m][n], part) = stage_change(end, result, &h, part, m, n);
            }
        }
    }
    for (int round = 0; round < ROUNDS; round++) {
        const int terms = round == 0 ? STAGES : EXTENSION_NODES;
        real (*from)[DIM] = round == 0 ? own : changes;
        for (int i = 0; i < EXTENSION_NODES; i++) {
            memcpy(z[i], start->z, sizeof z[i]);
            for (int m = 0; m < terms; m++) {
                for (int n = 0; n < DIM; n++) {
                    const double *first = FIRST[weights_of(start, n)][i];
                    z[i][n] += (round == 0 ? first : INTEGRALS[i])[m]*from[m][n];
                }
            }
        }
        for (int i = 0; i < EXTENSION_NODES; i++) {
            RHS(start->t + h*EXTENSION_C[i], z[i], params, changes[i]);
            for (int n = 0; n < DIM; n++) {
                changes[i][n] *= h;
            }
        }
    }
}

/* The Bernstein coefficients of the value of an event by these. */
static void extended_polynomial(
    const Event *event, const State *start, const real (*changes)[DIM], real before,
    real *coefficients)
{
    const int n = component_of(event);
    coefficients[0] = value_at_start(event, start, before);
    for (int k = 1; k <= EXTENSION_DEGREE; k++) {
        coefficients[k] = coefficients[0];
        for (int m = 0; m < EXTENSION_NODES; m++) {
            coefficients[k] += EXTENDED[m][k]*(event->is_angle
                ? event->cosine*changes[m][n] - event->sine*changes[m][n + 1] : changes[m][n]);
        }
    }
}

/* The coefficients of the powers x^k (1 - x)^(EXTENSION_NODES - k), k > 0, in the change of the state
   up to a part x of the step. */
static void extended_states(const real (*changes)[DIM], mask lanes, real (*coefficients)[DIM])
{
    double binomial = 1;
    for (int k = 1; k <= EXTENSION_NODES; k++) {
        real sums[DIM];
        memset(sums, 0, sizeof sums);
        binomial *= (double)(EXTENSION_NODES - k + 1)/k;
        for (int m = 0; m < EXTENSION_NODES; m++) {
            for (int n = 0; n < DIM; n++) {
                sums[n] += (binomial*EXTENDED[m][k])*changes[m][n];
            }
        }
        for (int n = 0; n < DIM; n++) {
            coefficients[k - 1][n] = select(lanes, sums[n], coefficients[k - 1][n]);
        }
    }
}

/* The change of the state up to the part x of the step. */
static inline void change_within(const real (*coefficients)[DIM], real x, real *change)
{
    real right[EXTENSION_NODES + 1], left = splat(1.0);
    right[0] = left;
    for (int k = 1; k <= EXTENSION_NODES; k++) {
        right[k] = x*right[k - 1];
    }
    memset(change, 0, DIM*sizeof *change);
    for (int k = EXTENSION_NODES; k > 0; k--) {
        for (int n = 0; n < DIM; n++) {
            change[n] += (left*right[k])*coefficients[k - 1][n];
        }
        left *= 1.0 - x;
    }
}
