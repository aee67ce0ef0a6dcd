/* Two crossings of an event in a step at whose ends its value has the same sign.

   Values and derivatives at both ends give a cubic polynomial over the step; at its extremum the
   state of a shorter step decides. That value makes the polynomial one of degree 4, whose extremum
   is tried, too. */

enum { PROBES = 2 };

/* Whether the value x, with the change u of a step if its derivative stayed, may have another sign
   within a step that ends at y, with v. The tangents of a convex function cross beyond 0 then; of
   others, nearly. */
static inline mask may_dip(real x, real u, real y, real v)
{
    const real zero = splat(0.0);
    return less_than(x*u, zero) & less_than(zero, y*v) & less_than(zero, x*y)
        & less_than(v*x - u*y, -2.0*(u*v));
}

/* The part of the step at which the cubic polynomial is extreme. */
static double cubic_extremum(double x, double u, double y, double v)
{
    const double c = 3*(y - x) - 2*u - v, d = u + v - 2*(y - x);
    return -u/(c + copysign(sqrt(fmax(c*c - 3*d*u, 0)), v));
}

/* The same of the polynomial of degree 4 with the value w at a part p, by bisection. */
static double quartic_extremum(double x, double u, double y, double v, double p, double w)
{
    const double c = 3*(y - x) - 2*u - v, d = u + v - 2*(y - x), bump = p*(1 - p);
    const double e = (w - (x + p*(u + p*(c + p*d))))/(bump*bump);
    double begin = 0, end = 1;
    for (int k = 0; k < 40; k++) {
        const double q = 0.5*(begin + end);
        const double slope = u + q*(2*c + q*(3*d)) + 2*e*q*(1 - q)*(1 - 2*q);
        if ((slope < 0) == (u < 0)) {
            begin = q;
        } else {
            end = q;
        }
    }
    return 0.5*(begin + end);
}
