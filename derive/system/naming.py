"""Names that generated Python and C can use."""

from __future__ import annotations

import keyword
import re
from collections.abc import Iterable

from derive.system.parts import SystemDefinitionError

IDENTIFIER = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,39}\Z")

#: Words that a generated Python or C function needs for itself.
RESERVED = {
    *keyword.kwlist,
    *keyword.softkwlist,
    *"auto char const default do double enum extern float goto inline int long register".split(),
    *"restrict short signed sizeof static struct switch typedef union unsigned void".split(),
    *"volatile NULL NAN INFINITY sin cos tan exp log sqrt pi".split(),
    *"t params state result numpy math hasattr".split(),
    # words of C++, and macros that compilers may define
    *"asm bool catch class delete dynamic_cast explicit export friend mutable namespace".split(),
    *"new operator private protected public template this throw typeid typename using".split(),
    *"virtual wchar_t constexpr nullptr decltype noexcept static_assert thread_local".split(),
    *"alignas alignof true false linux unix HUGE_VAL HUGE_VALF HUGE_VALL M_PI M_E EOF".split(),
}


def check_name(name: str, system: str) -> None:
    """Refuse what is no identifier, or a word that Python, C or generated functions reserve.

    Parameters
    ----------
    name : str
        Of a system, a coordinate, a parameter or a definition.
    system : str
        The system's name, for the message; with ``_real`` it is reserved, too.

    Raises
    ------
    SystemDefinitionError
        With what is allowed.
    """
    if not IDENTIFIER.match(name) or name in (*RESERVED, f"{system}_real"):
        raise SystemDefinitionError(
            f"{name[:50]!r} cannot be a name in system {system[:50]!r}: use a letter "
            "and then up to 39 letters, digits or underscores, and no word that Python, "
            "C or the generated functions reserve"
        )


def check_unique(names: Iterable[str], system: str) -> None:
    """Refuse a name that stands for two things.

    Parameters
    ----------
    names : iterable of str
        All names of a system, derived ones among them.
    system : str
        The system's name, for the message.

    Raises
    ------
    SystemDefinitionError
        With the names.
    """
    listed = list(names)
    twice = sorted({name for name in listed if listed.count(name) > 1})
    if twice:
        raise SystemDefinitionError(
            f"system {system!r} uses a name twice: {', '.join(twice)} (velocities are "
            "named q_dot, accelerations q_ddot, momenta p_q, small changes delta_q, sines and "
            "cosines sin_q and cos_q)"
        )
