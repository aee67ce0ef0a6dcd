/* Systems of linear equations by triangular factors with row exchanges, in place. */

/* Replace a matrix of n rows by its factors; 0 if it is singular. */
static inline int factorise(int n, double *matrix, int *pivots)
{
    for (int j = 0; j < n; j++) {
        int pivot = j;
        for (int i = j + 1; i < n; i++) {
            pivot = fabs(matrix[i*n + j]) > fabs(matrix[pivot*n + j]) ? i : pivot;
        }
        pivots[j] = pivot;
        if (!(fabs(matrix[pivot*n + j]) > 0)) {
            return 0;
        }
        for (int m = 0; m < n && pivot != j; m++) {
            const double upper = matrix[j*n + m];
            matrix[j*n + m] = matrix[pivot*n + m];
            matrix[pivot*n + m] = upper;
        }
        const double inverse = 1.0/matrix[j*n + j];
        for (int i = j + 1; i < n; i++) {
            const double multiplier = matrix[i*n + j] *= inverse;
            for (int m = j + 1; m < n; m++) {
                matrix[i*n + m] -= multiplier*matrix[j*n + m];
            }
        }
        matrix[j*n + j] = inverse;
    }
    return 1;
}

/* Replace the right-hand side x by the solution. */
static inline void solve(int n, const double *factors, const int *pivots, double *x)
{
    for (int j = 0; j < n; j++) {
        const double right = x[pivots[j]];
        x[pivots[j]] = x[j];
        x[j] = right;
    }
    for (int i = 1; i < n; i++) {
        for (int j = 0; j < i; j++) {
            x[i] -= factors[i*n + j]*x[j];
        }
    }
    for (int i = n - 1; i >= 0; i--) {
        for (int j = i + 1; j < n; j++) {
            x[i] -= factors[i*n + j]*x[j];
        }
        x[i] *= factors[i*n + i];
    }
}
