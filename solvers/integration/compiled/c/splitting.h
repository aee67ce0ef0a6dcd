/* Stages of a splitting: states before kicks of the velocities, between which positions drift.

   Defined before this file: KICKS, DRIFTS, the drift before each kick, and NODES, their sums. */

enum { POSITIONS = DIM/2 };

static inline void stages(
    real t, const real *z, real h, real (*k)[DIM], const real *params)
{
    real stage[DIM], change[DIM];
    for (int n = 0; n < DIM; n++) {
        change[n] = splat(0.0);
    }
    for (int i = 1; i < STAGES; i++) {
        for (int n = 0, v = POSITIONS; n < POSITIONS; n++, v++) {
            change[v] += (h*KICKS[i - 1])*k[i - 1][v];
            stage[v] = z[v] + change[v];
            change[n] += (h*DRIFTS[i])*stage[v];
            stage[n] = z[n] + change[n];
        }
        RHS(t + h*NODES[i], stage, params, k[i]);
    }
}

/* The change of component n in a step. */
static inline real increment(real h, real (*k)[DIM], int n)
{
    const double *weights = n < POSITIONS ? DRIFTS : KICKS;
    real sum = splat(0.0);
    for (int i = 0; i < STAGES; i++) {
        sum += (h*weights[i])*k[i][n];
    }
    return sum;
}
