"""Subnormal numbers, which a library may have switched off for the whole process."""

import sys
from warnings import warn


def warn_if_flushed() -> None:
    """Warn if this thread sets numbers below ``sys.float_info.min`` to zero."""
    if sys.float_info.min * 0.5 == 0:
        warn(
            f"this process sets numbers below {sys.float_info.min:.2g} to zero: motions next to "
            "rest lose their digits. A library built with -ffast-math has switched that on; import "
            "it after the integration, or integrate in a process without it",
            stacklevel=5,
        )
