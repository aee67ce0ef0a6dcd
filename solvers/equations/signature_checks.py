"""Checks of the arguments of public functions, by their names and annotations."""

from collections.abc import Callable, Collection, Iterable, Mapping
from functools import wraps
from inspect import signature
from types import GenericAlias, UnionType
from typing import Any, ParamSpec, TypeVar, Union, cast, get_args, get_origin

import numpy as np

from solvers.equations.module import GeneratedModule
from solvers.io.suggestion import did_you_mean, shortened

P = ParamSpec("P")
R = TypeVar("R")
#: The names of types in messages.
NAMES = {
    "str": "a text",
    "int": "a whole number",
    "PathLike": "a path",
    "Path": "a path",
    "Mapping": "a mapping by name",
}


def check_module(module: object) -> None:
    """Refuse what is not a module, such as the name of a system."""
    _check("module", module, GeneratedModule)


def known_names(function: Callable[P, R]) -> Callable[P, R]:
    """`function`, or a class, which suggests the name of an argument for an unknown one."""
    if isinstance(function, type):
        return _with_init(function, known_names)
    names = [name for name in signature(function).parameters if name != "self"]
    called = function.__qualname__.removesuffix(".__init__")

    @wraps(function)
    def call(*args: P.args, **given: P.kwargs) -> R:
        for name in given:
            if name not in names:
                raise TypeError(
                    f"{called}() has no argument {name!r}{did_you_mean(name, names)}; known are "
                    f"{', '.join(names)}"
                )
        return function(*args, **given)

    return call


def checked(function: Callable[P, R]) -> Callable[P, R]:
    """`function`, or a class, which refuses arguments that its annotations exclude, by name.

    Real numbers and arrays of them are left to the function.
    """
    if isinstance(function, type):
        return _with_init(function, checked)
    parameters = signature(function).parameters
    annotated = (one for one in parameters.values() if one.annotation is not one.empty)
    kinds = {one.name: one.annotation for one in annotated}

    @wraps(function)
    def call(*args: P.args, **given: P.kwargs) -> R:
        for name, value in (*zip(parameters, args, strict=False), *given.items()):
            if name in kinds:
                _check(name, value, kinds[name])
        return function(*args, **given)

    return cast("Callable[P, R]", wraps(function)(known_names(call)))


def _with_init(kind: Any, decorator: Callable[..., Any]) -> Any:
    """A class whose constructor is decorated."""
    kind.__init__ = decorator(kind.__init__)
    return kind


def _check(name: str, value: object, kind: Any) -> None:
    """Raise `ValueError` if a value is not of the annotated kind."""
    if not _fits(value, kind):
        kinds = (one for one in _parts(kind) if one is not type(None))
        allowed = " or ".join(dict.fromkeys(_described(one, value) for one in kinds))
        raise ValueError(f"{name} = {shortened(value)} must be {allowed}")


def _parts(kind: Any) -> tuple[Any, ...]:
    """The members of a union, in their order."""
    return get_args(kind) if get_origin(kind) in (Union, UnionType) else (kind,)


def _fits(value: Any, kind: Any) -> bool:
    """Whether a value may be of a kind; numbers and arrays are not decided here."""
    if (parts := _parts(kind)) != (kind,):
        return any(_fits(value, part) for part in parts)
    origin, arguments = get_origin(kind) or kind, get_args(kind)
    if kind is GeneratedModule:
        return hasattr(value, "PARAMETERS")
    if origin is int:
        is_whole = isinstance(value, int | np.integer) and not isinstance(value, bool)
        return is_whole and abs(value) < 2**63
    if origin is Callable or not isinstance(origin, type) or origin in (bool, float, complex):
        return callable(value) if origin is Callable else True
    if issubclass(origin, Mapping):
        if not isinstance(value, Mapping):
            return False
        _, part = arguments or (str, object)
        return all(isinstance(name, str) and _fits(one, part) for name, one in value.items())
    if issubclass(origin, Iterable) and isinstance(kind, GenericAlias) and arguments:
        is_row = isinstance(value, Iterable) and not isinstance(value, str | bytes | Mapping)
        if not is_row or getattr(value, "ndim", 1) != 1:
            return False
        if not isinstance(value, Collection):  # its parts cannot be read twice
            return True
        return all(_fits(part, arguments[0]) for part in value)
    return isinstance(value, origin)


def _described(kind: Any, value: object) -> str:
    """A kind in words."""
    origin = get_origin(kind) or kind
    if kind is GeneratedModule:
        name = value[:50] if isinstance(value, str) else "double_pendulum"
        return f"a generated module, such as solvers.load({name!r}) returns"
    if origin is Callable:
        return "a function"
    if isinstance(kind, GenericAlias) and not issubclass(origin, Mapping):
        parts = [part.__name__ for part in _parts(get_args(kind)[0])]
        return f"a sequence of {' or '.join('texts' if part == 'str' else part for part in parts)}"
    name = str(getattr(origin, "__name__", origin))
    return NAMES.get(name, f"{'an' if name[0] in 'AEIOU' else 'a'} {name}")
