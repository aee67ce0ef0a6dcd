"""Kicks and drifts as in leapfrog: order 6, 12 stages; the last is the next step's first.

S. Blanes and P. C. Moan, Journal of Computational and Applied Mathematics 142 (2002) 313-330, table
3, SRKN11b, of which the order conditions complete the decimals. For forces of positions only.
"""

from solvers.runge_kutta.tableau import Splitting

kicks = """0.041464998518263129504849769539 0.198128671918067 -0.040006192104152522915696137858
    0.075253984301580209915423261136 -0.011511387420687795186320842767
    0.236669924786929978681743949950"""
drifts = """0.123229775946271757414208490321 0.290553797799558 -0.127049212625417
    -0.246331761062075376750230468890 0.357208872795928 0.204777054291469238672043957138"""
tableau = Splitting.symmetric("Blanes-Moan, order 6", kicks, drifts)
