"""Generated modules of systems: shipped, or built and cached."""

import re
from collections.abc import Mapping, Sequence
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, cast

from solvers.equations.module import (
    GeneratedModule,
    LazyModule,
    has_constraints,
    has_function,
    named,
)
from solvers.equations.module_cache import (
    cached_module,
    specialised_module,
)
from solvers.equations.signature_checks import checked
from solvers.integration.accuracy.method_choice import MethodChoice
from solvers.runge_kutta.method_catalogue import SCIPY
from solvers.runge_kutta.method_catalogue import load as load_method

if TYPE_CHECKING:
    from derive import System

#: The rooms that write modules from systems, and an import of another file of theirs.
GENERATOR = ("derive/codegen", "derive/mechanics", "derive/system", "derive/systems")
IMPORTED = re.compile(r"^ *from (derive[\w.]*) import (?:([\w ,]+)|\(([^)]*)\))", re.MULTILINE)

#: The systems of modules that were built in this process, by the module's name.
_systems: "dict[str, System]" = {}


@checked
def load(name: str) -> GeneratedModule:
    """The generated module of a system that ships, or of a system file.

    Parameters
    ----------
    name : str
        Name of a system, such as ``double_pendulum``, or of a member of a family, such as
        ``chain_5``; or the path of a system file that ends in ``.toml``.

    Returns
    -------
    module
        As ``generated.double_pendulum``; modules that do not ship are built in the user's cache,
        each function when it is first used.

    Raises
    ------
    LookupError
        If no system has this name.
    ValueError
        If the file does not exist or does not describe a system.
    derive.codegen.expression_graph.sympy_translation.UnsupportedFunctionError
        If its equations contain an unsupported function.

    Warns
    -----
    UserWarning
        If the module can be written to no folder: it has no C header then, and runs in Python.

    Examples
    --------
    >>> chain = load("chain_4")
    >>> chain.COORDINATES
    ('theta1', 'theta2', 'theta3', 'theta4')
    """
    if module := _shipped(name):
        return module
    from derive.system.files import system_catalogue

    try:
        return build(system_catalogue.load(name))
    except system_catalogue.UnknownSystemError as error:
        raise LookupError(str(error)) from error


def _shipped(name: str) -> GeneratedModule | None:
    """The module of this name in `generated`; None if it is not there."""
    try:
        package = import_module("generated")
        if name in package.__all__:
            return import_module(f"generated.{name}")
    except Exception as error:  # whatever a damaged file raises
        if isinstance(error, ModuleNotFoundError) and error.name == "generated":
            return None
        raise OSError(
            f"the package generated is damaged: {type(error).__name__}: {error}; mend it with: "
            "holonomic derive"
        ) from error
    return None


def build(system: "System") -> GeneratedModule:
    """The generated module of a system, built in the user's cache if it is not there yet.

    Coordinates that constraints determine are eliminated before (`derive.reduced`).

    Parameters
    ----------
    system : derive.System
        A mechanical system.

    Returns
    -------
    module
        Its equations of motion as functions. Each is generated when it is first used; ``__file__``
        is a file of all functions, with the C header beside it.

    Raises
    ------
    ValueError
        If `system` is not a system, such as the path of a system file.
    derive.codegen.expression_graph.sympy_translation.UnsupportedFunctionError
        If its equations contain an unsupported function.

    Warns
    -----
    UserWarning
        If the module can be written to no folder: it has no C header then, and runs in Python.

    Examples
    --------
    >>> import derive
    >>> from solvers import build
    >>> build(derive.load("chain_4")).COORDINATES
    ('theta1', 'theta2', 'theta3', 'theta4')
    """
    from derive import Derivation, reduced
    from derive.codegen.module_files import files
    from derive.codegen.module_functions import Functions
    from derive.system.system import as_system

    # symbols of one name may differ in their assumptions
    system = as_system(system)
    assumptions = [(s.name, sorted(s.assumptions0.items())) for s in (*system.q, *system.params)]
    key = f"{system!r}{assumptions}{generator_text()}"
    functions = cache(lambda: Functions(Derivation(reduced(system))))

    @cache
    def part(names: tuple[str, ...]) -> GeneratedModule:
        def texts() -> dict[str, str]:
            # the right-hand side first: it raises for unsupported functions
            return files(functions().part(names or [functions().fastest]))

        return cached_module(system.name, f"{key}{names}", texts)

    module = cast("GeneratedModule", LazyModule(part))
    _systems[module.__name__] = system
    return module


def specialiser(
    module: GeneratedModule, params: Sequence[float], choice: MethodChoice
) -> GeneratedModule:
    """A module with these parameters folded in, and the functions that a method choice needs."""

    def generator(
        name: str, values: Mapping[str, float], functions: Sequence[str]
    ) -> dict[str, str]:
        from derive import Derivation
        from derive.codegen.module_files import texts
        from derive.mechanics.specialisation import specialised

        system = system_of(module)
        # where forces have kinks or jumps, every loop needs their switching functions
        needed = (*functions, "switches", "switches_rational")
        return texts(Derivation(specialised(system, values)), needed)

    # the name of a module from the cache contains a digest of its system
    version = module.__name__ + generator_text()
    needed = required_functions(choice.method, choice.form)
    needed += projection_functions(module, choice.form)
    return specialised_module(module, params, needed, generator, version)


def system_of(module: GeneratedModule) -> "System":
    """The system that a module was generated from, without eliminated coordinates."""
    from derive import reduced
    from derive.system.files import system_catalogue

    return reduced(_systems.get(module.__name__) or system_catalogue.load(module.SYSTEM))


@cache
def generator_text() -> str:
    """The source text of the generator and the systems, a part of the key of cached modules.

    It has all files that the generator imports, and no others, so that a change to a reader of
    documents rebuilds no module.
    """
    root = Path(__file__).parents[2]
    waiting = [path for room in GENERATOR for path in (root / room).rglob("*.py")]
    texts: dict[Path, str] = {}
    while waiting:
        path = waiting.pop()
        if path not in texts and path.is_file():
            texts[path] = path.read_text(encoding="utf-8")
            folders = (folder for folder in path.parents if folder.is_relative_to(root))
            waiting += [folder / "__init__.py" for folder in folders]
            for package, one, several in IMPORTED.findall(texts[path]):
                names = re.findall(r"\w+", one or several)
                parts = [package, *(f"{package}.{name}" for name in names)]
                files = [root.joinpath(*part.split(".")) for part in parts]
                waiting += [file.with_suffix(".py") for file in files]
                waiting += [file / "__init__.py" for file in files]
    return "".join(texts[path] for path in sorted(texts))


def required_functions(method: str, form: str) -> tuple[str, ...]:
    """Names of the functions that a method requires; implicit methods require a Jacobian."""
    conversions = ("hamiltonian_state", "lagrangian_state") if form == "hamiltonian" else ()
    needs_jacobian = method not in SCIPY and load_method(method).needs_jacobian
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
