"""Checks of the types of arguments, whose messages name the argument."""

from collections.abc import Hashable, Sequence
from types import UnionType
from typing import Any

from solvers.io.suggestion import shortened


def check_type(name: str, value: object, kind: type | UnionType, allowed: str) -> None:
    """Raise `ValueError` if an argument is not of the given kind, which is called `allowed`."""
    if not isinstance(value, kind):
        raise ValueError(f"{name} = {shortened(value)} must be {allowed}")


def check_texts(name: str, values: Any) -> None:
    """Raise `ValueError` if an argument is not a sequence of texts."""
    is_sequence = isinstance(values, Sequence) and not isinstance(values, str)
    if not is_sequence or not all(isinstance(value, str) for value in values):
        raise ValueError(f"{name} = {shortened(values)} must be a sequence of texts")


def check_direction(name: str, value: object) -> None:
    """Raise `ValueError` if an argument is none of the directions 0, 1 and -1."""
    if not isinstance(value, Hashable) or value not in (0, 1, -1):
        raise ValueError(f"{name} = {shortened(value)} must be 0, 1 or -1")
