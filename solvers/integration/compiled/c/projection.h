/* States on the manifold of the constraints.

   Defined before this file: correct(), one step of Newton's method onto the constraints, and the
   number of these steps (CORRECTIONS), 0 without constraints. */

/* Restore sin^2 + cos^2 = 1 and the constraints. */
static inline void project(State *state, const real *params)
{
    normalise_angles(state);
    for (int k = 0; k < CORRECTIONS; k++) {
        correct(state, params);
        normalise_angles(state);
    }
}
