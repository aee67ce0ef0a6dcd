"""The C program that integrates one motion in numbers longer than doubles.

It consists of the module's generated header, once for each of two number types, the coefficients of
Gauss collocation, and handwritten files in the folder ``c``.
"""

import re
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal, localcontext

from solvers.equations.forms import Form
from solvers.equations.module import BINARY, ELEMENTARY
from solvers.integration.compiled.equations_source import EquationsSource
from solvers.integration.compiled.memory_layout import sizes_and_statuses, source
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
{sizes}
{numbers}
#define HAS_INTEGRALS {has_integrals}
static const real EPSILON = {epsilon};
static const int COLUMN[] = {{{columns}}}, RATE[] = {{{rates}}}, SINE[] = {{{sines}}};
{coefficients}
{motion_h}
{stages_h}
{projection}
{extended_c}
"""

#: Of systems without constraints.
NO_PROJECTION = """\
static void project(Motion *motion) { (void)motion; (void)SINE; }
static void keep_integrals(Motion *motion) { (void)motion; }"""

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

    def equations(self, equations: EquationsSource, prefix: str) -> str:
        """The header's text for this type, with a prefix before all its names."""
        counts = dict.fromkeys(ELEMENTARY, 1) | dict.fromkeys(BINARY, 2) if self.call else {}
        system = equations.rhs.partition("_rhs")[0]
        renamed = rf"\b(HOLONOMIC_)?({system}|{system.upper()})_"
        return EQUATIONS.format(
            prototypes="\n".join(
                f"{self.name} {function}{self.call}({', '.join([self.name] * count)});"
                for function, count in counts.items()
            ),
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


class NotArithmeticError(ValueError):
    """A right-hand side has more than sums, products and quotients; the message names it."""


class Precision(ABC):
    """Numbers longer than doubles, and the method of a motion in them."""

    stages: int  # of Gauss collocation, whose order is twice as high
    epsilon: str
    files: Sequence[str]  # with the stages
    correction: str  # file with changes of components
    may_fuse: bool  # products and sums

    @abstractmethod
    def numbers(self, equations: EquationsSource) -> str:
        """The types of numbers, the right-hand side in them, and CORRECTION with constraints.

        EVALUATE gives the integrals, if there are any.
        `NotArithmeticError` where it cannot be written in them.
        """

    @abstractmethod
    def coefficients(self) -> str:
        """The coefficients of the method in C."""

    def program(self, equations: EquationsSource, form: Form) -> str:
        """The C99 program, with ``extended_start``, ``_advance`` and ``_progress``."""
        sines, rates = zip(*equations.angles or [(0, 0)], strict=True)
        added = {k: equations.state + a for a, (k, _) in enumerate(form.angle_columns)}
        columns = {**dict(form.shared_columns), **added}
        sizes = {
            "DIM": equations.state,
            "PARAMETERS": equations.parameters,
            "KEPT": equations.kept,
            "FIRST_KEPT": equations.parameters - equations.kept,
            "ANGLES": len(equations.angles),
            "ORDINARY": equations.ordinary,
            "PARTS": PARTS,
            "STAGES": self.stages,
        }
        return PROGRAM.format(
            sizes=sizes_and_statuses(sizes),
            numbers=self.numbers(equations),
            has_integrals=int(equations.kept > 0),
            epsilon=self.epsilon,
            columns=", ".join(str(columns[k]) for k in range(equations.ordinary)),
            rates=", ".join(map(str, rates)),
            sines=", ".join(map(str, sines)),
            coefficients=self.coefficients(),
            motion_h=source("extended_motion.h"),
            stages_h="\n".join(map(source, self.files)),
            projection="\n".join(map(source, (self.correction, "extended_projection.h")))
            if equations.correction
            else NO_PROJECTION,
            extended_c=source("extended.c"),
        )


class Sequential(Precision):
    """One type of C, and a shorter one for first approximations; one stage after the other."""

    files, may_fuse = ("extended_stages.h", "extended_refinement.h"), True
    correction = "extended_correction.h"

    def __init__(self, real: NumberType, lower: NumberType, stages: int) -> None:
        self.real, self.lower, self.stages = real, lower, stages
        self.epsilon = real.epsilon

    def numbers(self, equations: EquationsSource) -> str:
        """Both types, with the header for each."""
        types = {"real": self.real, "lower": self.lower}
        return "\n".join(
            [
                self.real.equations(equations, ""),
                self.lower.equations(equations, "LOWER_"),
                *(f"typedef {kind.name} {name};" for name, kind in types.items()),
                f"static const lower LOWER_EPSILON = {self.lower.epsilon};",
                f"#define CORRECTION {equations.correction}" if equations.correction else "",
                f"#define EVALUATE {equations.integrals}" if equations.kept else "",
            ]
        )

    def coefficients(self) -> str:
        """Matrices by their rows."""
        arrays = coefficients_of(self.stages)
        return "\n".join(
            [
                *(self.real.array(name, arrays[name]) for name in ("A", "B", "C")),
                *(self.lower.array(f"LOWER_{name}", arrays[name]) for name in arrays),
            ]
        )


def coefficients_of(stages: int) -> dict[str, Sequence[Sequence[Decimal]]]:
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
