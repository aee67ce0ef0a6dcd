"""Positions in, motion out: the public names of `derive` and `solvers` in one place.

Names are imported when they are first used. ``load`` is `solvers.load`, which returns a generated
module; ``derive.load`` returns the `System` with its positions.
"""

from typing import TYPE_CHECKING, Any

import derive
import solvers

if TYPE_CHECKING:
    from derive import *  # noqa: F403
    from solvers import *  # noqa: F403

__all__ = sorted({*derive.__all__, *solvers.__all__})


def __getattr__(name: str) -> Any:
    """The name from `solvers`, or else from `derive`."""
    for package in (solvers, derive):
        if name in package.__all__:
            return getattr(package, name)
    raise AttributeError(f"module 'holonomic' has no attribute {name!r}")


def __dir__() -> list[str]:
    """The public names, for completion."""
    return __all__
