"""The generated code as people see it: its text, and what each form costs."""

from __future__ import annotations

import inspect
from html import escape

from solvers.app.demo.html import opened, table
from solvers.equations.module import GeneratedModule

#: Functions whose costs are listed, and what they are.
FUNCTIONS = {
    "rhs": "Lagrange's form",
    "rhs_hamiltonian": "Hamilton's form",
    "rhs_rational": "rational form, in sines and cosines",
    "rhs_variational": "rational form, with a small change carried along",
    "jacobian": "derivatives of Lagrange's form by the state",
    "energy": "energy",
}


def listing(module: GeneratedModule) -> str:
    """Costs of the functions, and the text of two of them."""
    rows = [(name, words, str(module.OPERATIONS[name][0])) for name, words in FUNCTIONS.items()]
    return table(("function", "", "operations a call"), rows) + "".join(
        opened(f"{name}, as it was generated",
               f"<pre>{escape(inspect.getsource(getattr(module, name)))}</pre>")
        for name in ("rhs", "rhs_rational")
    )  # fmt: skip
