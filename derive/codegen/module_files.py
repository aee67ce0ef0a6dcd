"""The generated files of a system, one for each target language."""

from collections.abc import Sequence
from dataclasses import replace
from hashlib import sha256
from os import PathLike
from pathlib import Path

import sympy as sp

from derive.codegen.backend import DIGEST, find_backends
from derive.codegen.generated_folder import GeneratedFiles
from derive.codegen.module_functions import Contents, contents
from derive.mechanics.derivation import Derivation
from derive.mechanics.reduced_coordinates import reduced
from derive.system.system import System

#: Digits of the digest of generated files.
DIGITS = 16

FUNCTIONS = ("outputs", "outputs_jacobian", "outputs_parameter_jacobian")


def texts(derivation: Derivation, only: Sequence[str] | None = None) -> dict[str, str]:
    """The generated files of a system by name, with all functions or `only` some."""
    return files(contents(derivation, only))


def files(generated: Contents) -> dict[str, str]:
    """The texts of the generated files by name, in every target language, with their digest."""
    parts = {
        name: text for backend in find_backends() for name, text in backend.files(generated).items()
    }
    digest = sha256("".join(parts.values()).encode()).hexdigest()[:DIGITS]
    return {file: text.replace(DIGEST, digest) for file, text in parts.items()}


def write(system: System, folder: str | PathLike[str]) -> Path:
    """Write the module of a system, its derivatives and the C header, each whole or not at all.

    Coordinates that constraints determine are eliminated before (`reduced`).

    Parameters
    ----------
    system : System
        The system to derive.
    folder : path
        The folder, created if it is missing; ``import`` finds the module if the folder is on
        Python's path.

    Returns
    -------
    Path
        The path of the module.

    Raises
    ------
    SystemDefinitionError
        When a coordinate moves no mass, or moves the masses only as others do; when the
        system's equilibrium is not one.
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
    GeneratedFiles(Path(folder), texts(Derivation(reduced(system))), complete=False).write()
    return Path(folder) / f"{system.name}.py"


def output_texts(derivation: Derivation, outputs: Sequence[sp.Expr]) -> dict[str, str]:
    """The generated files of functions of measured quantities alone."""
    named = {f"output_{k}": formula for k, formula in enumerate(outputs)}
    return texts(Derivation(replace(derivation.system, outputs=named)), FUNCTIONS)
