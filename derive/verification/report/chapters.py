"""Equations (1) to (90) of chapters 1 to 3, as printed."""

from derive.verification.report.equation import Equation, fourth_order_rule

HAMILTON = "pdot_i = -d(H, q_i); qdot_i = d(H, p_i); -d(L, t) = d(H, t)"
LAGRANGIAN = (
    "L = 1/2*(m1 + m2)*l1**2*theta1_dot**2 + 1/2*m2*l2**2*theta2_dot**2"
    " + m2*l1*l2*theta1_dot*theta2_dot*cos(theta1 - theta2)"
    " + (m1 + m2)*g*l1*cos(theta1) + m2*g*l2*cos(theta2)"
)
MOMENTUM_1 = (
    "p_theta1 = d(L, theta1_dot)"
    " = (m1 + m2)*l1**2*theta1_dot + m2*l1*l2*theta2_dot*cos(theta1 - theta2)"
)
MOMENTUM_2 = (
    "p_theta2 = d(L, theta2_dot) = m2*l2**2*theta2_dot + m2*l1*l2*theta1_dot*cos(theta1 - theta2)"
)

EQUATIONS: tuple[Equation, ...] = (
    Equation("eq1", "ddt(d(L, qdot_i)) - d(L, q_i) = 0", measure="E_i"),
    Equation("eq2", "w_0 = alpha", exempt="definition", note="the initial value"),
    Equation("eq3", "w_next = w_i + 1/6*(m_1 + 2*m_2 + 2*m_3 + m_4)", system="method",
             using=("eq21", "eq22", "eq23", "eq24"),
             note="judged with the stages (21) to (24), which stand later in the text"),
    Equation("eq4", "-d(L, t) = d(H, t)",
             note="judged with a gravity that changes in time; else both sides are 0"),
    Equation("eq5", "ddt(d(L, theta1_dot)) = d(L, theta1)", measure="E1"),
    Equation("eq6", "theta_ddot + g/l*sin(theta) = 0", measure="E/(m*l**2)", system="single"),
    Equation("eq7", "theta_ddot + g/l*theta = 0", system="single",
             measure="theta_ddot + stiffness*theta/I",
             note="judged against the linearised derivation"),
    Equation("eq8", "theta = theta0*cos(omega*t + psi)", system="single",
             check="I*d(d(theta, t), t) + stiffness*theta = 0; "
                   "at(theta, t, -psi/omega) = theta0; at(theta, t, (pi/2 - psi)/omega) = 0",
             note="with omega = sqrt(g/l), as the next line of the report says"),
    Equation("eq9", "v = 0", changes=(("v = 0", "z = 0"),), system="single",
             note="the speed of a swinging bob is not 0; its third coordinate is"),
    Equation("eq10", "norm(r) = l", system="single"),
    Equation("eq11", "r = l*(sin(theta), cos(theta), 0)", system="single",
             note="y points downwards here, upwards from (47) on"),
    Equation("eq12", "F = T*(-r)/norm(r) + m*g_vector = -T/l*r + m*g_vector", system="single",
             note="F is mass times acceleration of the motion, T its projection on the rod"),
    Equation("eq13", "r1 = l1*(sin(theta1), cos(theta2), 0)",
             changes=(("cos(theta2)", "cos(theta1)"),)),
    Equation("eq14", "r2 = r1 + l2*(sin(theta2), cos(theta2), 0)",
             note="with r1 as corrected in (13)"),
    Equation("eq15",
             "F1 = T1*(-r1)/norm(r1) + T2*(r2 - r1)/norm(r2 - r1) + m1*g_vector"
             " = -T1/l1*r1 + T2/l2*(r2 - r1) + m1*g_vector"),
    Equation("eq16",
             "F2 = T2*(-(r2 - r1))/norm(r2 - r1) + m2*g_vector"
             " = -T2/l2*(r2 - r1) + m2*g_vector"),
    Equation("eq17", "L = K - P"),
    Equation("eq18", "ddt(d(L, qdot_i)) - d(L, q_i) = 0", measure="E_i"),
    Equation("eq19", "y' = f(t, y), y(t_0) = alpha", exempt="definition",
             note="the initial value problem"),
    *fourth_order_rule(20),
    Equation("eq26", HAMILTON),
    Equation("eq27", "Ixx*omega_x_dot + (Izz - Iyy)*omega_y*omega_x = tau_x", system="rigid",
             changes=(("omega_y*omega_x", "omega_y*omega_z"),)),
    Equation("eq28", "Iyy*omega_y_dot + (Ixx - Izz)*omega_z*omega_y = tau_y", system="rigid",
             changes=(("omega_z*omega_y", "omega_z*omega_x"),)),
    Equation("eq29", "Izz*omega_z_dot + (Iyy - Ixx)*omega_x*omega_z = tau_z", system="rigid",
             changes=(("omega_x*omega_z", "omega_x*omega_y"),)),
    Equation("eq30", "u_t + u.grad(u) + grad(p) = 0", exempt="context",
           note="a field equation of an inviscid fluid: no positions of masses lead to it"),
    Equation("eq31", "div(u) = 0", exempt="context",
           note="incompressibility of a fluid: no positions of masses lead to it"),
    Equation("eq32", "ddt(d(L, theta1)) = d(L, theta1)",
             changes=(("ddt(d(L, theta1))", "ddt(d(L, theta1_dot))"),),
             note="the dot over the left angle is missing"),
    Equation("eq33",
             "l1*((m1 + m2)*l1*theta1_ddot + m2*l2*cos(theta1 - theta2)*theta2_ddot"
             " + m2*l2*sin(theta1 - theta2)*theta2_dot**2 + (m1 + m2)*g*sin(theta1)) = 0",
             measure="E1", note="printed without '= 0'"),
    Equation("eq34",
             "m2*l2*(l2*theta2_ddot + l1*cos(theta1 - theta2)*theta1_ddot"
             " - l1*sin(theta1 - theta2)*theta1_dot**2 + g*sin(theta2)) = 0", measure="E2"),
    Equation("eq35", "L = K - P"),
    *fourth_order_rule(36),
    Equation("eq42", "pdot_i = -d(H, q_i)"),
    Equation("eq43", "qdot_i = d(H, p_i)"),
    Equation("eq44", "-d(L, t) = d(H, t)"),
    Equation("eq45", "ddt(d(L, qdot_i)) - d(L, q_i) = 0", measure="E_i"),
    Equation("eq46", "ddt(d(L, theta1_dot)) = d(L, theta1)", measure="E1"),
    Equation("eq47", "x1 = l1*sin(theta1)"),
    Equation("eq48", "y1 = -l1*cos(theta1)"),
    Equation("eq49", "x2 = l1*sin(theta1) + l2*sin(theta2)"),
    Equation("eq50", "y2 = -l1*cos(theta1) - l2*cos(theta2)"),
    Equation("eq51", "x1_dot = l1*theta1_dot*cos(theta1)"),
    Equation("eq52", "y1_dot = l1*theta1_dot*sin(theta1)"),
    Equation("eq53", "x2_dot = l1*theta1_dot*cos(theta1) + l2*theta2_dot*cos(theta2)"),
    Equation("eq54", "y2_dot = l1*theta1_dot*sin(theta1) + l2*theta2_dot*sin(theta2)"),
    Equation("eq55",
             "K = 1/2*m1*l1**2*theta1_dot**2 + 1/2*m2*(l1**2*theta1_dot**2 + l2**2*theta2_dot**2"
             " + 2*l1*l2*theta1_dot*theta2_dot*cos(theta1 - theta2))"),
    Equation("eq56", "P = -(m1 + m2)*g*l1*cos(theta1) - m2*g*l2*cos(theta2)"),
    Equation("eq57", LAGRANGIAN),
    Equation("eq58", MOMENTUM_1),
    Equation("eq59", MOMENTUM_2),
    Equation("eq60", "pdot_i = -d(H, q_i)"),
    Equation("eq61", "qdot_i = d(H, p_i)"),
    Equation("eq62", "-d(L, t) = d(H, t)"),
    Equation("eq63",
             "ddt(d(L, thetadot_i)) - d(L, theta_i) = 0; ddt(p_theta_i) - d(L, theta_i) = 0",
             measure="E_i"),
    Equation("eq64",
             "(m1 + m2)*l1*phi1_ddot + m2*l2*phi2_ddot*cos(phi1 - phi2)"
             " + m2*l2*phi1_dot**2*sin(phi1 - phi2) + (m1 + m2)*g*sin(phi1) = 0",
             changes=(("phi1_dot**2", "phi2_dot**2"),),
             measure="E1/l1", note="(33) has the right index"),
    Equation("eq65",
             "l1*phi2_ddot + l1*phi1_ddot*cos(phi1 - phi2) - l1*phi1_dot**2*sin(phi1 - phi2)"
             " + g*sin(phi2) = 0",
             changes=(("l1*phi2_ddot", "l2*phi2_ddot"),),
             measure="E2/(m2*l2)", note="(34) has the right length"),
    Equation("eq66", "phi1_ddot + alpha1*phi2_ddot = f1", using=("eq101", "eq103"),
             measure="E1/((m1 + m2)*l1**2)"),
    Equation("eq67", "phi2_ddot + alpha2*phi1_ddot = f2", using=("eq102", "eq104"),
             measure="E2/(m2*l2**2)"),
    Equation("eq68",
             "A*(phi1_ddot, phi2_ddot) = [[1, alpha1], [alpha2, 1]]*(phi1_ddot, phi2_ddot)"
             " = (f1, f2)", using=("eq101", "eq102", "eq103", "eq104")),
    Equation("eq69", "inverse(A) = 1/det(A)*[[1, alpha1], [alpha2, 1]]",
             changes=(("[[1, alpha1], [alpha2, 1]]", "[[1, -alpha1], [-alpha2, 1]]"),),
             using=("eq101", "eq102"), note="two signs are missing; (70) has them"),
    Equation("eq70",
             "(phi1_ddot, phi2_ddot)"
             " = 1/(1 - alpha1*alpha2)*(f1 - alpha1*f2, -alpha2*f1 + f2)",
             using=("eq101", "eq102", "eq103", "eq104")),
    Equation("eq71", "ddt((phi1, phi2, omega1, omega2)) = (chi1, chi2, g1, g2)",
             changes=(("(chi1, chi2,", "(omega1, omega2,"),),
             using=("eq101", "eq102", "eq103", "eq104", "A14"),
             note="the sentence before it lets omega be the velocity; chi is not defined"),
    Equation("eq72", LAGRANGIAN),
    Equation("eq73", MOMENTUM_1),
    Equation("eq74", MOMENTUM_2),
    Equation("eq75", "H = theta1_dot*P_theta1 + theta2_dot*P_theta2 - L"),
    Equation("eq76", "thetadot_i = d(H, P_theta_i); Pdot_theta_i = -d(H, theta_i)"),
    Equation("eq77", "(P_theta1, P_theta2) = B*(theta1_dot, theta2_dot)"),
    Equation("eq78",
             "B = P*[[(m1 + m2)*l1**2, m2*l1*l2*cos(theta1 - theta2)],"
             " [m2*l1*l2*cos(theta1 - theta2), m2*l2**2]]",
             changes=(("P*[[", "[["),),
             stray="P", note="printed 'P (...)' for 'B = (...)'; (116) is right"),
    Equation("eq79", "P*(theta1_dot, theta2_dot) = inverse(B)*(P_theta1, P_theta2)",
             changes=(("P*(theta1_dot", "(theta1_dot"),),
             stray="P", note="a P too many"),
    Equation("eq80",
             "theta1_dot = (l2*P_theta1 - l1*P_theta2*cos(theta1 - theta2))"
             "/(l1**2*l2*(m1 + m2*sin(theta1 - theta2)**2))"),
    Equation("eq81",
             "theta2_dot = (-m2*l2*P_theta1 - l1*P_theta2*cos(theta1 - theta2)"
             " + (m1 + m2)*l1*P_theta2)/(m2*l1*l2**2*(m1 + m2*sin(theta1 - theta2)**2))",
             changes=((" - l1*P_theta2*cos(", "*cos("),),
             note="the line under (120) has the right form"),
    Equation("eq82",
             "H = (m2*l2**2*P_theta1**2 + (m1 + m2)*l1**2*P_theta2**2"
             " - 2*m2*l1*l2*P_theta1*P_theta2*cos(theta1 - theta2))"
             "/(2*m2*l1**2*l2**2*(m1 + m2*sin(theta1 - theta2)**2))"
             " - (m1 + m2)*g*l1*cos(theta1) - m2*g*l2*cos(theta2)"),
    Equation("eq83",
             "h1 = P_theta1*P_theta2*sin(theta1 - theta2)"
             "/(l1*l2*(m1 + m2*sin(theta1 - theta2)**2))",
             check="Pdot_theta1 = -(m1 + m2)*g*l1*sin(theta1) - h1 + h2*sin(2*(theta1 - theta2))",
             using=("eq84",)),
    Equation("eq84",
             "h2 = (m2*l2**2*P_theta1**2 + (m1 + m2)*l1**2*P_theta2**2"
             " - 2*m2*l1*l2*P_theta1*P_theta2*cos(theta1 - theta2))"
             "/(2*l1**2*l2**2*(m1 + m2*sin(theta1 - theta2)**2)**2)",
             check="Pdot_theta2 = -m2*g*l2*sin(theta2) + h1 - h2*sin(2*(theta1 - theta2))",
             using=("eq83",)),
    *fourth_order_rule(85),
)  # fmt: skip
