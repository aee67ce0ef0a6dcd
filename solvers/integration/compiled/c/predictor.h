/* The first guess of the stages of a step: the polynomial of another one, with the same method or
   another. */

/* Derivatives at the nodes of a step of `ratio` times the length, from those of the polynomial
   through `from`; the step starts at the part `begin` of the polynomial's. */
static void extrapolate(
    const Method *last, double begin, double ratio, const double (*from)[DIM],
    const Method *method, double (*k)[DIM])
{
    double weights[STAGES][STAGES];
    for (int i = 0; i < method->stages; i++) {
        const double x = begin + ratio*method->c[i];
        for (int j = 0; j < last->stages; j++) {
            weights[i][j] = last->lagrange[j];
            for (int m = 0; m < last->stages; m++) {
                weights[i][j] *= m == j ? 1.0 : x - last->c[m];
            }
        }
    }
    multiply(method->stages, (const double (*)[STAGES])weights, last->stages, from, k);
}

/* The polynomial of a motion that starts with a derivative and a first step. */
static void start_polynomial(State *state, double h, const double *derivative)
{
    for (int i = 0; i < STAGES; i++) {
        memcpy(state->polynomial + i*DIM, derivative, DIM*sizeof *derivative);
    }
    state->length[0] = h;
    state->rate[0] = 1.0;
}
