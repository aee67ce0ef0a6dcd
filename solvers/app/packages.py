"""Packages that only some commands need."""

from __future__ import annotations

from importlib import import_module
from types import ModuleType


def optional_package(name: str) -> ModuleType | None:
    """A package, or None if it is not installed."""
    try:
        return import_module(name)
    except ImportError:
        return None


def required_package(name: str, extra: str) -> ModuleType:
    """A package; `OSError` names the extra that installs it."""
    package = optional_package(name)
    if package is None:
        raise OSError(f"{name} is not installed: pip install 'holonomic[{extra}]'")
    return package
