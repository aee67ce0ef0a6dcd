"""The generated code: its text and the cost of each function."""

from __future__ import annotations

import inspect
from html import escape

from derive.commands.derive import planned
from solvers.app.demo.html import details, table
from solvers.app.demo.stage import Number, Stage
from solvers.equations.module import GeneratedModule

#: Functions whose costs the page lists, with descriptions.
FUNCTIONS = {
    "rhs": "Lagrangian form",
    "rhs_hamiltonian": "Hamiltonian form",
    "rhs_rational": "rational form, in sines and cosines",
    "rhs_variational": "rational form with a small perturbation",
    "jacobian": "derivatives of the Lagrangian form by the state",
    "energy": "energy",
}
#: Functions whose costs the terminal text lists, and functions whose text the page shows.
COUNTED = ("rhs", "rhs_hamiltonian", "jacobian", "energy")
LISTED = ("rhs", "rhs_rational")


def generation(module: GeneratedModule) -> Stage:
    """Compare the generated files with the generator's output and count operations."""
    changed = planned([module.SYSTEM], None).differences()
    state = "differs: run holonomic derive" if changed else "up to date"
    counts = {name: module.OPERATIONS[name][0] for name in FUNCTIONS}
    operations = ", ".join(f"{name} {counts[name]}" for name in COUNTED)
    rows = [(name, FUNCTIONS[name], str(count)) for name, count in counts.items()]
    listings = [
        details(f"{name}, as generated", f"<pre>{escape(_source(module, name))}</pre>")
        for name in LISTED
    ]
    method = "counted in the generated function"
    number = Number(
        "operations of a right-hand side", str(counts["rhs"]), method, "holonomic derive"
    )
    return Stage(
        (f"generated/{module.SYSTEM}.py: {state}", f"operations: {operations}"),
        table(("function", "", "operations a call"), rows) + "".join(listings),
        (number,),
    )


def _source(module: GeneratedModule, name: str) -> str:
    return inspect.getsource(getattr(module, name))
