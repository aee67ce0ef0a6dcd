"""The C program that integrates one motion in numbers longer than doubles.

It consists of the module's generated header, once for each of two number types, the coefficients of
Gauss collocation, and the handwritten file ``c/extended.c``.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal, localcontext

from solvers.equations.forms import Form
from solvers.equations.module import ELEMENTARY
from solvers.integration.compiled.kernel_source import Equations
from solvers.integration.compiled.layout import SOURCES, sizes_and_statuses
from solvers.runge_kutta.collocation import collocation, gauss_nodes
from solvers.runge_kutta.order_conditions import WORKING_DIGITS

#: Digits of coefficients, and doubles whose sum is a component of the initial state.
DIGITS, PARTS = 45, 3

PROGRAM = """\
#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>
#include <time.h>
{real}
{lower}
typedef {real_type} real;
typedef {lower_type} lower;
static const real EPSILON = {epsilon};
static const lower LOWER_EPSILON = {lower_epsilon};
{sizes}
static const int COLUMN[] = {{{columns}}}, RATE[] = {{{rates}}};
{coefficients}
{extended_c}
"""

#: The equations in one number type; {prefix} distinguishes them from those in another.
EQUATIONS = """\
{prototypes}
#undef HOLONOMIC_REAL
#undef HOLONOMIC_LITERAL
#undef HOLONOMIC_CALL
#define HOLONOMIC_REAL {type}
{hooks}
{header}
#define {prefix}RHS {rhs}
"""

#: Literals and functions of a type that C99 does not have.
HOOKS = """\
#define HOLONOMIC_LITERAL(x) x##{literal}
#define HOLONOMIC_CALL(name) name##{call}"""


@dataclass(frozen=True)
class NumberType:
    """A floating-point type of C, with the suffix of its literals."""

    name: str
    epsilon: str
    literal: str
    call: str = ""  # suffix of its functions, for a type that is not in C99

    def equations(self, equations: Equations, prefix: str) -> str:
        """The header's text for this type, with a prefix before all its names."""
        names = [f"{function}{self.call}" for function in ELEMENTARY if self.call]
        system = equations.rhs.partition("_rhs")[0]
        renamed = rf"\b(HOLONOMIC_)?({system}|{system.upper()})_"
        return EQUATIONS.format(
            prototypes="\n".join(f"{self.name} {name}({self.name});" for name in names),
            type=self.name,
            hooks=HOOKS.format(**vars(self)) if self.call else "",
            header=re.sub(renamed, rf"{prefix}\g<0>", equations.header),
            prefix=prefix,
            rhs=f"{prefix}{equations.rhs}",
        )

    def array(self, name: str, rows: Sequence[Sequence[Decimal]]) -> str:
        """A matrix, or a vector if it has one row, of constants in C."""
        lines = [f"{{{', '.join(map(self._number, row))}}}" for row in rows]
        if len(rows) == 1:
            return f"static const {self.name} {name}[STAGES] = {lines[0]};"
        body = ",\n    ".join(lines)
        return f"static const {self.name} {name}[STAGES][STAGES] = {{\n    {body}\n}};"

    def _number(self, value: Decimal) -> str:
        return f"{value:.{DIGITS}e}{self.literal}"


DOUBLE = NumberType("double", "DBL_EPSILON", "")
LONG_DOUBLE = NumberType("long double", "LDBL_EPSILON", "L")
#: Its functions are those of the GNU C library.
QUADRUPLE = NumberType("__float128", "0x1p-112Q", "Q", "f128")


def program(
    equations: Equations, form: Form, real: NumberType, lower: NumberType, stages: int
) -> str:
    """The text of the C99 program, with ``extended_start``, ``_advance`` and ``_progress``."""
    rates = [velocity for _, velocity in equations.angles] or [0]
    added = {k: equations.state + a for a, (k, _) in enumerate(form.angle_columns)}
    columns = {**dict(form.shared_columns), **added}
    sizes = {
        "DIM": equations.state,
        "PARAMETERS": equations.parameters,
        "ANGLES": len(equations.angles),
        "ORDINARY": equations.ordinary,
        "PARTS": PARTS,
        "STAGES": stages,
    }
    arrays = _coefficients(stages)
    return PROGRAM.format(
        real=real.equations(equations, ""),
        lower=lower.equations(equations, "LOWER_"),
        real_type=real.name,
        lower_type=lower.name,
        epsilon=real.epsilon,
        lower_epsilon=lower.epsilon,
        sizes=sizes_and_statuses(sizes),
        columns=", ".join(str(columns[k]) for k in range(equations.ordinary)),
        rates=", ".join(map(str, rates)),
        coefficients="\n".join(
            [
                *(real.array(name, arrays[name]) for name in ("A", "B", "C")),
                *(lower.array(f"LOWER_{name}", arrays[name]) for name in arrays),
            ]
        ),
        extended_c=(SOURCES / "extended.c").read_text(encoding="utf-8"),
    )


def _coefficients(stages: int) -> dict[str, Sequence[Sequence[Decimal]]]:
    """A, b, c, and the matrix from values at the nodes c to Legendre coefficients on [0, 1]."""
    c = gauss_nodes(stages)
    A, b = collocation(c)
    with localcontext(prec=WORKING_DIGITS):
        x = [2 * node - 1 for node in c]
        values = [[Decimal(1)] * stages, x]
        for m in range(2, stages):
            terms = zip(x, values[-1], values[-2], strict=True)
            values.append([((2 * m - 1) * y * p - (m - 1) * q) / m for y, p, q in terms])
        legendre = [
            [(2 * m + 1) * w * p for w, p in zip(b, row, strict=True)]
            for m, row in enumerate(values)
        ]
    return {"A": A, "B": [b], "C": [c], "LEGENDRE": legendre}
