"""The derivation of the double pendulum, and the code that is generated from it."""

import inspect
from html import escape

from derive import Derivation, load
from derive.codegen.module_summary import broken_sum
from derive.commands.regenerate import planned
from derive.verification.report.derivation_beside_report import compare_steps
from derive.verification.report.report_judgement import equation_by_id, verdict
from solvers.app.demo.stage import ReportedNumber, Stage, details, table
from solvers.equations.module import GeneratedModule
from solvers.runge_kutta.order_conditions import order

#: Columns of a formula on the terminal.
WIDTH = 67
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


def derivation() -> Stage:
    """Derive the equations of motion, and show them beside the equations of the report."""
    double = Derivation(load("double_pendulum"))
    rows = double.mass_matrix.tolist()
    first, second = double.forcing
    steps = compare_steps(double, lambda name: verdict(equation_by_id(name), order))
    lines = (
        *broken_sum(f"L = {double.lagrangian}", WIDTH).splitlines(),
        f"M = {rows[0]}",
        f"    {rows[1]}",
        "and M qddot = (f1, f2) with",
        *broken_sum(f"f1 = {first}", WIDTH).splitlines(),
        *broken_sum(f"f2 = {second}", WIDTH).splitlines(),
    )
    return Stage(lines, "".join(step.section for step in steps))


def generation(module: GeneratedModule) -> Stage:
    """Compare the generated files with the generator's output and count operations."""
    changed = planned([module.SYSTEM], None).differences()
    state = "differs: run holonomic derive" if changed else "up to date"
    counts = {name: str(module.OPERATIONS[name][0]) for name in FUNCTIONS}
    operations = ", ".join(f"{name} {counts[name]}" for name in COUNTED)
    rows = [(name, FUNCTIONS[name], count) for name, count in counts.items()]
    html = table(("function", "", "operations a call"), rows)
    for name in LISTED:
        source = escape(inspect.getsource(getattr(module, name)))
        html += details(f"{name}, as generated", f"<pre>{source}</pre>")
    quantity, method = "operations of a right-hand side", "counted in the generated function"
    return Stage(
        (f"generated/{module.SYSTEM}.py: {state}", f"operations: {operations}"),
        html,
        (ReportedNumber(quantity, counts["rhs"], method, "holonomic derive"),),
    )
