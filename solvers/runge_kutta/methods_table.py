"""The table of methods in the README, derived from the catalogue."""

from math import inf

from solvers.runge_kutta.catalogue import load, names
from solvers.runge_kutta.stability_function import StabilityFunction
from solvers.runge_kutta.tableau import Tableau


def methods_table() -> str:
    """All methods as a table in Markdown, explicit ones first, by order.

    One with variable order has several orders, but the stability of its fixed steps.
    """
    by_name = {name: load(name) for name in names()}
    ranked = sorted(by_name, key=lambda name: (not by_name[name].is_explicit, by_name[name].order))
    header = "| name | method | kind | order | embedded | stages | real axis | imaginary axis |"
    rows = [_row(name, by_name[name]) for name in ranked]
    return "\n".join([header, "|" + "---|" * 8, *rows, ""])


def _row(name: str, tableau: Tableau) -> str:
    stability = StabilityFunction.of(tableau)
    real, imaginary = stability.real_stability_interval, stability.imaginary_stability_interval
    kind = "explicit" if tableau.is_explicit else "implicit"
    members = tableau.members
    orders = ([m.order for m in members], [m.embedded_order for m in members])
    numbers = [_joined(values) for values in (*orders, [m.stages for m in members])]
    limits = ("∞" if x == inf else f"{x:.2f}" for x in (real, imaginary))
    return f"| {' | '.join(map(str, (f'`{name}`', tableau.title, kind, *numbers, *limits)))} |"


def _joined(numbers: list[int]) -> str:
    """Numbers in ascending order, without zeros."""
    return ", ".join(str(number) for number in sorted(numbers) if number)
