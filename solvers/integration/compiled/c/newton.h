/* The stages of an implicit method, in one lane.

   Before this file stand the coefficients A and C, and JACOBIAN, the derivative of RHS. */

enum { UNKNOWNS = STAGES*STATE, MOST_ROUNDS = 100 };

/* The iteration ends when a change is this small beside the state; numbers that are not much
   larger than FAINT have fewer digits than others. */
static const double CLOSE = 1e-14, FAINT = 1e-290;

/* Replace a matrix by its triangular factors, with row exchanges; 0 if it is singular. */
static int factorise(double (*matrix)[UNKNOWNS], int *exchanged)
{
    for (int j = 0; j < UNKNOWNS; j++) {
        int pivot = j;
        for (int i = j + 1; i < UNKNOWNS; i++) {
            pivot = fabs(matrix[i][j]) > fabs(matrix[pivot][j]) ? i : pivot;
        }
        exchanged[j] = pivot;
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

static void solve(double (*factors)[UNKNOWNS], const int *exchanged, double *x)
{
    for (int j = 0; j < UNKNOWNS; j++) {
        const double right = x[exchanged[j]];
        x[exchanged[j]] = x[j];
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

/* Slopes k of all stages, which begin as guesses: by simplified Newton iteration, with the Jacobian
   at the beginning of the step (E. Hairer, G. Wanner, Solving Ordinary Differential Equations II,
   section IV.8). Returns the number of rounds; slopes that were not found are NaN. */
static double stages(
    double t, const double *z, double h, double (*k)[STATE], const double *params)
{
    double jacobian[STATE*STATE], matrix[UNKNOWNS][UNKNOWNS], change[UNKNOWNS];
    int exchanged[UNKNOWNS], round = 0;
    double largest = 0.0, steepest = 0.0, previous = INFINITY;
    JACOBIAN(t, z, params, jacobian);
    for (int n = 0; n < STATE*STATE; n++) {
        steepest = fmax(steepest, fabs(h*jacobian[n]));
    }
    for (int i = 0; i < UNKNOWNS; i++) {
        for (int j = 0; j < UNKNOWNS; j++) {
            matrix[i][j] =
                (i == j) - h*A[i/STATE][j/STATE]*jacobian[i % STATE*STATE + j % STATE];
        }
    }
    for (int n = 0; n < STATE; n++) {
        largest = fmax(largest, fabs(z[n]));
    }
    int solvable = factorise(matrix, exchanged);
    while (solvable && round < MOST_ROUNDS) {
        round++;
        for (int i = 0; i < STAGES; i++) {
            double place[STATE];
            for (int n = 0; n < STATE; n++) {
                double sum = 0.0;
                for (int j = 0; j < STAGES; j++) {
                    sum += A[i][j]*k[j][n];
                }
                place[n] = z[n] + h*sum;
            }
            RHS(t + C[i]*h, place, params, change + i*STATE);
        }
        for (int n = 0; n < UNKNOWNS; n++) {
            change[n] -= k[n/STATE][n % STATE];
        }
        solve(matrix, exchanged, change);
        double moved = 0.0, travelled = 0.0;
        for (int n = 0; n < UNKNOWNS; n++) {
            k[n/STATE][n % STATE] += change[n];
            moved = fmax(moved, fabs(h*change[n]));
            travelled = fmax(travelled, fabs(h*k[n/STATE][n % STATE]));
            solvable &= change[n] - change[n] == 0.0;
        }
        /* rounding, which a steep slope multiplies, may keep it from getting closer */
        const double size = moved/(largest + travelled + FAINT);
        if (solvable && (size <= CLOSE || (size < CLOSE*(100 + steepest) && size >= previous/2))) {
            return round;
        }
        previous = size;
    }
    for (int n = 0; n < UNKNOWNS; n++) {
        k[n/STATE][n % STATE] = NAN;
    }
    return round;
}
