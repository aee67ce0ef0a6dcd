"""Kicks and drifts as in leapfrog: order 4, 7 stages; the last is the next step's first.

S. Blanes and P. C. Moan, Journal of Computational and Applied Mathematics 142 (2002) 313-330, table
3, SRKN6b, of which the order conditions complete the decimals. For forces of positions only.
"""

from solvers.runge_kutta.tableau import Splitting

tableau = Splitting.symmetric(
    "Blanes-Moan, order 4",
    kicks="""0.082984406417404872918965625343 0.396309801498368
        -0.039056304922348395277282286767 0.119524194013151044716633322847""",
    drifts="0.245298957184271 0.604872665711080 -0.350171622895351",
)
