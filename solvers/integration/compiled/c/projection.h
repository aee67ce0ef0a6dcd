/* States on the manifold of the constraints.

   Defined before this file: correct(), one step of Newton's method onto the constraints, and the
   number of these steps (CORRECTIONS), 0 without constraints; evaluate_integrals(), whose KEPT
   values are kept as parameters from FIRST_KEPT on. */

/* Let the motion of a lane keep the values that its integrals have. */
static inline void keep_integrals(Motion *motion, int lane)
{
    real values[KEPT + 1];
    evaluate_integrals(&motion->state, motion->params, values);
    for (int k = 0; k < KEPT; k++) {
        LANE(motion->params[FIRST_KEPT + k], lane) = LANE(values[k], lane);
    }
}

/* Restore sin^2 + cos^2 = 1 and the constraints. */
static inline void project(State *state, const real *params)
{
    normalise_angles(state);
    for (int k = 0; k < CORRECTIONS; k++) {
        correct(state, params);
        normalise_angles(state);
    }
}
