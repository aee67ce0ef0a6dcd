"""Generated files of a system."""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike
from pathlib import Path

from derive.codegen.c_backend import header
from derive.codegen.functions import contents
from derive.codegen.python_backend import module
from derive.codegen.tree import Tree
from derive.mechanics.derivation import Derivation
from derive.system.system import System


def texts(derivation: Derivation, only: Sequence[str] | None = None) -> dict[str, str]:
    """The generated files of a system by name, with all functions or `only` some."""
    generated, name = contents(derivation, only), derivation.system.name
    return {f"{name}.py": module(generated), f"{name}.h": header(generated)}


def write(system: System, folder: str | PathLike[str]) -> Path:
    """Write the module and the C header of a system; either is there whole or not at all.

    Parameters
    ----------
    system : System
        What is derived.
    folder : path
        Where to, made if it is missing; ``import`` finds the module where it is on Python's
        path.

    Returns
    -------
    Path
        The module.

    Raises
    ------
    SystemDefinitionError
        When a coordinate moves no mass, or moves the masses only as others do; when a force
        is left at the equilibrium that the system gives.
    UnsupportedFunctionError
        When an expression has no counterpart in generated code.
    OSError
        When the folder cannot be written to.

    Examples
    --------
    >>> from derive import load
    >>> print(write(load("chain_2"), "build"))
    build/chain_2.py
    """
    Tree(Path(folder), texts(Derivation(system)), complete=False).write()
    return Path(folder) / f"{system.name}.py"
