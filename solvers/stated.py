"""What a generated module says of itself: whose it is, and what its functions cost."""

from __future__ import annotations

import inspect
import re
from types import ModuleType


def system(module: ModuleType) -> str:
    """The name of the system that a module is generated for."""
    return module.__name__.rpartition(".")[2]


def operations(module: ModuleType, function: str) -> int:
    """How many operations a call takes, by the function's docstring.

    Parameters
    ----------
    module : module
        A generated module.
    function : str
        One of its functions, such as ``rhs``.

    Returns
    -------
    int
        Additions, multiplications, divisions and calls.

    Raises
    ------
    ValueError
        When the function does not say: then the module must be generated anew.
    """
    return _counts(module, function)[0]


def operations_on_state(module: ModuleType, function: str) -> int:
    """The same without those on parameters alone, which are done once a run."""
    every, constant = _counts(module, function)
    return every - constant


def _counts(module: ModuleType, function: str) -> tuple[int, int]:
    words = inspect.getdoc(getattr(module, function)) or ""
    found = re.search(r"(\d+) operations(?:, (\d+) of them)?", words)
    if not found:
        raise ValueError(f"{system(module)}.{function} states no operations: generate it anew")
    return int(found[1]), int(found[2] or 0)
