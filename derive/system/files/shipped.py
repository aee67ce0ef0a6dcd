"""Names of the systems that ship; listing them loads no system and no SymPy."""

import re
from pkgutil import iter_modules

from derive import systems
from derive.systems import large

#: The member of a family that is listed and shipped.
USUAL = 3


def names() -> tuple[str, ...]:
    """Names of the systems whose modules ship, in alphabetical order; of a family its usual member.

    Returns
    -------
    tuple of str
        Each can be given to `derive.load`.

    Examples
    --------
    >>> from derive import names
    >>> "double_pendulum" in names()
    True
    """
    return tuple(sorted(re.sub(r"_n\Z", f"_{USUAL}", stem) for stem in stems()))


def large_names() -> tuple[str, ...]:
    """Names of the systems that are derived when they are first used: their modules are long."""
    result = iter_modules(large.__path__)
    return tuple(sorted(module.name for module in result))


def stems() -> set[str]:
    """Names of the files of the systems whose modules ship."""
    result = iter_modules(systems.__path__)
    return {module.name for module in result if not module.ispkg}
