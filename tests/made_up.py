"""A system that is nothing but its right-hand side."""

from types import ModuleType


def made_up(rhs: object) -> ModuleType:
    """A module with one coordinate whose right-hand side is `rhs`."""
    module = ModuleType("made_up")
    module.__dict__.update(COORDINATES=("x",), STATE=("x", "x_dot"), PARAMETERS=("a",), rhs=rhs)
    return module
