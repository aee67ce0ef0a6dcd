/* Stages of an implicit method by Newton's iteration, in one lane.

   The derivatives k of the stages fulfil k_i = f(t + c_i h, z + h sum_j a_ij k_j). A simplified
   iteration has one Jacobian for all stages, at the start of the step or of an earlier one. */

/* A Jacobian is kept for the next step while an iteration reduces the error to this part. */
static const double KEPT_RATE = 1e-3;

/* Solve the stages; NaN where that fails. `derivative` is the one at the start. */
static void solve_stages(
    const Method *method, const Task *task, const State *start, double h, const double *params,
    const double *derivative, double (*k)[DIM], State *end, StepResult *result)
{
    const double (*last)[DIM] = (const double (*)[DIM])start->polynomial;
    const int has_polynomial = method->lagrange[0] != 0;
    end->jacobian_t[0] = start->jacobian_t[0];
    memcpy(end->jacobian_z, start->jacobian_z, sizeof end->jacobian_z);
    for (int is_new = start->rate[0] > KEPT_RATE; is_new < 2; is_new++) {
        if (is_new) {
            end->jacobian_t[0] = start->t;
            memcpy(end->jacobian_z, start->z, sizeof end->jacobian_z);
            result->jacobians += 1;
        }
        for (int i = 0; i < method->stages; i++) {
            memcpy(k[i], derivative, sizeof k[i]);
        }
        if (has_polynomial) {
            extrapolate(method_of_last_step(start), 1.0, h/start->length[0], last, method, k);
        }
        end->rate[0] = start->rate[0];
        if (iterate(method, task, start, h, params, end->jacobian_t[0], end->jacobian_z, k,
                    end->rate, result)) {
            return;
        }
    }
    end->rate[0] = 1.0;
    if (task->fixed_h
        && continue_from_short_steps(method, start, h, params, derivative, k, result)) {
        return;
    }
    k[0][0] = NAN;
}
