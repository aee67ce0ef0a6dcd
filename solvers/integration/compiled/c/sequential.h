/* One step of an explicit method in every lane.

   Defined before this file, beside that of step.h: the method, by STAGES, IS_FSAL, IS_SPLITTING,
   ERROR_ORDER, ESTIMATES, stages(), increment(), estimate(), and second_estimate() where there are
   two of them. */

#define HAS_POLYNOMIAL 0
#define INTERPOLATES 0

static const double SAFETY = 0.9, SHRINK = 0.2, GROW = 5.0;

/* Squared norm of the error; of two estimates combined (E. Hairer, S. P. Norsett, G. Wanner,
   Solving Ordinary Differential Equations I, section II.10). */
static inline real squared_error_norm(
    const real (*error)[DIM], const real *x, const real *y, double rtol, double atol)
{
    real squares[2];
    mean_squares(ESTIMATES, error, x, y, rtol, atol, squares);
    return ESTIMATES < 2 ? squares[0]
                         : squares[0]*squares[0]/(squares[0] + 0.01*squares[1] + 1e-300);
}

/* Which natural weights are those of component n: of a splitting, velocities have the second. */
static inline int weights_of(const State *start, int n)
{
    (void)start;
    return IS_SPLITTING && n >= DIM/2;
}

/* The change of component n that belongs to stage m, in one register of a real. */
static inline half stage_change(
    const State *end, const StepResult *result, const real *h, int part, int m, int n)
{
    (void)end;
    return PART(*h, part)*PART(result->k[m][n], part);
}

/* Component n of the derivative at the end, if the last stage has it: of a splitting its velocities
   are those before the last kick. */
static inline real last_derivative(const State *end, real (*k)[DIM], int n)
{
    return IS_SPLITTING && n < DIM/2 ? end->z[DIM/2 + n] : k[STAGES - 1][n];
}

/* The state after h; with step control also the norm of the estimated error. */
static __attribute__((noinline)) void step(
    const Task *task, const State *restrict start, real h, const real *restrict params,
    State *restrict end, StepResult *restrict result)
{
    real (*restrict k)[DIM] = result->k, error[2][DIM];
    for (int n = 0; n < DIM && IS_FSAL; n++) {
        k[0][n] = start->derivative[n];
    }
    if (!IS_FSAL) {
        RHS(start->t, start->z, params, k[0]);
    }
    stages(start->t, start->z, h, k, params);
    result->evaluations = splat(STAGES - IS_FSAL);
    result->jacobians = splat(0.0);
    for (int n = 0; n < DIM; n++) {
        move_component(start, end, n, increment(h, k, n));
    }
    for (int n = 0; n < DIM && IS_FSAL; n++) {
        end->derivative[n] = last_derivative(end, k, n);
    }
    end->t = two_sum(start->t, h + start->t_low, &end->t_low);
    for (int n = 0; n < DIM && !task->fixed_h; n++) {
        error[0][n] = estimate(h, k, n);
        if (ESTIMATES > 1) {
            error[1][n] = second_estimate(h, k, n);
        }
    }
    if (!task->fixed_h) {
        result->squared_error =
            squared_error_norm((const real (*)[DIM])error, start->z, end->z, task->rtol, task->atol);
    }
}

/* Factor of h after an error of this squared norm: PI control after an accepted step, the plain
   rule after a rejected one. */
static inline real step_factor(
    const StepResult *result, mask accepted, real h, const State *start, real *previous_error)
{
    const double share = 1.0/(ERROR_ORDER + 1);
    const real error = 0.5*lane_log2(result->squared_error + 1e-20);
    const real exponent =
        select(accepted, share*(0.4**previous_error - 0.7*error), -share*error);
    const real least = splat(log2(SHRINK/SAFETY)), most = splat(log2(GROW/SAFETY));
    *previous_error = select(accepted, error, *previous_error);
    (void)h; (void)start;
    return SAFETY*lane_exp2(lane_fmin(lane_fmax(exponent, least), most));
}
