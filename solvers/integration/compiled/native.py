"""A module's right-hand side as machine code."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from typing import Any

from solvers.equations.forms import Form
from solvers.equations.module import GeneratedModule, header, named
from solvers.integration.compiled.compiler import Library, build
from solvers.integration.compiled.kernel_source import Equations

WRAPPER = """
void rhs(double t, const double *y, double *dy, const double *params);
void rhs(double t, const double *y, double *dy, const double *params)
{{
    {rhs}(t, y, params, dy);
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


def equations(module: GeneratedModule, form: str) -> Equations:
    """One form of a generated module in C.

    Parameters
    ----------
    module : module
        A generated module.
    form : str
        One of its forms.

    Returns
    -------
    Equations
        The whole header's text, and what of it belongs to this form.

    Raises
    ------
    ValueError
        When there is no header beside the module, or no such form.
    """
    place = header(module)
    if place is None:
        name = module.SYSTEM
        raise ValueError(f"{name}.h is missing: write it with holonomic derive {name}")
    text = place.read_text(encoding="utf-8")
    rhs, jacobian = (f"{place.stem}_{named(stem, form)}" for stem in ("rhs", "jacobian"))
    described = Form(module, form, (0.0,) * len(module.PARAMETERS))
    enter = [f"z[{i}] = y[{k}];" for k, i in described.shared_columns]
    leave = [f"y[{k}] = z[{i}];" for k, i in described.shared_columns]
    for a, (k, i) in enumerate(described.angle_columns):
        wrapped = f"atan2(z[{i}], z[{i + 1}])"
        enter.append(f"z[{i}] = sin(y[{k}]); z[{i + 1}] = cos(y[{k}]);")
        enter.append(f"turns[{a}] = nearest_whole((y[{k}] - {wrapped})*(0.5/PI));")
        leave.append(f"y[{k}] = {wrapped} + 2*PI*turns[{a}];")
    if form == "hamiltonian":
        enter = [f"{place.stem}_hamiltonian_state(t, y, params, z);"]
        leave = [f"{place.stem}_lagrangian_state(t, z, params, y);"]
    sizes = len(described.state), len(module.PARAMETERS), len(described.ordinary)
    vectorises = named("rhs", form) not in module.CALLS_FUNCTIONS
    return Equations(text, rhs, jacobian, *sizes, described.angles, enter, leave, vectorises)


def native_rhs(
    module: GeneratedModule, form: str = "lagrangian", *, reproducible: bool = False
) -> NativeRhs:
    """Compile the right-hand side of a generated module.

    Parameters
    ----------
    module : module
        A generated module, whose header stands beside it.
    form : {"lagrangian", "hamiltonian", "rational", "variational"}, optional
        Which right-hand side.
    reproducible : bool, optional
        Whether every compiler is to give the same bits, at some cost of speed.

    Returns
    -------
    NativeRhs
        A function of the time in s, the state of this form, room for its rate of change, and the
        parameters in the order of ``module.PARAMETERS``.

    Raises
    ------
    ValueError
        When there is no header, or no such form in it.
    solvers.integration.compiled.compiler.NoCompilerError
        When no compiler could build it.
    """
    source = equations(module, form)
    text = source.header + WRAPPER.format(rhs=source.rhs)
    library = build(text, reproducible=reproducible)
    function = ctypes.CDLL(str(library.path)).rhs
    function.restype = None
    function.argtypes = [ctypes.c_double, *[ctypes.c_void_p] * 3]
    address = ctypes.cast(function, ctypes.c_void_p).value
    assert address is not None
    return NativeRhs(function, address, library)
