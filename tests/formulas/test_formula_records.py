"""Formulas as LaTeX and MathML, and the widths at which they are broken."""

import ast

from recording import Record

from derive.formulas.typeset.latex import latex
from derive.formulas.typeset.line_breaks import latex_rows, width_of
from derive.formulas.typeset.typesetting import Formula

#: Each operation beside each other one, names of every kind, and relations.
FORMULAS = """
a + b - c*d/e
-(a + b)*(c - d)**2
(a/b)/(c/d)
a/b*c
-a**-b
(-a)**2
a**(b + 1)
(a**b)**c
a**b**c
2**(1/2)*x
sqrt(a + b)/sqrt(c)
sin(x)**2*cos(x)
sin(2*x)/2
sin(x)(y)
tan(a*b + c)**-1
exp(-k*t)
exp(-(a + b))
log(x/y)
abs(x - y)
abs(sin(x))**3
sign(v)*mu*N
atan2(y, x)
max(a, b, 0)
Piecewise((x, x > 0), (-x, True))
(a, b)
[[a, b], [c, d]]*(x, y)
theta1_dot**2
theta1_ddot
p_theta1
omega_x_dot
theta_max
x12
alpha_10_dot
Lambda*lambda_1
m1*l1**2*theta1_dot**2/2 + m2*(l1**2*theta1_dot**2 + l2**2*theta2_dot**2)/2
-m*g*l*cos(theta)
3*4
-3*x
2*-x
x*-2
1.5*x
1e-3*x
0.1**2
a - (b - c)
a - (b + c)
a/(b*c)
a*(b/c)
(a*b)**2
(a + b)*c
-(a*b)
-a/b
+a
a = b
l*theta_ddot + g*sin(theta) = 0
""".strip().splitlines()
LONG = (
    "(m1 + m2)*l1**2*theta1_ddot + m2*l1*l2*(theta2_ddot*cos(theta1 - theta2)"
    " + theta2_dot**2*sin(theta1 - theta2)) + (m1 + m2)*g*l1*sin(theta1)",
    "(a*b + c*d + e*f + g*h)/(k*l + m*n)*sin(x + y)**2/(p + q)",
    "a*b + c + d*e*f + g + h*k + l**2 + m + n*p + q",
)


def test_typeset_formulas_are_as_recorded(record: Record) -> None:
    lines = []
    for text in FORMULAS:
        try:
            sides = [ast.parse(side.strip(), mode="eval").body for side in text.split("=")]
            written = " = ".join(map(latex, sides))
            width = f"{max(map(width_of, sides)):.3f}"
        except (ValueError, KeyError) as error:
            written, width = f"{type(error).__name__}: {error}", ""
        lines += [f"{text}: {written} [{width}] {Formula(text).html}"]
    for text in LONG:
        for width in (16.0, 21.0, 40.0):
            rows = latex_rows([ast.Name("E"), ast.parse(text, mode="eval").body], width)
            lines += [f"{width:g}:", *(f"    {row}" for row in rows)]
    record.check("\n".join(lines))
