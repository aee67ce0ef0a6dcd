/* The right-hand side of a chain of N pendulums as a textbook has it, written by hand:
   M_ij = mu l_i l_j cos(theta_i - theta_j) with mu the mass below both joints, then L D L^T. */
#include <math.h>

static void textbook(const double *y, double *dy, const double *params)
{
    const double *m = params, *l = params + N, g = params[2*N];
    double s[N], c[N], mass_below[N], M[N][N], f[N], d[N];
    double sum = 0.0;
    for (int i = N - 1; i >= 0; i--) {
        sum += m[i];
        mass_below[i] = sum;
        s[i] = sin(y[i]);
        c[i] = cos(y[i]);
        f[i] = -sum*g*l[i]*s[i];
    }
    for (int i = 0; i < N; i++) {
        for (int j = 0; j <= i; j++) {
            const double k = mass_below[i]*l[i]*l[j];
            const double turn = k*(s[i]*c[j] - c[i]*s[j]);
            M[i][j] = k*(c[i]*c[j] + s[i]*s[j]);
            f[i] -= turn*y[N + j]*y[N + j];
            f[j] += turn*y[N + i]*y[N + i];
        }
    }
    for (int j = 0; j < N; j++) {
        double scaled[N];
        d[j] = M[j][j];
        for (int k = 0; k < j; k++) {
            scaled[k] = M[j][k]*d[k];
            d[j] -= M[j][k]*scaled[k];
        }
        for (int i = j + 1; i < N; i++) {
            for (int k = 0; k < j; k++) {
                M[i][j] -= M[i][k]*scaled[k];
            }
            M[i][j] /= d[j];
        }
    }
    for (int i = 0; i < N; i++) {
        for (int k = 0; k < i; k++) {
            f[i] -= M[i][k]*f[k];
        }
    }
    for (int i = 0; i < N; i++) {
        f[i] /= d[i];
    }
    for (int i = N - 1; i >= 0; i--) {
        for (int k = i + 1; k < N; k++) {
            f[i] -= M[k][i]*f[k];
        }
    }
    for (int i = 0; i < N; i++) {
        dy[i] = y[N + i];
        dy[N + i] = f[i];
    }
}
