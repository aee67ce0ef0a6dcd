/* Motions that stay on zeros of switching functions, as in solvers/equations/sliding.py.

   A sign of each switching function is held behind the parameters. Where it is 0, the function stays
   0: then it is replaced by the number s with which the function does not change, where f is
   f(1) + (s - 1) (f(1) - f(-1))/2.

   Defined before this file: SMOOTH_RHS, by signs; SWITCHING, which gives the functions, their rates,
   and in a variational form the perturbations of both; and PERTURBED, the number of perturbed
   velocities, which are the components VELOCITY and PERTURBATION. */

enum { VALUES = (PERTURBED > 0 ? 4 : 2)*SWITCHES };
enum { FIRST_SIGN = PARAMETERS - 2*SWITCHES, FIRST_LEVEL = PARAMETERS - SWITCHES };
enum { RATES = SWITCHES, CHANGES = 2*SWITCHES, CHANGES_OF_RATES = 3*SWITCHES };

typedef struct {
    real derivative[DIM];
    real values[VALUES];
    real signs[SWITCHES];
    real excess[DIM];   /* of the state, up to which functions that stay 0 are 0 */
} Sliding;

static inline mask is_zero(real x)
{
    return ~less_than(splat(0.0), lane_fabs(x));
}

/* Solve a system of equations; `x` is the right-hand side, then the solution. */
static void solve_signs(real (*given)[SWITCHES], real *x)
{
    real matrix[SWITCHES][SWITCHES];
    memcpy(matrix, given, sizeof matrix);
    for (int j = 0; j < SWITCHES; j++) {
        for (int i = j + 1; i < SWITCHES; i++) {
            const real multiplier = matrix[i][j]/matrix[j][j];
            for (int m = j + 1; m < SWITCHES; m++) {
                matrix[i][m] -= multiplier*matrix[j][m];
            }
            x[i] -= multiplier*x[j];
        }
    }
    for (int i = SWITCHES - 1; i >= 0; i--) {
        for (int j = i + 1; j < SWITCHES; j++) {
            x[i] -= matrix[i][j]*x[j];
        }
        x[i] /= matrix[i][i];
    }
}

/* The right-hand side, switching functions and all signs with the signs in `params`. */
static __attribute__((noinline)) void slide(
    real t, const real *z, const real *params, Sliding *result)
{
    const real zero = splat(0.0), one = splat(1.0);
    real held[PARAMETERS], jumps[SWITCHES][DIM], other[VALUES], by_sign[SWITCHES][VALUES];
    real matrix[SWITCHES][SWITCHES], change[SWITCHES], response[SWITCHES], excess[SWITCHES];
    mask slides[SWITCHES], any_slides = {0};
    memcpy(held, params, sizeof held);
    for (int k = 0; k < SWITCHES; k++) {
        slides[k] = is_zero(params[FIRST_SIGN + k]);
        any_slides |= slides[k];
        held[FIRST_SIGN + k] = select(slides[k], one, params[FIRST_SIGN + k]);
        result->signs[k] = held[FIRST_SIGN + k];
    }
    SMOOTH_RHS(t, z, held, result->derivative);
    SWITCHING(t, z, held, result->values);
    memset(result->excess, 0, sizeof result->excess);
    if (!any(any_slides)) {
        return;
    }
    memset(jumps, 0, sizeof jumps);
    memset(by_sign, 0, sizeof by_sign);
    for (int k = 0; k < SWITCHES; k++) {
        if (!any(slides[k])) {
            continue;
        }
        held[FIRST_SIGN + k] = select(slides[k], -one, held[FIRST_SIGN + k]);
        SMOOTH_RHS(t, z, held, jumps[k]);
        SWITCHING(t, z, held, other);
        held[FIRST_SIGN + k] = result->signs[k];
        for (int n = 0; n < DIM; n++) {
            jumps[k][n] = select(slides[k], 0.5*(result->derivative[n] - jumps[k][n]), zero);
        }
        for (int v = 0; v < VALUES; v++) {
            by_sign[k][v] = select(slides[k], 0.5*(result->values[v] - other[v]), zero);
        }
    }
    for (int j = 0; j < SWITCHES; j++) {
        for (int k = 0; k < SWITCHES; k++) {
            matrix[j][k] = select(slides[j] & slides[k], by_sign[k][RATES + j],
                                  splat(j == k ? 1.0 : 0.0));
        }
        change[j] = select(slides[j], -result->values[RATES + j], zero);
        excess[j] = select(slides[j], result->values[j], zero);
    }
    solve_signs(matrix, change);
    solve_signs(matrix, excess);
    for (int k = 0; k < SWITCHES; k++) {
        for (int n = 0; n < DIM; n++) {
            result->derivative[n] += change[k]*jumps[k][n];
            result->excess[n] += excess[k]*jumps[k][n];
        }
        for (int v = 0; v < VALUES; v++) {
            result->values[v] += change[k]*by_sign[k][v];
        }
        result->signs[k] += change[k];
    }
#if PERTURBED
    /* signs that follow the motion follow its perturbation, too */
    for (int j = 0; j < SWITCHES; j++) {
        response[j] = select(slides[j], -result->values[CHANGES_OF_RATES + j], zero);
    }
    solve_signs(matrix, response);
    for (int k = 0; k < SWITCHES; k++) {
        for (int i = 0; i < PERTURBED; i++) {
            result->derivative[PERTURBATION[i]] += response[k]*jumps[k][VELOCITY[i]];
        }
        for (int j = 0; j < SWITCHES; j++) {
            result->values[CHANGES_OF_RATES + j] += response[k]*by_sign[k][RATES + j];
        }
    }
#else
    (void)response;
#endif
}

static inline void switched_rhs(real t, const real *z, const real *params, real *derivative)
{
    mask any_slides = {0};
    for (int k = 0; k < SWITCHES; k++) {
        any_slides |= is_zero(params[FIRST_SIGN + k]);
    }
    if (any(any_slides)) {
        Sliding sliding;
        slide(t, z, params, &sliding);
        memcpy(derivative, sliding.derivative, sizeof sliding.derivative);
    } else {
        SMOOTH_RHS(t, z, params, derivative);
    }
}
#define RHS switched_rhs

#if HAS_JACOBIAN
/* The Jacobian; where functions stay 0, by differences. */
static void switched_jacobian(double t, const double *z, const double *params, double *jacobian)
{
    int slides = 0;
    for (int k = 0; k < SWITCHES; k++) {
        slides |= params[FIRST_SIGN + k] == 0;
    }
    if (!slides) {
        SMOOTH_JACOBIAN(t, z, params, jacobian);
        return;
    }
    for (int j = 0; j < DIM; j++) {
        double moved[DIM], after[DIM], before[DIM];
        const double change = 1e-5*lane_fmax(fabs(z[j]), 1.0);
        memcpy(moved, z, sizeof moved);
        moved[j] = z[j] + change;
        switched_rhs(t, moved, params, after);
        moved[j] = z[j] - change;
        switched_rhs(t, moved, params, before);
        for (int i = 0; i < DIM; i++) {
            jacobian[i*DIM + j] = (after[i] - before[i])/(2*change);
        }
    }
}
#define JACOBIAN switched_jacobian
#endif
