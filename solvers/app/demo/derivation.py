"""The derivation of the double pendulum beside the equations of the report."""

from __future__ import annotations

from derive import Derivation, load
from derive.codegen.summary import broken_sum
from derive.verification.report.comparison import compare_steps
from derive.verification.report.judgement import equation_by_id, verdict
from solvers.app.demo.stage import Stage
from solvers.runge_kutta.order_conditions import order

#: Columns of a formula on the terminal.
WIDTH = 67


def derivation() -> Stage:
    """Derive the equations of motion."""
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
