"""Modules written by hand that keep the contract of generated ones."""

from types import ModuleType


def handwritten(
    name: str, state: tuple[str, ...], parameters: tuple[str, ...] = ("p",), **attributes: object
) -> ModuleType:
    """A module with one form of equations, Lagrange's, and the attributes that are given."""
    module = ModuleType(name)
    contract = {
        "__file__": None,
        "SYSTEM": name,
        "DIGEST": "",
        "COORDINATES": (),
        "STATE": state,
        "FORMS": ("lagrangian",),
        "STATES": {"lagrangian": state},
        "PARAMETERS": parameters,
        "DEFAULTS": (1.0,) * len(parameters),
        "POSITIVE": (),
        "VARIABLES": {"accelerations": state},
        "TIMED": (),
        "CALLS_FUNCTIONS": (),
        "OPERATIONS": {"rhs": (0, 0)},
        "UNITS": dict.fromkeys(state, "1"),
        "rhs": None,
    }
    vars(module).update(contract | attributes)
    return module
