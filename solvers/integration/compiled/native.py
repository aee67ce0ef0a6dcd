"""A module's right-hand side as machine code."""

import ctypes
from dataclasses import dataclass
from typing import Any

from solvers.equations.forms import Form
from solvers.equations.module import (
    GeneratedModule,
    has_perturbation,
    header,
    integrals,
    named,
    parameter_names,
    switching_functions,
)
from solvers.equations.module import part as module_part
from solvers.integration.compiled.compiler import Library, build
from solvers.integration.compiled.equations_source import EquationsSource

WRAPPER = """
void rhs(double t, const double *y, double *dy, const double *params);
void rhs(double t, const double *y, double *dy, const double *params)
{{
    {rhs}(t, y, params, dy);
}}

void probe(void);
void probe(void)
{{
    const double y[{state}] = {{0.5}}, params[{parameters} + 1] = {{0.5}};
    double dy[{state}];
    rhs(0.0, y, dy, params);
}}
"""


#: Functions that convert states with momenta, and switching functions of converted states.
MOMENTA = ("hamiltonian_state", "lagrangian_state", "switches")


@dataclass(frozen=True)
class NativeRhs:
    """``void rhs(double t, const double *y, double *dy, const double *params)``."""

    function: Any  # of ctypes; takes a float and three pointers, such as ``array.ctypes.data``
    address: int  # for numba, Cython or another library, as long as `function` exists
    library: Library


def equations(
    module: GeneratedModule, form: str, *, jacobian: bool = False, switches: bool = False
) -> EquationsSource:
    """One form of a generated module in C, with its Jacobian if `jacobian`.

    Its switching functions have signs if `switches`.
    """
    layout = Form(module, form, (0.0,) * len(parameter_names(module, form)))
    kept, motion = integrals(module), form
    if has_perturbation(form):  # which follows the motion in a state
        motion = "rational" if layout.angle_columns else "lagrangian"
    evaluated = [named("rhs", form), *([layout.correction] if layout.has_constraints else [])]
    evaluated += [named("integrals", motion)] if kept else []
    evaluated += [named("switches", form)] if switches else []
    others = [named("jacobian", form)] if jacobian else []
    others += MOMENTA if form == "hamiltonian" else []
    part = module_part(module, *evaluated, *others)
    system, text = _header(part)
    from_ordinary = [f"z[{i}] = y[{k}];" for k, i in layout.shared_columns]
    to_ordinary = [f"y[{k}] = z[{i}];" for k, i in layout.shared_columns]
    for a, (k, i) in enumerate(layout.angle_columns):
        wrapped = f"atan2(z[{i}], z[{i + 1}])"
        from_ordinary.append(f"z[{i}] = sin(y[{k}]); z[{i + 1}] = cos(y[{k}]);")
        from_ordinary.append(f"turns[{a}] = lane_round((y[{k}] - {wrapped})*(0.5/PI));")
        to_ordinary.append(f"y[{k}] = {wrapped} + 2*PI*turns[{a}];")
    if form == "hamiltonian":
        from_ordinary = [f"{system}_hamiltonian_state(t, y, params, z);"]
        to_ordinary = [f"{system}_lagrangian_state(t, z, params, y);"]
    corrected = []
    if layout.has_constraints:
        shared = layout.shared_columns
        corrected = [f"add_to_component(state, {i}, change[{k}]);" for k, i in shared]
        corrected += [f"turn(state, {i}, change[{k}]);" for k, i in layout.angle_columns]
    return EquationsSource(
        text,
        f"{system}_{named('rhs', form)}",
        f"{system}_{named('jacobian', form)}",
        state=len(layout.state),
        parameters=len(layout.params) + len(kept),
        ordinary=len(layout.ordinary),
        angles=layout.angles,
        from_ordinary=from_ordinary,
        to_ordinary=to_ordinary,
        vectorises=not {*evaluated} & {*part.CALLS_FUNCTIONS},
        perturbed=layout.perturbed,
        correction=f"{system}_{layout.correction}" if corrected else "",
        corrected=corrected,
        integrals=f"{system}_{named('integrals', motion)}" if kept else "",
        kept=len(kept),
        perturbed_parameters=len(layout.params) - len(module.PARAMETERS),
        switches=len(switching_functions(module)) if switches else 0,
    )


def _header(module: GeneratedModule) -> tuple[str, str]:
    """The prefix of names in a module's C header, and its text."""
    path, name = header(module), module.SYSTEM
    if path is None:
        raise ValueError(f"{name}.h is missing: write it with holonomic derive {name}")
    text = path.read_text(encoding="utf-8")
    if module.DIGEST not in text:
        raise ValueError(
            f"{path} and {module.__file__} are of different versions: write both with holonomic "
            f"derive {name}"
        )
    return path.stem, text


def native_rhs(
    module: GeneratedModule, form: str = "lagrangian", *, reproducible: bool = False
) -> NativeRhs:
    """Compile the right-hand side of a generated module.

    Parameters
    ----------
    module : module
        A generated module, whose header stands beside it.
    form : {"lagrangian", "hamiltonian", "rational", "variational", "sensitivity"}, optional
        Which right-hand side.
    reproducible : bool, optional
        Whether every compiler must give the same bits, at some cost of speed.

    Returns
    -------
    NativeRhs
        A function of the time in s, the state of this form, the array for its derivative, and the
        parameters in the order of ``module.PARAMETERS``, in the sensitivity form after their
        perturbations.

    Raises
    ------
    ValueError
        When there is no header, or no such form in it.
    solvers.integration.compiled.compiler.NoCompilerError
        When no compiler could build it.
    """
    source = equations(module, form)
    sizes = {"state": source.state, "parameters": source.parameters}
    text = source.header + WRAPPER.format(rhs=source.rhs, **sizes)
    library = build(text, reproducible=reproducible)
    function = library.functions.rhs
    function.restype = None
    function.argtypes = [ctypes.c_double, *[ctypes.c_void_p] * 3]
    address = ctypes.cast(function, ctypes.c_void_p).value
    assert address is not None
    return NativeRhs(function, address, library)
