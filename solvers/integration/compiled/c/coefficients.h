/* Coefficients of an implicit method; of one with fewer than STAGES stages the first ones count.

   With A = T M T^-1, where M has blocks of size 1 and 2 for real eigenvalues and pairs of complex
   ones, a matrix I - h A (x) J falls apart into matrices I - h M_b (x) J (E. Hairer, G. Wanner,
   Solving Ordinary Differential Equations II, section IV.8). The stages contain A itself: T and M
   decide only how fast the iteration converges. */

typedef struct {
    int stages, blocks, block_sizes[STAGES];
    double A[STAGES][STAGES], T[STAGES][STAGES], T_inverse[STAGES][STAGES], M[STAGES][STAGES];
    double b[STAGES], c[STAGES];
    double lagrange[STAGES];    /* reciprocal denominators of the Lagrange polynomials of the nodes,
                                   0 for nodes that coincide */
    double at_start[STAGES];    /* values of these polynomials at the start */
    double error_power;         /* see squared_error_norm() */
} Method;
