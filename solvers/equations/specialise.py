"""Modules specialised for one scene: constant parameters, and only the functions it requires."""

from collections.abc import Callable, Mapping, Sequence

from solvers.equations.module import GeneratedModule, has_constraints, has_function, named
from solvers.equations.module_cache import cached_module
from solvers.runge_kutta.catalogue import SCIPY, load

#: Maps a system's name, values of its parameters and names of functions to texts by file name.
Generator = Callable[[str, Mapping[str, float], Sequence[str]], Mapping[str, str]]


def required_functions(method: str, form: str) -> tuple[str, ...]:
    """Names of the functions that a method requires; implicit methods require a Jacobian."""
    conversions = ("hamiltonian_state", "lagrangian_state") if form == "hamiltonian" else ()
    needs_jacobian = method not in SCIPY and load(method).needs_jacobian
    jacobian = (named("jacobian", form),) if needs_jacobian else ()
    return (named("rhs", form), *conversions, *jacobian)


def projection_functions(module: GeneratedModule, form: str) -> tuple[str, ...]:
    """Names of the functions that find and keep states on the constraints."""
    if not has_constraints(module):
        return ()
    of_form = (named(name, form) for name in ("correction", "integrals"))
    of_state = ("constraints", "constraints_jacobian", "redundant_constraints", "integrals")
    names = (*of_state, *of_form, "mass_matrix")
    return tuple(name for name in dict.fromkeys(names) if has_function(module, name))


def specialised_module(
    module: GeneratedModule,
    params: Sequence[float],
    functions: Sequence[str],
    generator: Generator,
    version: str,
) -> GeneratedModule:
    """A module with constant parameters and these functions, from the cache or newly generated.

    Its functions take an empty sequence of parameters. Another `version` of the generator
    generates it again.
    """
    name = module.SYSTEM
    values = dict(zip(module.PARAMETERS, map(float, params), strict=True))
    key = repr((name, values, tuple(functions), version))
    return cached_module(name, key, lambda: generator(name, values, functions))
