"""Modules made for one scene: with its parameters folded in, and nothing that it does not need."""

from __future__ import annotations

import hashlib
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType

from solvers.cache import PASSAGE, cache_folder, is_intact, placed, remove_abandoned, seal
from solvers.catalogue import load
from solvers.request import SCIPY

#: Seconds after which what a killed process left behind is removed.
ABANDONED = 600.0
#: What each form needs to be integrated in.
NEEDED = {
    "lagrangian": ("rhs",),
    "rational": ("rhs_rational",),
    "hamiltonian": ("rhs_hamiltonian", "hamiltonian_state", "lagrangian_state"),
}

#: Takes a system's name, values by parameter and names of functions; gives texts by file name.
Generator = Callable[[str, Mapping[str, float], Sequence[str]], Mapping[str, str]]


def needed(method: str, form: str) -> tuple[str, ...]:
    """Names of the functions that a method needs of a form: a Jacobian only if it is implicit."""
    jacobian = "jacobian" if form == "lagrangian" else f"jacobian_{form}"
    is_implicit = method not in SCIPY and not load(method).is_explicit
    return (*NEEDED[form], *((jacobian,) if is_implicit else ()))


def specialised(
    module: ModuleType, params: Sequence[float], functions: Sequence[str], generator: Generator,
    version: str,
) -> ModuleType:  # fmt: skip
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
    """
    name = module.__name__.rpartition(".")[2]
    values = dict(zip(module.PARAMETERS, map(float, params), strict=True))
    key = hashlib.sha256(repr((name, values, tuple(functions), version)).encode()).hexdigest()[:32]
    folder = cache_folder()
    place = folder / f"module-{key}"
    if not is_intact(place):
        _made(folder, place, generator(name, values, functions))
    return _loaded(place / f"{name}.py", f"holonomic_{name}_{key}")


def _made(folder: Path, place: Path, texts: Mapping[str, str]) -> None:
    remove_abandoned(folder, ABANDONED)
    with tempfile.TemporaryDirectory(prefix=PASSAGE, dir=folder) as name:
        ready = Path(name) / "ready"
        ready.mkdir(mode=0o700)
        for file, text in texts.items():
            (ready / file).write_text(text, encoding="utf-8")
        seal(ready)
        complaint = placed(ready, place, Path(name))
    if complaint:
        raise OSError(complaint)


def _loaded(path: Path, name: str) -> ModuleType:
    spec = spec_from_file_location(name, path)
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    writes = sys.dont_write_bytecode
    sys.dont_write_bytecode = True  # nothing comes beside the files whose digests are known
    try:
        spec.loader.exec_module(module)
    finally:
        sys.dont_write_bytecode = writes
    return module
