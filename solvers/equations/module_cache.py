"""Modules generated on demand, and kept in the cache."""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Callable, Mapping
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from typing import cast

from solvers.equations.module import GeneratedModule
from solvers.io.build_cache import cache_folder, folder_in_place, is_intact

#: Seconds after which the remains of a killed process are removed.
ABANDONED = 600.0


def cached_module(name: str, key: str, texts: Callable[[], Mapping[str, str]]) -> GeneratedModule:
    """A module from the cache, or newly generated.

    Parameters
    ----------
    name : str
        Name of the module and of its files.
    key : str
        A text that determines its content.
    texts : callable
        Generates it, as texts by file name; called if the cache does not have it.

    Returns
    -------
    GeneratedModule
        A new one at every call; it is not in ``sys.modules``.

    Raises
    ------
    OSError
        When it cannot be written to the cache.
    """
    digest = hashlib.sha256(key.encode()).hexdigest()[:32]
    folder = cache_folder() / f"module-{digest}"
    if not is_intact(folder):
        generated = texts()
        with folder_in_place(folder, ABANDONED) as build:
            for file, text in generated.items():
                (build / file).write_text(text, encoding="utf-8")
    return _import(folder / f"{name}.py", f"holonomic_{digest}.{name}")


def _import(path: Path, name: str) -> GeneratedModule:
    spec = spec_from_file_location(name, path)
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    writes = sys.dont_write_bytecode
    sys.dont_write_bytecode = True  # the folder holds only files whose digests are known
    try:
        spec.loader.exec_module(module)
    finally:
        sys.dont_write_bytecode = writes
    return cast("GeneratedModule", module)
