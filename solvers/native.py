"""A module's right-hand side as machine code."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

from solvers.compiler import Library, build

WRAPPER = """
void rhs(double t, const double *y, double *dy, const double *params);
void rhs(double t, const double *y, double *dy, const double *params)
{{
    {name}_rhs{suffix}(t, y, dy, params);
}}
"""


@dataclass(frozen=True)
class NativeRhs:
    """``void rhs(double t, const double *y, double *dy, const double *params)``.

    Attributes
    ----------
    function : ctypes function
        Takes a float and three pointers, such as ``array.ctypes.data``.
    address : int
        Where it is, for numba, Cython or another library.
    library : Library
        The file it came from; it stays loaded as long as `function` lives.
    """

    function: Any
    address: int
    library: Library


def native_rhs(
    module: ModuleType, form: str = "lagrangian", *, reproducible: bool = False
) -> NativeRhs:
    """Compile the right-hand side of a generated module.

    Parameters
    ----------
    module : module
        A generated module, whose header stands beside it.
    form : {"lagrangian", "hamiltonian", "rational"}
        Which right-hand side.
    reproducible : bool
        Whether every compiler is to give the same bits, at some cost of speed.

    Raises
    ------
    ValueError
        When there is no header, or no such form in it.
    solvers.compiler.NoCompilerError
        When no compiler could build it.
    """
    header = Path(module.__file__ or "").with_suffix(".h")
    name = header.stem
    suffix = "" if form == "lagrangian" else f"_{form}"
    if not header.is_file():
        raise ValueError(f"{header} is missing: write it with holonomic derive {name}")
    text = header.read_text(encoding="utf-8")
    if f"static inline void {name}_rhs{suffix}(" not in text:
        raise ValueError(f"form {form!r}: {header} has no {name}_rhs{suffix}")
    library = build(text + WRAPPER.format(name=name, suffix=suffix), reproducible=reproducible)
    function = ctypes.CDLL(str(library.path)).rhs
    function.restype = None
    function.argtypes = [ctypes.c_double, *[ctypes.c_void_p] * 3]
    address = ctypes.cast(function, ctypes.c_void_p).value
    assert address is not None
    return NativeRhs(function, address, library)
