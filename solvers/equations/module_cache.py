"""Modules that are generated when somebody asks for them, and kept in the cache."""

from __future__ import annotations

import hashlib
import sys
import tempfile
from collections.abc import Callable, Mapping
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType

from solvers.io.build_cache import (
    BUILD_PREFIX,
    cache_folder,
    is_intact,
    move_into_place,
    remove_abandoned,
    write_digests,
)

#: Seconds after which what a killed process left behind is removed.
ABANDONED = 600.0


def cached_module(name: str, key: str, texts: Callable[[], Mapping[str, str]]) -> ModuleType:
    """A module from the cache, or newly generated.

    Parameters
    ----------
    name : str
        Of the module; its files are called so.
    key : str
        All that decides what is in it.
    texts : callable
        Generates it, as texts by file name; called where the cache does not have it.

    Returns
    -------
    module
        A new one at every call; ``sys.modules`` does not know it.

    Raises
    ------
    OSError
        When it cannot be written to the cache.
    """
    digest = hashlib.sha256(key.encode()).hexdigest()[:32]
    folder = cache_folder()
    place = folder / f"module-{digest}"
    if not is_intact(place):
        _write(folder, place, texts())
    return _loaded(place / f"{name}.py", f"holonomic_{digest}.{name}")


def _write(folder: Path, place: Path, texts: Mapping[str, str]) -> None:
    remove_abandoned(folder, ABANDONED)
    with tempfile.TemporaryDirectory(prefix=BUILD_PREFIX, dir=folder) as name:
        ready = Path(name) / "ready"
        ready.mkdir(mode=0o700)
        for file, text in texts.items():
            (ready / file).write_text(text, encoding="utf-8")
        write_digests(ready)
        complaint = move_into_place(ready, place, Path(name))
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
