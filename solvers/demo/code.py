"""The generated code as people see it: its text, and what each form costs."""

from __future__ import annotations

import inspect
import re
from html import escape
from types import ModuleType

from solvers.demo.html import opened, table

#: Functions whose costs are listed, and what they are.
FUNCTIONS = {
    "rhs": "Lagrange's form",
    "rhs_hamiltonian": "Hamilton's form",
    "rhs_rational": "rational form, in sines and cosines",
    "rhs_variational": "rational form, with a small change carried along",
    "jacobian": "derivatives of Lagrange's form by the state",
    "energy": "energy",
}


def operations(module: ModuleType, function: str) -> int:
    """What a function says of itself: additions, multiplications, divisions and calls.

    Parameters
    ----------
    module : module
        A generated module.
    function : str
        One of its functions, such as ``rhs``.

    Returns
    -------
    int
        Operations a call.

    Raises
    ------
    ValueError
        When the function does not say: then the module must be generated anew.
    """
    words = inspect.getdoc(getattr(module, function)) or ""
    found = re.search(r"(\d+) operations", words)
    if not found:
        raise ValueError(f"{module.__name__}.{function} states no operations: generate it anew")
    return int(found[1])


def listing(module: ModuleType) -> str:
    """Costs of the functions, and the text of two of them."""
    rows = [(name, words, str(operations(module, name))) for name, words in FUNCTIONS.items()]
    return table(("function", "", "operations a call"), rows) + "".join(
        opened(f"{name}, as it was generated",
               f"<pre>{escape(inspect.getsource(getattr(module, name)))}</pre>")
        for name in ("rhs", "rhs_rational")
    )  # fmt: skip
