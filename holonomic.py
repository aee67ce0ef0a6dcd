"""Positions in, motion out: the public names of `derive` and `solvers` in one place.

Names are imported when they are first used. ``load`` is `solvers.load`, which returns a generated
module; ``derive.load`` returns the `System` with its positions. `Derivation` derives a system of
your own, `build` makes it a module, `integrate` moves it, and ``play()`` shows the motion; the
how-to in ``notebooks/docs/howto.md`` has tasks of a few lines each.
"""

from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

for _name in ("derive", "solvers"):
    _own = Path(__file__).resolve().with_name(_name) / "__init__.py"
    _spec = find_spec(_name)
    _found = Path((_spec and _spec.origin) or "nothing").resolve()
    if _found != _own:
        _hiding = _found.parent if _found.name == "__init__.py" else _found
        raise ImportError(
            f"{_hiding} hides the package {_name!r} of holonomic, {_own.parent}: rename it, or "
            "start Python in another folder"
        )

import derive  # noqa: E402
import solvers  # noqa: E402

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
