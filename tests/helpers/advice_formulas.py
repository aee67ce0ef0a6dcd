"""Correct formulas in the notations of textbooks, which the campaign of mutants starts from.

Each document is a file of `holonomic verify`; brackets, common factors, denominators and names
of the source occur in all of them.
"""

DOCUMENTS = (
    """
system = "single_pendulum"
kinetic_energy = "m*l**2*theta_dot**2/2"
potential_energy = "m*g*l*(1 - cos(theta))"
lagrangian = "m*(l**2*theta_dot**2/2 + g*l*cos(theta))"
energy = "m*l**2*theta_dot**2/2 - m*g*l*cos(theta)"
hamiltonian = "p_theta**2/(2*m*l**2) - m*g*l*cos(theta)"
euler_lagrange = [
"theta_ddot + g/l*sin(theta) = 0",
"m*l**2*theta_ddot = -m*g*l*sin(theta)",
"l*theta_ddot + g*sin(theta) = 0",
]
[hamilton]
theta = "p_theta/(m*l**2)"
p_theta = "-m*g*l*sin(theta)"
[momenta]
theta = "m*l**2*theta_dot"
[accelerations]
theta = "-g*sin(theta)/l"
""",
    '''
system = "double_pendulum"
kinetic_energy = """m1*l1**2*w1**2/2 + m2/2*(l1**2*w1**2 + l2**2*w2**2 \
+ 2*l1*l2*w1*w2*cos(theta1 - theta2))"""
potential_energy = "-m1*g*l1*cos(theta1) - m2*g*(l1*cos(theta1) + l2*cos(theta2))"
lagrangian = """(m1 + m2)/2*l1**2*w1**2 + m2/2*l2**2*w2**2 + m2*l1*l2*w1*w2*cos(theta1 - theta2) \
+ (m1 + m2)*g*l1*cos(theta1) + m2*g*l2*cos(theta2)"""
energy = """(m1 + m2)*(l1**2*w1**2/2 - g*l1*cos(theta1)) + m2*(l2**2*w2**2/2 \
+ l1*l2*w1*w2*cos(theta1 - theta2) - g*l2*cos(theta2))"""
hamiltonian = """(m2*l2**2*p_theta1**2 + (m1 + m2)*l1**2*p_theta2**2 \
- 2*m2*l1*l2*p_theta1*p_theta2*cos(theta1 - theta2))\
/(2*m2*l1**2*l2**2*(m1 + m2*sin(theta1 - theta2)**2)) \
- (m1 + m2)*g*l1*cos(theta1) - m2*g*l2*cos(theta2)"""
euler_lagrange = [
"""(m1 + m2)*l1*a1 + m2*l2*a2*cos(theta1 - theta2) + m2*l2*w2**2*sin(theta1 - theta2) \
+ (m1 + m2)*g*sin(theta1) = 0""",
"l2*a2 + l1*a1*cos(theta1 - theta2) - l1*w1**2*sin(theta1 - theta2) + g*sin(theta2) = 0",
"m2*l2*(l2*a2 + l1*(a1*cos(theta1 - theta2) - w1**2*sin(theta1 - theta2))) = -m2*g*l2*sin(theta2)",
]
[names]
w1 = "theta1_dot"
w2 = "theta2_dot"
a1 = "theta1_ddot"
a2 = "theta2_ddot"
[momenta]
theta1 = "(m1 + m2)*l1**2*w1 + m2*l1*l2*w2*cos(theta1 - theta2)"
theta2 = "m2*l2*(l2*w2 + l1*w1*cos(theta1 - theta2))"
[accelerations]
theta1 = """(-g*(2*m1 + m2)*sin(theta1) - m2*g*sin(theta1 - 2*theta2) - 2*sin(theta1 - theta2)*m2\
*(w2**2*l2 + w1**2*l1*cos(theta1 - theta2)))/(l1*(2*m1 + m2 - m2*cos(2*theta1 - 2*theta2)))"""
theta2 = """2*sin(theta1 - theta2)*(w1**2*l1*(m1 + m2) + g*(m1 + m2)*cos(theta1) \
+ w2**2*l2*m2*cos(theta1 - theta2))/(l2*(2*m1 + m2 - m2*cos(2*theta1 - 2*theta2)))"""
[hamilton]
theta1 = """(l2*p_theta1 - l1*p_theta2*cos(theta1 - theta2))\
/(l1**2*l2*(m1 + m2*sin(theta1 - theta2)**2))"""
''',
    '''
system = "double_pendulum"
lagrangian = """m*l**2*(phi1_dot**2 + phi2_dot**2/2 + phi1_dot*phi2_dot*cos(phi1 - phi2)) \
+ m*g*l*(2*cos(phi1) + cos(phi2))"""
euler_lagrange = [
"""2*phi1_ddot + phi2_ddot*cos(phi1 - phi2) + phi2_dot**2*sin(phi1 - phi2) + 2*g/l*sin(phi1) = 0""",
"phi2_ddot + phi1_ddot*cos(phi1 - phi2) - phi1_dot**2*sin(phi1 - phi2) = -g/l*sin(phi2)",
]
[equal]
m2 = "m1"
l2 = "l1"
[names]
phi1 = "theta1"
phi2 = "theta2"
m = "m1"
l = "l1"
''',
    '''
system = "double_bar_pendulum"
lagrangian = """m*l**2/6*(theta2_dot**2 + 4*theta1_dot**2 + 3*theta1_dot*theta2_dot\
*cos(theta1 - theta2)) + m*g*l/2*(3*cos(theta1) + cos(theta2))"""
[equal]
m2 = "m1"
l2 = "l1"
[names]
m = "m1"
l = "l1"
[momenta]
theta1 = "m*l**2*(8*theta1_dot + 3*theta2_dot*cos(theta1 - theta2))/6"
theta2 = "m*l**2/6*(2*theta2_dot + 3*theta1_dot*cos(theta1 - theta2))"
[hamilton]
theta1 = """6/(m*l**2)*(2*p_theta1 - 3*cos(theta1 - theta2)*p_theta2)\
/(16 - 9*cos(theta1 - theta2)**2)"""
theta2 = """6/(m*l**2)*(8*p_theta2 - 3*cos(theta1 - theta2)*p_theta1)\
/(16 - 9*cos(theta1 - theta2)**2)"""
''',
    '''
system = "cart_1"
kinetic_energy = "(M + m)*v**2/2 + m*l*v*theta_dot*cos(theta) + m*l**2*theta_dot**2/2"
potential_energy = "-m*g*l*cos(theta)"
lagrangian = """M*v**2/2 + m/2*((v + l*theta_dot*cos(theta))**2 + (l*theta_dot*sin(theta))**2) \
+ m*g*l*cos(theta)"""
energy = "(M + m)*v**2/2 + m*l*(v*theta_dot*cos(theta) + l*theta_dot**2/2 - g*cos(theta))"
euler_lagrange = [
"(M + m)*x_ddot + m*l*(theta_ddot*cos(theta) - theta_dot**2*sin(theta)) = 0",
"l*theta_ddot + x_ddot*cos(theta) + g*sin(theta) = 0",
]
[names]
M = "m0"
m = "m1"
l = "l1"
theta = "theta1"
v = "x_dot"
[momenta]
x = "(M + m)*v + m*l*theta_dot*cos(theta)"
theta = "m*l*(v*cos(theta) + l*theta_dot)"
[accelerations]
x = "m*sin(theta)*(l*theta_dot**2 + g*cos(theta))/(M + m*sin(theta)**2)"
theta = """-((M + m)*g*sin(theta) + m*l*theta_dot**2*sin(theta)*cos(theta))\
/(l*(M + m*sin(theta)**2))"""
''',
    '''
system = "cart_2"
kinetic_energy = """m0*x_dot**2/2 + m1/2*(x_dot**2 + 2*l1*x_dot*theta1_dot*cos(theta1) \
+ l1**2*theta1_dot**2) + m2/2*(x_dot**2 + l1**2*theta1_dot**2 + l2**2*theta2_dot**2 \
+ 2*x_dot*(l1*theta1_dot*cos(theta1) + l2*theta2_dot*cos(theta2)) \
+ 2*l1*l2*theta1_dot*theta2_dot*cos(theta1 - theta2))"""
euler_lagrange = [
"""(m0 + m1 + m2)*x_ddot + (m1 + m2)*l1*(theta1_ddot*cos(theta1) - theta1_dot**2*sin(theta1)) \
+ m2*l2*(theta2_ddot*cos(theta2) - theta2_dot**2*sin(theta2)) = 0""",
"""l2*theta2_ddot + x_ddot*cos(theta2) + l1*theta1_ddot*cos(theta1 - theta2) \
= l1*theta1_dot**2*sin(theta1 - theta2) - g*sin(theta2)""",
]
[momenta]
theta1 = """(m1 + m2)*l1*x_dot*cos(theta1) + (m1 + m2)*l1**2*theta1_dot \
+ m2*l1*l2*theta2_dot*cos(theta1 - theta2)"""
''',
    '''
system = "chain_3"
kinetic_energy = """m1*l1**2*theta1_dot**2/2 + m2*((l1*theta1_dot*cos(theta1) \
+ l2*theta2_dot*cos(theta2))**2 + (l1*theta1_dot*sin(theta1) + l2*theta2_dot*sin(theta2))**2)/2 \
+ m3*((l1*theta1_dot*cos(theta1) + l2*theta2_dot*cos(theta2) + l3*theta3_dot*cos(theta3))**2 \
+ (l1*theta1_dot*sin(theta1) + l2*theta2_dot*sin(theta2) + l3*theta3_dot*sin(theta3))**2)/2"""
potential_energy = """-m1*g*l1*cos(theta1) - m2*g*(l1*cos(theta1) + l2*cos(theta2)) \
- m3*g*(l1*cos(theta1) + l2*cos(theta2) + l3*cos(theta3))"""
euler_lagrange = [
"""M1*l1*theta1_ddot + M2*l2*(cos(theta1 - theta2)*theta2_ddot + sin(theta1 - theta2)*theta2_dot**2)
 + m3*l3*(cos(theta1 - theta3)*theta3_ddot + sin(theta1 - theta3)*theta3_dot**2)
 + M1*g*sin(theta1) = 0""",
"""m3*l1*(cos(theta3 - theta1)*theta1_ddot + sin(theta3 - theta1)*theta1_dot**2) + m3*l3*theta3_ddot
 + m3*l2*(cos(theta3 - theta2)*theta2_ddot + sin(theta3 - theta2)*theta2_dot**2)
 + m3*g*sin(theta3) = 0""",
]
[names]
M1 = "m1 + m2 + m3"
M2 = "m2 + m3"
[momenta]
theta3 = """m3*l3*(l1*theta1_dot*cos(theta1 - theta3) + l2*theta2_dot*cos(theta2 - theta3) \
+ l3*theta3_dot)"""
''',
    '''
system = "coupled_pendulums"
kinetic_energy = "m*l**2/2*(theta1_dot**2 + theta2_dot**2)"
potential_energy = """k/2*(sqrt(d**2 + 2*d*l*(sin(theta2) - sin(theta1)) \
+ 2*l**2*(1 - cos(theta1 - theta2))) - d)**2 - m*g*l*(cos(theta1) + cos(theta2))"""
[momenta]
theta1 = "m*l**2*theta1_dot"
''',
    '''
system = "driven_pendulum"
lagrangian = """m*l**2*theta_dot**2/2 - m*a*l*Omega*theta_dot*sin(theta)*sin(Omega*t) \
+ m*a**2*Omega**2*sin(Omega*t)**2/2 + m*g*(l*cos(theta) - a*cos(Omega*t))"""
potential_energy = "m*g*(a*cos(Omega*t) - l*cos(theta))"
euler_lagrange = [
"m*l**2*theta_ddot + c*theta_dot + m*l*(g - a*Omega**2*cos(Omega*t))*sin(theta) = 0",
"theta_ddot = -(g - a*Omega**2*cos(Omega*t))/l*sin(theta) - c/(m*l**2)*theta_dot",
]
[momenta]
theta = "m*l*(l*theta_dot - a*Omega*sin(theta)*sin(Omega*t))"
[accelerations]
theta = "(a*Omega**2*cos(Omega*t) - g)*sin(theta)/l - c*theta_dot/(m*l**2)"
''',
    """
system = "driven_pendulum"
lagrangian = "m*l**2*phi_dot**2/2 + m*l*A*gamma**2*cos(gamma*t)*cos(phi) + m*g*l*cos(phi)"
[equal]
c = "0"
[names]
phi = "theta"
A = "-a"
gamma = "Omega"
""",
    '''
system = "elastic_pendulum"
lagrangian = "m/2*(x_dot**2 + (l0 + x)**2*theta_dot**2) - k*x**2/2 + g*m*(l0 + x)*cos(theta)"
hamiltonian = """p_r**2/(2*m) + p_theta**2/(2*m*(l0 + x)**2) + k*x**2/2 \
- m*g*(l0 + x)*cos(theta)"""
euler_lagrange = [
"m*x_ddot = m*(l0 + x)*theta_dot**2 - k*x + m*g*cos(theta)",
"(l0 + x)*theta_ddot + 2*x_dot*theta_dot + g*sin(theta) = 0",
]
[names]
x = "r - l"
l0 = "l"
[momenta]
theta = "m*(l0 + x)**2*theta_dot"
[accelerations]
r = "(l0 + x)*theta_dot**2 - k/m*x + g*cos(theta)"
theta = "-g/(l0 + x)*sin(theta) - 2*x_dot/(l0 + x)*theta_dot"
[hamilton]
p_r = "p_theta**2/(m*r**3) - k*(r - l) + m*g*cos(theta)"
''',
    """
system = "henon_heiles"
potential_energy = "(x**2 + y**2)/2 + x**2*y - y**3/3"
lagrangian = "(x_dot**2 + y_dot**2)/2 - (x**2 + y**2 + 2*x**2*y - 2*y**3/3)/2"
hamiltonian = "(p_x**2 + p_y**2)/2 + (x**2 + y**2 + 2*x**2*y - 2*y**3/3)/2"
euler_lagrange = ["x_ddot + x*(1 + 2*y) = 0", "y_ddot = -y - x**2 + y**2"]
[accelerations]
x = "-x - 2*x*y"
y = "-y - x**2 + y**2"
[hamilton]
p_y = "-y - x**2 + y**2"
""",
    """
system = "rotating_hoop"
kinetic_energy = "m*R**2/2*(theta_dot**2 + omega**2*sin(theta)**2)"
lagrangian = "m*R**2/2*(theta_dot**2 + omega**2*sin(theta)**2) - m*g*R*(1 - cos(theta))"
hamiltonian = "p_theta**2/(2*m*R**2) - m*R**2*omega**2*sin(theta)**2/2 - m*g*R*cos(theta)"
energy = "m*R**2*(theta_dot**2 - omega**2*sin(theta)**2)/2 - m*g*R*cos(theta)"
euler_lagrange = ["R*theta_ddot = (omega**2*R*cos(theta) - g)*sin(theta)"]
[names]
omega = "Omega"
[accelerations]
theta = "(omega**2*cos(theta) - g/R)*sin(theta)"
[hamilton]
p_theta = "m*R*(R*omega**2*cos(theta) - g)*sin(theta)"
""",
    """
system = "spherical_pendulum"
kinetic_energy = "m*l**2*(theta_dot**2 + phi_dot**2*sin(theta)**2)/2"
energy = "m*l**2*(theta_dot**2 + sin(theta)**2*phi_dot**2)/2 - m*g*l*cos(theta)"
lagrangian = "m*l*(l*(theta_dot**2 + phi_dot**2*(1 - cos(theta)**2))/2 + g*cos(theta))"
hamiltonian = "(p_theta**2 + p_phi**2/sin(theta)**2)/(2*m*l**2) - m*g*l*cos(theta)"
euler_lagrange = [
"theta_ddot - phi_dot**2*sin(theta)*cos(theta) + g/l*sin(theta) = 0",
"sin(theta)*phi_ddot + 2*theta_dot*phi_dot*cos(theta) = 0",
]
[momenta]
phi = "m*l**2*phi_dot*sin(theta)**2"
[accelerations]
theta = "sin(theta)*(phi_dot**2*cos(theta) - g/l)"
phi = "-2*theta_dot*phi_dot*cos(theta)/sin(theta)"
[hamilton]
p_theta = "p_phi**2*cos(theta)/(m*l**2*sin(theta)**3) - m*g*l*sin(theta)"
""",
    """
system = "swinging_atwood"
kinetic_energy = "M*r_dot**2/2 + m*(r_dot**2 + r**2*theta_dot**2)/2"
potential_energy = "g*r*(M - m*cos(theta))"
lagrangian = "(M + m)*r_dot**2/2 + m*r**2*theta_dot**2/2 - g*r*(M - m*cos(theta))"
hamiltonian = "(p_r**2/(1 + mu) + p_theta**2/r**2)/(2*m) + m*g*r*(mu - cos(theta))"
euler_lagrange = [
"(M + m)*r_ddot - m*r*theta_dot**2 + g*(M - m*cos(theta)) = 0",
"r*theta_ddot + 2*r_dot*theta_dot + g*sin(theta) = 0",
]
[names]
mu = "M/m"
[accelerations]
r = "(r*theta_dot**2 + g*(cos(theta) - mu))/(1 + mu)"
theta = "-(2*r_dot*theta_dot + g*sin(theta))/r"
[hamilton]
r = "p_r/(M + m)"
p_r = "p_theta**2/(m*r**3) - M*g + m*g*cos(theta)"
""",
    """
system = "foucault_pendulum"
potential_energy = "-m*g*sqrt(l**2 - x**2 - y**2)"
""",
)
