/* Motions on the manifold of their constraints, to rounding of `real`.

   Defined before this file, beside the stages: EVALUATE, which gives the KEPT values that are kept as
   the last parameters; CORRECTION, one step of Newton's method onto the constraints; the indices
   COLUMN of ordinary components, of which those from DIM on are angles, and SINE of the sines of
   these. */

/* The second step squares the error of the first one; the third one is for loose tolerances. */
enum { MOST_PROJECTIONS = 3 };

static void project(Motion *motion)
{
    for (int count = 0; count < MOST_PROJECTIONS; count++) {
        number change[ORDINARY];
        correction(motion, change);
        for (int k = 0; k < ORDINARY; k++) {
            if (COLUMN[k] >= DIM) {
                turn(motion, SINE[COLUMN[k] - DIM], change[k]);
            }
            shift(motion, COLUMN[k], change[k]);
        }
    }
}
