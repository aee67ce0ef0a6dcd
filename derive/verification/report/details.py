"""What the report's text does not state: meanings of equations, and corrections of misprints."""

from collections.abc import Iterator
from dataclasses import replace

from derive.verification.report.equation import Details

FIRST_ROW = "E1/((m1 + m2)*l1**2)"
SECOND_ROW = "E2/(m2*l2**2)"
MATRIX = ("eq101", "eq102", "eq103", "eq104")
RATE_1 = "P_theta1_dot = -(m1 + m2)*g*l1*sin(theta1) - h1 + h2*sin(2*(theta1 - theta2))"
RATE_2 = "P_theta2_dot = -m2*g*l2*sin(theta2) + h1 - h2*sin(2*(theta1 - theta2))"

LAGRANGE = Details(measure="E_i")
LAGRANGE_1 = Details(measure="E1")
SOLVED_1 = Details(measure=FIRST_ROW, using=("eq101", "eq103"))
SOLVED_2 = Details(measure=SECOND_ROW, using=("eq102", "eq104"))
INITIAL = Details(exempt="definition", note="the initial value")
WEIGHT = {"g": "g_vector"}
WRONG_INDEX = Details(measure="E1/l1", changes=((r"\dot{\phi}_1^2", r"\dot{\phi}_2^2"),))
EXTRA_FACTORS = Details(changes=((r" - \ell_1 P_{\theta_2} \cos(", r" \cos("),))
SUPERFLUOUS_P = Details(changes=((r"P \begin", r"\begin"),), stray="P", note="a P too many")
PARTIAL = Details(note="printed with d for the partial derivative")


def _methods() -> Iterator[tuple[str, Details]]:
    """The initial value and the five equations of the method, which are printed four times."""
    for first in (20, 36, 85, 123):
        yield f"eq{first}", INITIAL
        yield from ((f"eq{first + n}", Details(system="method")) for n in range(1, 6))


#: Details by id; other equations are judged along every motion of the double pendulum.
DETAILS: dict[str, Details] = dict(_methods()) | {
    "eq1": LAGRANGE,
    "eq2": INITIAL,
    "eq3": Details(
        system="method",
        using=("eq21", "eq22", "eq23", "eq24"),
        note="judged with the stages (21) to (24), which stand later in the text",
    ),
    "eq4": Details(note="judged with a gravity that changes in time; else both sides are 0"),
    "eq5": LAGRANGE_1,
    "eq6": Details(system="single", measure="E/(m*l**2)"),
    "eq7": Details(
        system="single",
        measure="theta_ddot + stiffness*theta/I",
        note="judged against the linearised derivation",
    ),
    "eq8": Details(
        system="single",
        check="I*d(d(theta, t), t) + stiffness*theta = 0; "
        "at(theta, t, -psi/omega) = theta0; at(theta, t, (pi/2 - psi)/omega) = 0",
        note="with omega = sqrt(g/l), as the next line of the report says",
    ),
    "eq9": Details(
        system="single",
        changes=(("v", "z"),),
        note="the speed of a swinging bob is not 0; its third coordinate is",
    ),
    "eq10": Details(system="single"),
    "eq11": Details(system="single", note="y points downwards here, upwards from (47) on"),
    "eq12": Details(
        system="single",
        letters=WEIGHT,
        note="F is mass times acceleration of the motion, T its projection on the rod",
    ),
    "eq13": Details(changes=((r"\cos \theta_2", r"\cos \theta_1"),)),
    "eq14": Details(note="with r1 as corrected in (13)"),
    "eq15": Details(letters=WEIGHT),
    "eq16": Details(letters=WEIGHT),
    "eq18": LAGRANGE,
    "eq19": Details(exempt="definition", note="the initial value problem"),
    "eq27": Details(system="rigid", changes=((r"\omega_y \omega_x", r"\omega_y \omega_z"),)),
    "eq28": Details(system="rigid", changes=((r"\omega_z \omega_y", r"\omega_z \omega_x"),)),
    "eq29": Details(system="rigid", changes=((r"\omega_x \omega_z", r"\omega_x \omega_y"),)),
    "eq30": Details(
        exempt="context",
        note="a field equation of an inviscid fluid: no positions of masses lead to it",
    ),
    "eq31": Details(
        exempt="context",
        note="incompressibility of a fluid: no positions of masses lead to it",
    ),
    "eq32": Details(
        changes=((r"\theta_1} \right", r"\dot{\theta}_1} \right"),),
        note="the dot over the left angle is missing",
    ),
    "eq33": Details(measure="E1", equation="{} = 0", note="printed without '= 0'"),
    "eq34": Details(measure="E2"),
    "eq45": LAGRANGE,
    "eq46": LAGRANGE_1,
    "eq63": LAGRANGE,
    "eq64": replace(WRONG_INDEX, note="(33) has the right index"),
    "eq65": Details(
        measure="E2/(m2*l2)",
        changes=((r"\ell_1\ddot{\phi}_2", r"\ell_2\ddot{\phi}_2"),),
        note="(34) has the right length",
    ),
    "eq66": SOLVED_1,
    "eq67": SOLVED_2,
    "eq68": Details(using=MATRIX),
    "eq69": Details(
        using=MATRIX[:2],
        changes=((r"1 & \alpha_1 \\ \alpha_2 & 1", r"1 & -\alpha_1 \\ -\alpha_2 & 1"),),
        note="two signs are missing; (70) has them",
    ),
    "eq70": Details(using=MATRIX),
    "eq71": Details(
        using=(*MATRIX, "A14"),
        changes=((r"\chi_1 \\ \chi_2", r"\omega_1 \\ \omega_2"),),
        note="the sentence before it lets omega be the velocity; chi is not defined",
    ),
    "eq78": Details(
        equation="B = {}",
        changes=((r"P \begin", r"\begin"),),
        stray="P",
        note="printed 'P (...)' for 'B = (...)'; (116) is right",
    ),
    "eq79": SUPERFLUOUS_P,
    "eq81": replace(EXTRA_FACTORS, note="the line under (120) has the right form"),
    "eq83": Details(check=RATE_1, using=("eq84",)),
    "eq84": Details(check=RATE_2, using=("eq83",)),
    "eq96": LAGRANGE,
    "A9": Details(measure="0"),
    "A10": Details(
        measure="0",
        changes=((r"\dot{\phi}_1^2 \dot{\phi}_1", r"\dot{\phi}_1^2"),),
        note="a factor too many",
    ),
    "A11": PARTIAL,
    "A12": PARTIAL,
    "eq97": replace(WRONG_INDEX, note="as (64); the displays above it give the right index"),
    "eq98": Details(
        measure="E2/(m2*l2)",
        changes=(
            (r"\ell_1\ddot{\phi}_2", r"\ell_2\ddot{\phi}_2"),
            (r"\dot{\phi}_1 \cos", r"\ddot{\phi}_1 \cos"),
        ),
        note="two slips: l1 for l2, and a dot missing over phi1",
    ),
    "eq99": SOLVED_1,
    "eq100": SOLVED_2,
    "eq101": Details(
        check=f"phi1_ddot + alpha1*phi2_ddot - f1 = {FIRST_ROW}",
        using=("eq103",),
        note="printed with a colon for =",
    ),
    "eq102": Details(
        check=f"phi2_ddot + alpha2*phi1_ddot - f2 = {SECOND_ROW}",
        using=("eq104",),
        note="printed with a colon for =",
    ),
    "eq103": Details(check=f"phi1_ddot + alpha1*phi2_ddot - f1 = {FIRST_ROW}", using=("eq101",)),
    "eq104": Details(check=f"phi2_ddot + alpha2*phi1_ddot - f2 = {SECOND_ROW}", using=("eq102",)),
    "eq105": Details(
        using=MATRIX,
        changes=(
            (
                r"1 & \ddot{\phi}_1 \\ \ddot{\phi}_2 & 1 \end{pmatrix}"
                r" \begin{pmatrix} \dot{\phi}_1 \\ \dot{\phi}_2",
                r"1 & \alpha_1 \\ \alpha_2 & 1 \end{pmatrix}"
                r" \begin{pmatrix} \ddot{\phi}_1 \\ \ddot{\phi}_2",
            ),
        ),
        note="accelerations stand where alpha belongs; (68) is right",
    ),
    "eq106": Details(
        using=MATRIX[:2],
        changes=(
            (r"1 & \ddot{\phi}_1 \\ \ddot{\phi}_2 & 1", r"1 & -\alpha_1 \\ -\alpha_2 & 1"),
            (r"1 & -\ddot{\phi}_1 \\ -\ddot{\phi}_2 & 1", r"1 & -\alpha_1 \\ -\alpha_2 & 1"),
        ),
        note="accelerations stand where alpha belongs, and two signs are missing",
    ),
    "eq107": Details(using=MATRIX[:2]),
    "A13": Details(
        letters={"x": "phi1 - phi2"},
        check="1 - left_1*left_2 = det(A)",
        note="the reason for (107), with x = phi1 - phi2",
    ),
    "eq108": Details(using=MATRIX),
    "eq109": Details(using=(*MATRIX, "A14")),
    "A14": Details(check="phi1_ddot = g1; phi2_ddot = g2", using=MATRIX),
    "A15": Details(
        using=MATRIX[:2],
        changes=((r"(\phi_1", r"\alpha_i(\phi_1"),),
        note="the function's name is missing: alpha_i depends on phi1 and phi2 alone",
    ),
    "A16": Details(using=MATRIX[2:], changes=(("f_1", "f_i"),), note="the left index should be i"),
    "eq114": Details(
        changes=((r"P_{\theta_i} = ", r"\dot{P}_{\theta_i} = "),),
        note="the dot over the momentum is missing; (76) has it",
    ),
    "eq117": SUPERFLUOUS_P,
    "eq119": replace(EXTRA_FACTORS, note="as (81); the line under (120) has the right form"),
    "A21": Details(using=("eq121", "eq122")),
    "A22": Details(using=("eq121", "eq122")),
    "eq121": Details(check=RATE_1, using=("eq122",)),
    "eq122": Details(check=RATE_2, using=("eq121",)),
}
