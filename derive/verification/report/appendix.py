"""Equations (91) to (128) and the unnumbered displays of Appendix A, as printed."""

from derive.verification.report.chapters import LAGRANGIAN, MOMENTUM_1, MOMENTUM_2
from derive.verification.report.equation import Equation, fourth_order_rule

EQUATIONS: tuple[Equation, ...] = (
    Equation("A1", "x1 = l1*sin(theta1)"),
    Equation("A2", "y1 = -l1*cos(theta1)"),
    Equation("A3", "x2 = l1*sin(theta1) + l2*sin(theta2)"),
    Equation("A4", "y2 = -l1*cos(theta1) - l2*cos(theta2)"),
    Equation("A5", "x1_dot = l1*theta1_dot*cos(theta1)"),
    Equation("A6", "y1_dot = l1*theta1_dot*sin(theta1)"),
    Equation("A7", "x2_dot = l1*theta1_dot*cos(theta1) + l2*theta2_dot*cos(theta2)"),
    Equation("A8", "y2_dot = l1*theta1_dot*sin(theta1) + l2*theta2_dot*sin(theta2)"),
    Equation("eq91",
             "K = 1/2*m1*(x1_dot**2 + y1_dot**2) + 1/2*m2*(x2_dot**2 + y2_dot**2)"
             " = 1/2*m1*l1**2*theta1_dot**2 + 1/2*m2*(l1**2*theta1_dot**2 + l2**2*theta2_dot**2"
             " + 2*l1*l2*theta1_dot*theta2_dot*cos(theta1 - theta2))",
             note="its first line, with v1 and v2, names the speeds of the second"),
    Equation("eq92",
             "P = m1*g*y1 + m2*g*y2"
             " = -m1*g*l1*cos(theta1) - m2*g*(l1*cos(theta1) + l2*cos(theta2))"
             " = -(m1 + m2)*g*l1*cos(theta1) - m2*g*l2*cos(theta2)"),
    Equation("eq93", LAGRANGIAN),
    Equation("eq94", MOMENTUM_1),
    Equation("eq95", MOMENTUM_2),
    Equation("eq96",
             "ddt(d(L, phidot_i)) - d(L, phi_i) = 0; ddt(p_phi_i) - d(L, phi_i) = 0",
             measure="E_i"),
    Equation("A9",
             "ddt(p_phi1) = (m1 + m2)*l1**2*phi1_ddot + m2*l1*l2*phi2_ddot*cos(phi1 - phi2)"
             " - m2*l1*l2*phi2_dot*phi1_dot*sin(phi1 - phi2)"
             " + m2*l1*l2*phi2_dot**2*sin(phi1 - phi2)", measure="0"),
    Equation("A10",
             "ddt(p_phi2) = m2*l2**2*phi2_ddot + m2*l1*l2*phi1_ddot*cos(phi1 - phi2)"
             " - m2*l1*l2*phi1_dot**2*phi1_dot*sin(phi1 - phi2)"
             " + m2*l1*l2*phi1_dot*phi2_dot*sin(phi1 - phi2)",
             changes=(("phi1_dot**2*phi1_dot*sin", "phi1_dot**2*sin"),),
             measure="0", note="a factor too many"),
    Equation("A11",
             "d(L, phi1) = -m2*l1*l2*phi1_dot*phi2_dot*sin(phi1 - phi2)"
             " - (m1 + m2)*g*l1*sin(phi1)", note="printed with d for the partial derivative"),
    Equation("A12",
             "d(L, phi2) = m2*l1*l2*phi1_dot*phi2_dot*sin(phi1 - phi2) - m2*g*l2*sin(phi2)",
             note="printed with d for the partial derivative"),
    Equation("eq97",
             "(m1 + m2)*l1*phi1_ddot + m2*l2*phi2_ddot*cos(phi1 - phi2)"
             " + m2*l2*phi1_dot**2*sin(phi1 - phi2) + (m1 + m2)*g*sin(phi1) = 0",
             changes=(("phi1_dot**2", "phi2_dot**2"),),
             measure="E1/l1", note="as (64); the displays above it give the right index"),
    Equation("eq98",
             "l1*phi2_ddot + l1*phi1_dot*cos(phi1 - phi2) - l1*phi1_dot**2*sin(phi1 - phi2)"
             " + g*sin(phi2) = 0",
             changes=(("l1*phi2_ddot", "l2*phi2_ddot"),
                      ("phi1_dot*cos", "phi1_ddot*cos")),
             measure="E2/(m2*l2)", note="two slips: l1 for l2, and a dot missing over phi1"),
    Equation("eq99", "phi1_ddot + alpha1*phi2_ddot = f1", using=("eq101", "eq103"),
             measure="E1/((m1 + m2)*l1**2)"),
    Equation("eq100", "phi2_ddot + alpha2*phi1_ddot = f2", using=("eq102", "eq104"),
             measure="E2/(m2*l2**2)"),
    Equation("eq101", "alpha1 = l2/l1*(m2/(m1 + m2))*cos(phi1 - phi2)", using=("eq103",),
             note="printed with a colon for =",
             check="phi1_ddot + alpha1*phi2_ddot - f1 = E1/((m1 + m2)*l1**2)"),
    Equation("eq102", "alpha2 = l1/l2*cos(phi1 - phi2)", using=("eq104",),
             note="printed with a colon for =",
             check="phi2_ddot + alpha2*phi1_ddot - f2 = E2/(m2*l2**2)"),
    Equation("eq103",
             "f1 = -l2/l1*(m2/(m1 + m2))*phi2_dot**2*sin(phi1 - phi2) - g/l1*sin(phi1)",
             using=("eq101",),
             check="phi1_ddot + alpha1*phi2_ddot - f1 = E1/((m1 + m2)*l1**2)"),
    Equation("eq104", "f2 = l1/l2*phi1_dot**2*sin(phi1 - phi2) - g/l2*sin(phi2)",
             using=("eq102",),
             check="phi2_ddot + alpha2*phi1_ddot - f2 = E2/(m2*l2**2)"),
    Equation("eq105",
             "A*(phi1_ddot, phi2_ddot) = [[1, phi1_ddot], [phi2_ddot, 1]]*(phi1_dot, phi2_dot)"
             " = (f1, f2)",
             changes=(("[[1, phi1_ddot], [phi2_ddot, 1]]*(phi1_dot, phi2_dot)",
                       "[[1, alpha1], [alpha2, 1]]*(phi1_ddot, phi2_ddot)"),),
             using=("eq101", "eq102", "eq103", "eq104"),
             note="accelerations stand where alpha belongs; (68) is right"),
    Equation("eq106",
             "inverse(A) = 1/det(A)*[[1, phi1_ddot], [phi2_ddot, 1]]"
             " = 1/(1 - alpha1*alpha2)*[[1, -phi1_ddot], [-phi2_ddot, 1]]",
             changes=(("[[1, phi1_ddot], [phi2_ddot, 1]]", "[[1, -alpha1], [-alpha2, 1]]"),
                      ("[[1, -phi1_ddot], [-phi2_ddot, 1]]", "[[1, -alpha1], [-alpha2, 1]]")),
             using=("eq101", "eq102"),
             note="accelerations stand where alpha belongs, and two signs are missing"),
    Equation("eq107",
             "det(A) = 1 - alpha1*alpha2 = 1 - (m2/(m1 + m2))*cos(phi1 - phi2)**2 > 0",
             using=("eq101", "eq102")),
    Equation("A13", "m2/(m1 + m2) < 1; cos(phi1 - phi2)**2 <= 1",
             check="1 - left_1*left_2 = det(A)",
             note="the reason for (107), with x = phi1 - phi2"),
    Equation("eq108",
             "(phi1_ddot, phi2_ddot) = inverse(A)*(f1, f2)"
             " = 1/(1 - alpha1*alpha2)*(f1 - alpha1*f2, -alpha2*f1 + f2)",
             using=("eq101", "eq102", "eq103", "eq104")),
    Equation("eq109", "ddt((phi1, phi2, omega1, omega2)) = (omega1, omega2, g1, g2)",
             using=("eq101", "eq102", "eq103", "eq104", "A14")),
    Equation("A14",
             "g1 = (f1 - alpha1*f2)/(1 - alpha1*alpha2);"
             " g2 = (-alpha2*f1 + f2)/(1 - alpha1*alpha2)",
             check="phi1_ddot = g1; phi2_ddot = g2",
             using=("eq101", "eq102", "eq103", "eq104")),
    Equation("A15", "alpha_i = (phi1, phi2)",
             changes=(("(phi1, phi2)", "only(alpha_i, phi1, phi2)"),),
             using=("eq101", "eq102"),
             note="the function's name is missing: alpha_i depends on phi1 and phi2 alone"),
    Equation("A16", "f_1 = only(f_i, phi1, phi2, omega1, omega2)",
             changes=(("f_1 =", "f_i ="),),
             using=("eq103", "eq104"), note="the left index should be i"),
    Equation("eq110", LAGRANGIAN),
    Equation("eq111", MOMENTUM_1),
    Equation("eq112", MOMENTUM_2),
    Equation("eq113", "H = theta1_dot*P_theta1 + theta2_dot*P_theta2 - L"),
    Equation("eq114", "thetadot_i = d(H, P_theta_i); P_theta_i = -d(H, theta_i)",
             changes=(("; P_theta_i =", "; Pdot_theta_i ="),),
             note="the dot over the momentum is missing; (76) has it"),
    Equation("eq115", "(P_theta1, P_theta2) = B*(theta1_dot, theta2_dot)"),
    Equation("eq116",
             "B = [[(m1 + m2)*l1**2, m2*l1*l2*cos(theta1 - theta2)],"
             " [m2*l1*l2*cos(theta1 - theta2), m2*l2**2]]"),
    Equation("eq117", "P*(theta1_dot, theta2_dot) = inverse(B)*(P_theta1, P_theta2)",
             changes=(("P*(theta1_dot", "(theta1_dot"),),
             stray="P", note="a P too many"),
    Equation("A17",
             "det(B) = m1*m2*l1**2*l2**2 + m2**2*l1**2*l2**2*(1 - cos(theta1 - theta2)**2)"
             " = m1*m2*l1**2*l2**2 + m2**2*l1**2*l2**2*sin(theta1 - theta2)**2"
             " >= m1*m2*l1**2*l2**2"),
    Equation("A18",
             "inverse(B) = 1/det(B)*[[m2*l2**2, -m2*l1*l2*cos(theta1 - theta2)],"
             " [-m2*l1*l2*cos(theta1 - theta2), (m1 + m2)*l1**2]]"),
    Equation("eq118",
             "theta1_dot = (l2*P_theta1 - l1*P_theta2*cos(theta1 - theta2))"
             "/(l1**2*l2*(m1 + m2*sin(theta1 - theta2)**2))"),
    Equation("eq119",
             "theta2_dot = (-m2*l2*P_theta1 - l1*P_theta2*cos(theta1 - theta2)"
             " + (m1 + m2)*l1*P_theta2)/(m2*l1*l2**2*(m1 + m2*sin(theta1 - theta2)**2))",
             changes=((" - l1*P_theta2*cos(", "*cos("),),
             note="as (81); the line under (120) has the right form"),
    Equation("eq120",
             "H = (m2*l2**2*P_theta1**2 + (m1 + m2)*l1**2*P_theta2**2"
             " - 2*m2*l1*l2*P_theta1*P_theta2*cos(theta1 - theta2))"
             "/(2*m2*l1**2*l2**2*(m1 + m2*sin(theta1 - theta2)**2))"
             " - (m1 + m2)*g*l1*cos(theta1) - m2*g*l2*cos(theta2)"),
    Equation("A19",
             "theta1_dot = d(H, P_theta1) = (l2*P_theta1 - l1*P_theta2*cos(theta1 - theta2))"
             "/(l1**2*l2*(m1 + m2*sin(theta1 - theta2)**2))"),
    Equation("A20",
             "theta2_dot = d(H, P_theta2)"
             " = (-m2*l2*P_theta1*cos(theta1 - theta2) + (m1 + m2)*l1*P_theta2)"
             "/(m2*l1*l2**2*(m1 + m2*sin(theta1 - theta2)**2))"),
    Equation("A21",
             "Pdot_theta1 = -d(H, theta1)"
             " = -(m1 + m2)*g*l1*sin(theta1) - h1 + h2*sin(2*(theta1 - theta2))",
             using=("eq121", "eq122")),
    Equation("A22",
             "Pdot_theta2 = -d(H, theta2)"
             " = -m2*g*l2*sin(theta2) + h1 - h2*sin(2*(theta1 - theta2))",
             using=("eq121", "eq122")),
    Equation("eq121",
             "h1 = P_theta1*P_theta2*sin(theta1 - theta2)"
             "/(l1*l2*(m1 + m2*sin(theta1 - theta2)**2))",
             check="Pdot_theta1 = -(m1 + m2)*g*l1*sin(theta1) - h1 + h2*sin(2*(theta1 - theta2))",
             using=("eq122",)),
    Equation("eq122",
             "h2 = (m2*l2**2*P_theta1**2 + (m1 + m2)*l1**2*P_theta2**2"
             " - 2*m2*l1*l2*P_theta1*P_theta2*cos(theta1 - theta2))"
             "/(2*l1**2*l2**2*(m1 + m2*sin(theta1 - theta2)**2)**2)",
             check="Pdot_theta2 = -m2*g*l2*sin(theta2) + h1 - h2*sin(2*(theta1 - theta2))",
             using=("eq121",)),
    *fourth_order_rule(123),
)  # fmt: skip
