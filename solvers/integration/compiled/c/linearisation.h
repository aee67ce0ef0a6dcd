/* The Jacobian of a step, and the factors of the matrices of its blocks. */

enum { UNKNOWNS = STAGES*DIM };

/* The last linearisation of this thread: motions depend on its point, h and method only. */
typedef struct {
    int is_valid, is_regular;
    const Method *method;
    double t, h, z[DIM], params[PARAMETERS + 1];
    double jacobian[DIM*DIM], largest;
    double factors[FACTORS];
    int pivots[UNKNOWNS];
} Linearisation;
static __thread Linearisation linearisation;

/* Provide the Jacobian at a point, and the factors of all blocks; 0 if a block is singular. */
static int linearise(
    const Method *method, double t, const double *z, double h, const double *params)
{
    Linearisation *now = &linearisation;
    const size_t params_size = PARAMETERS*sizeof *params;
    const int is_same = now->is_valid && now->t == t && !memcmp(now->z, z, sizeof now->z)
        && !memcmp(now->params, params, params_size);
    if (!is_same) {
        JACOBIAN(t, z, params, now->jacobian);
        now->t = t;
        memcpy(now->z, z, sizeof now->z);
        memcpy(now->params, params, params_size);
        now->largest = 0.0;
        for (int n = 0; n < DIM*DIM; n++) {
            now->largest = lane_fmax(now->largest, fabs(now->jacobian[n]));
        }
    }
    if (is_same && now->h == h && now->method == method) {
        return now->is_regular;
    }
    now->h = h;
    now->method = method;
    now->is_valid = now->is_regular = 1;
    double *matrix = now->factors;
    for (int block = 0, first = 0; block < method->blocks; block++) {
        const int size = method->block_sizes[block], rows = size*DIM;
        for (int i = 0; i < rows; i++) {
            for (int j = 0; j < rows; j++) {
                const double weight = h*method->M[first + i/DIM][first + j/DIM];
                matrix[i*rows + j] = (i == j) - weight*now->jacobian[i % DIM*DIM + j % DIM];
            }
        }
        now->is_regular &= factorise(rows, matrix, now->pivots + first*DIM);
        matrix += rows*rows;
        first += size;
    }
    return now->is_regular;
}

/* Row i of `products` is the sum of `rows` with weights from row i of `matrix`. */
static inline void multiply(
    int count, const double (*matrix)[STAGES], int terms, const double (*rows)[DIM],
    double (*products)[DIM])
{
    for (int i = 0; i < count; i++) {
        for (int n = 0; n < DIM; n++) {
            double sum = 0.0;
            for (int j = 0; j < terms; j++) {
                sum += matrix[i][j]*rows[j][n];
            }
            products[i][n] = sum;
        }
    }
}

/* The change of k by a simplified iteration, in place of its residual. */
static void solve_blocks(const Method *method, double (*residual)[DIM])
{
    const int s = method->stages;
    double parts[STAGES][DIM];
    multiply(s, method->T_inverse, s, (const double (*)[DIM])residual, parts);
    const double *factors = linearisation.factors;
    for (int block = 0, first = 0; block < method->blocks; block++) {
        const int size = method->block_sizes[block];
        solve(size*DIM, factors, linearisation.pivots + first*DIM, parts[first]);
        factors += size*DIM*size*DIM;
        first += size;
    }
    multiply(s, method->T, s, (const double (*)[DIM])parts, residual);
}
