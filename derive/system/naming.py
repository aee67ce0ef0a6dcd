"""Names that are valid in generated Python and C."""

import keyword
import re
import sys
from collections import Counter
from collections.abc import Iterable

from derive.formulas.functions import FUNCTIONS, GENERATED
from derive.system.parts import SystemDefinitionError

IDENTIFIER = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,39}\Z")

#: Words that Python, C or the generated functions use themselves.
RESERVED = {
    *keyword.kwlist,
    *keyword.softkwlist,
    *"auto char const default do double enum extern float goto inline int long register".split(),
    *"restrict short signed sizeof static struct switch typedef union unsigned void".split(),
    *"volatile pi".split(),
    *FUNCTIONS,
    *GENERATED,
    *"t qddot params signs state result numpy math hasattr STATE".split(),
    # keywords of C++ and of later standards of C, and macros that compilers define
    *"asm bool catch class delete dynamic_cast explicit export friend mutable namespace".split(),
    *"new operator private protected public template this throw typeid typename using".split(),
    *"virtual wchar_t constexpr nullptr decltype noexcept static_assert thread_local".split(),
    *"alignas alignof true false and_eq bitand bitor compl not_eq or_eq xor xor_eq".split(),
    *"char8_t char16_t char32_t concept requires consteval constinit co_await co_return".split(),
    *"co_yield const_cast reinterpret_cast static_cast typeof typeof_unqual".split(),
    *"linux unix i386 EOF INFINITY NAN NULL MAXFLOAT DECIMAL_DIG math_errhandling".split(),
    # macros of the compiled loops; a header of the system `lane` would define functions of theirs
    *"ONE_LANE LANE MASK_LANE SELDOM RHS JACOBIAN COMPENSATED HAS_POLYNOMIAL INTERPOLATES".split(),
    *"VARIES_ORDER HAS_SWITCHES SWITCHING PART PERTURBED HAS_JACOBIAN".split(),
    *"LANE_BY_LANE PAIR_BY_PAIR SINE_OR_COSINE".split(),
    *"SMOOTH_RHS SMOOTH_JACOBIAN".split(),
    *"lane holonomic".split(),
}

#: Macros of C's standard headers, many of which only some compilers define.
MACROS = re.compile(
    r"(HOLONOMIC|FP|FLT|DBL|LDBL|MATH|CLOCKS?|TIMER?)_[A-Z0-9_]+"
    r"|(U?INT|SIZE|PTRDIFF|SIG_ATOMIC|WCHAR|WINT)[A-Z0-9_]*_(MAX|MIN|WIDTH|C)"
    r"|M_(E|LOG2E|LOG10E|LN2|LN10|[12]_PI|PI(_[24])?|2_SQRTPI|SQRT2|SQRT1_2)(l|f\w*)?"
    r"|(HUGE_VAL|SNAN)\w*"
)

#: Modules that a generated module would hide: Python's, and those of this project.
MODULES = {*sys.stdlib_module_names, "numpy", "scipy", "sympy", "matplotlib", "mpmath"} | {
    *"derive generated holonomic solvers".split()
}

#: Words that a C header appends to the name of its system.
HELPERS = (
    "real",
    "number",
    "splat",
    "block",
    "clear",
    "factorise",
    "solve",
    *FUNCTIONS,
    *GENERATED,
)
#: Macros that it appends to the same in capitals.
HELPER_MACROS = ("NUMBER", "BLOCK", "DOUBLE", "SWITCH")


def check_name(name: str, system: str) -> None:
    """Raise `SystemDefinitionError` if `name` is no identifier or a reserved word."""
    helpers = {f"{system}_{word}" for word in HELPERS}
    helpers |= {f"{system.upper()}_{word}" for word in HELPER_MACROS}
    is_reserved = name in RESERVED | helpers or MACROS.fullmatch(name)
    if not IDENTIFIER.match(name) or is_reserved:
        raise SystemDefinitionError(
            f"{name[:50]!r} cannot be a name in system {system[:50]!r}: use a letter and up to 39 "
            "letters, digits or underscores, and no word reserved by Python, C or generated code"
        )


def check_module_name(name: str) -> None:
    """Raise `SystemDefinitionError` if a generated module of this name would hide another one."""
    if name in MODULES:
        raise SystemDefinitionError(
            f"{name!r} cannot be the name of a system: its module would hide the module {name!r} "
            "of Python or of this project; choose another name"
        )


def check_unique(names: Iterable[str], system: str) -> None:
    """Raise `SystemDefinitionError` if a name occurs twice."""
    repeated = sorted(name for name, count in Counter(names).items() if count > 1)
    if repeated:
        raise SystemDefinitionError(
            f"system {system!r} uses a name twice: {', '.join(repeated)} (velocities are "
            "named q_dot, accelerations q_ddot, momenta p_q, perturbations delta_q, sines "
            "and cosines sin_q and cos_q)"
        )
