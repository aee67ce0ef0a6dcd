/* The stages of an implicit method, in one lane.

   Defined before this file: the coefficients A and C, and JACOBIAN, the derivative of RHS. */

enum { UNKNOWNS = STAGES*DIM, MAX_NEWTON_ITERATIONS = 100 };

/* The iteration ends when the relative change is below TOLERANCE; numbers not much larger than TINY
   have fewer digits than others. */
static const double TOLERANCE = 1e-14, TINY = 1e-290;

/* Replace a matrix by its triangular factors, with row exchanges; 0 if it is singular. */
static int factorise(double (*matrix)[UNKNOWNS], int *pivots)
{
    for (int j = 0; j < UNKNOWNS; j++) {
        int pivot = j;
        for (int i = j + 1; i < UNKNOWNS; i++) {
            pivot = fabs(matrix[i][j]) > fabs(matrix[pivot][j]) ? i : pivot;
        }
        pivots[j] = pivot;
        if (!(fabs(matrix[pivot][j]) > 0)) {
            return 0;
        }
        for (int n = 0; n < UNKNOWNS && pivot != j; n++) {
            const double upper = matrix[j][n];
            matrix[j][n] = matrix[pivot][n];
            matrix[pivot][n] = upper;
        }
        const double inverse = 1.0/matrix[j][j];
        for (int i = j + 1; i < UNKNOWNS; i++) {
            const double multiplier = matrix[i][j] *= inverse;
            for (int n = j + 1; n < UNKNOWNS; n++) {
                matrix[i][n] -= multiplier*matrix[j][n];
            }
        }
    }
    return 1;
}

static void solve(double (*factors)[UNKNOWNS], const int *pivots, double *x)
{
    for (int j = 0; j < UNKNOWNS; j++) {
        const double right = x[pivots[j]];
        x[pivots[j]] = x[j];
        x[j] = right;
    }
    for (int i = 1; i < UNKNOWNS; i++) {
        for (int j = 0; j < i; j++) {
            x[i] -= factors[i][j]*x[j];
        }
    }
    for (int i = UNKNOWNS - 1; i >= 0; i--) {
        for (int j = i + 1; j < UNKNOWNS; j++) {
            x[i] -= factors[i][j]*x[j];
        }
        x[i] /= factors[i][i];
    }
}

/* Derivatives k of all stages from initial guesses, by simplified Newton iteration with the
   Jacobian at the start of the step (E. Hairer, G. Wanner, Solving Ordinary Differential Equations
   II, section IV.8). Returns the number of iterations; k is NaN if they do not converge. */
static double stages(
    double t, const double *z, double h, double (*k)[DIM], const double *params)
{
    double jacobian[DIM*DIM], matrix[UNKNOWNS][UNKNOWNS], change[UNKNOWNS];
    int pivots[UNKNOWNS], iteration = 0;
    double largest = 0.0, steepest = 0.0, previous = INFINITY;
    JACOBIAN(t, z, params, jacobian);
    for (int n = 0; n < DIM*DIM; n++) {
        steepest = fmax(steepest, fabs(h*jacobian[n]));
    }
    for (int i = 0; i < UNKNOWNS; i++) {
        for (int j = 0; j < UNKNOWNS; j++) {
            matrix[i][j] = (i == j) - h*A[i/DIM][j/DIM]*jacobian[i % DIM*DIM + j % DIM];
        }
    }
    for (int n = 0; n < DIM; n++) {
        largest = fmax(largest, fabs(z[n]));
    }
    int solvable = factorise(matrix, pivots);
    while (solvable && iteration < MAX_NEWTON_ITERATIONS) {
        iteration++;
        for (int i = 0; i < STAGES; i++) {
            double stage[DIM];
            for (int n = 0; n < DIM; n++) {
                double sum = 0.0;
                for (int j = 0; j < STAGES; j++) {
                    sum += A[i][j]*k[j][n];
                }
                stage[n] = z[n] + h*sum;
            }
            RHS(t + C[i]*h, stage, params, change + i*DIM);
        }
        for (int n = 0; n < UNKNOWNS; n++) {
            change[n] -= k[n/DIM][n % DIM];
        }
        solve(matrix, pivots, change);
        double largest_change = 0.0, largest_increment = 0.0;
        for (int n = 0; n < UNKNOWNS; n++) {
            k[n/DIM][n % DIM] += change[n];
            largest_change = fmax(largest_change, fabs(h*change[n]));
            largest_increment = fmax(largest_increment, fabs(h*k[n/DIM][n % DIM]));
            solvable &= change[n] - change[n] == 0.0;
        }
        /* rounding errors, multiplied by a large Jacobian, may prevent closer agreement */
        const double relative = largest_change/(largest + largest_increment + TINY);
        const double rounding = TOLERANCE*(100 + steepest);
        if (solvable
                && (relative <= TOLERANCE || (relative < rounding && relative >= previous/2))) {
            return iteration;
        }
        previous = relative;
    }
    for (int n = 0; n < UNKNOWNS; n++) {
        k[n/DIM][n % DIM] = NAN;
    }
    return iteration;
}
