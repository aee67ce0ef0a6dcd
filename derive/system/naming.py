"""Names that are valid in generated Python and C."""

import keyword
import re
from collections import Counter
from collections.abc import Iterable

from derive.formulas.functions import FUNCTIONS
from derive.system.parts import SystemDefinitionError

IDENTIFIER = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,39}\Z")

#: Words that Python, C or the generated functions use themselves.
RESERVED = {
    *keyword.kwlist,
    *keyword.softkwlist,
    *"auto char const default do double enum extern float goto inline int long register".split(),
    *"restrict short signed sizeof static struct switch typedef union unsigned void".split(),
    *"volatile NULL NAN INFINITY pi".split(),
    *FUNCTIONS,
    *"t params state result numpy math hasattr STATE".split(),
    # keywords of C++, and macros that compilers may define
    *"asm bool catch class delete dynamic_cast explicit export friend mutable namespace".split(),
    *"new operator private protected public template this throw typeid typename using".split(),
    *"virtual wchar_t constexpr nullptr decltype noexcept static_assert thread_local".split(),
    *"alignas alignof true false linux unix HUGE_VAL HUGE_VALF HUGE_VALL M_PI M_E EOF".split(),
}

#: Words that a C header appends to the name of its system.
HELPERS = ("real", "number", "splat", *FUNCTIONS)


def check_name(name: str, system: str) -> None:
    """Raise `SystemDefinitionError` if `name` is no identifier or a reserved word."""
    helpers = {f"{system}_{word}" for word in HELPERS}
    if not IDENTIFIER.match(name) or name in RESERVED | helpers:
        raise SystemDefinitionError(
            f"{name[:50]!r} cannot be a name in system {system[:50]!r}: use a letter and up to 39 "
            "letters, digits or underscores, and no word reserved by Python, C or generated code"
        )


def check_unique(names: Iterable[str], system: str) -> None:
    """Raise `SystemDefinitionError` if a name occurs twice."""
    repeated = sorted(name for name, count in Counter(names).items() if count > 1)
    if repeated:
        raise SystemDefinitionError(
            f"system {system!r} uses a name twice: {', '.join(repeated)} (velocities are "
            "named q_dot, accelerations q_ddot, momenta p_q, linear perturbations delta_q, sines "
            "and cosines sin_q and cos_q)"
        )
