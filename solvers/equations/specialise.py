"""Modules made for one scene: with its parameters folded in, and nothing that it does not need."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from solvers.equations.module import GeneratedModule
from solvers.equations.module_cache import cached_module
from solvers.runge_kutta.catalogue import SCIPY, load

#: What each form needs to be integrated in.
REQUIRED_FUNCTIONS = {
    "lagrangian": ("rhs",),
    "rational": ("rhs_rational",),
    "hamiltonian": ("rhs_hamiltonian", "hamiltonian_state", "lagrangian_state"),
}

#: Takes a system's name, values by parameter and names of functions; gives texts by file name.
Generator = Callable[[str, Mapping[str, float], Sequence[str]], Mapping[str, str]]


def required_functions(method: str, form: str) -> tuple[str, ...]:
    """Names of the functions that a method needs of a form: a Jacobian only if it is implicit."""
    jacobian = "jacobian" if form == "lagrangian" else f"jacobian_{form}"
    is_implicit = method not in SCIPY and not load(method).is_explicit
    return (*REQUIRED_FUNCTIONS[form], *((jacobian,) if is_implicit else ()))


def specialised_module(
    module: GeneratedModule, params: Sequence[float], functions: Sequence[str],
    generator: Generator, version: str,
) -> GeneratedModule:  # fmt: skip
    """A module without parameters, from the cache or newly generated.

    Parameters
    ----------
    module : module
        A generated module.
    params : sequence of float
        In the order of ``module.PARAMETERS``.
    functions : sequence of str
        What it is to have.
    generator : callable
        Writes it, where the cache does not have it.
    version : str
        Of the generator: another one writes it anew.

    Returns
    -------
    module
        Its functions take an empty sequence of parameters.

    Raises
    ------
    OSError
        When it cannot be written to the cache.
    """
    name = module.SYSTEM
    values = dict(zip(module.PARAMETERS, map(float, params), strict=True))
    key = repr((name, values, tuple(functions), version))
    return cached_module(name, key, lambda: generator(name, values, functions))
