"""Names of the systems that ship; listing them loads no system and no SymPy."""

import re
from pkgutil import iter_modules

from derive import systems

#: The member of a family that is listed and shipped.
USUAL = 3


def names() -> tuple[str, ...]:
    """Names of all systems, in alphabetical order; of a family its usual member.

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
    stems = (module.name for module in iter_modules(systems.__path__))
    return tuple(sorted(re.sub(r"_n\Z", f"_{USUAL}", stem) for stem in stems))
