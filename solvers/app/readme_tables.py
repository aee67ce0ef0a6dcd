"""Tables in the READMEs of a repository checkout, rendered from the code they describe."""

import ast
from collections.abc import Callable
from functools import partial
from math import inf
from pathlib import Path

from derive.codegen.module_files import GeneratedFiles
from derive.system.files import system_catalogue
from solvers.runge_kutta.method_catalogue import load, names
from solvers.runge_kutta.stability_function import StabilityFunction
from solvers.runge_kutta.tableau import Tableau
from solvers.scenes.models import model_catalogue
from solvers.sweeps.definition import map_kinds
from solvers.sweeps.results import STATUSES

ROOT = Path(__file__).parents[2]


def status_table() -> str:
    """The numbers of the statuses of motions, as a Markdown table."""
    rows = [f"| {code} | {status} |\n" for code, status in enumerate(STATUSES)]
    return "| number | status |\n|---|---|\n" + "".join(rows)


def contents_table(folder: str) -> str:
    """The rooms and files of a folder with the summaries of their docstrings, in Markdown."""
    files = {f"{path.parent.name}/": path for path in (ROOT / folder).glob("*/__init__.py")}
    files |= {path.name: path for path in (ROOT / folder).glob("[!_]*.py")}
    rows = []
    for name, path in sorted(files.items()):
        text = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or ""
        rows.append(f"| `{name}` | {text.partition(chr(10))[0].removesuffix('.')} |\n")
    return "| file or room | contains |\n|---|---|\n" + "".join(rows)


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


#: The table between the markers ``<!-- title -->`` and ``<!-- end of title -->`` of a README.
TABLES: tuple[tuple[str, str, Callable[[], str]], ...] = (
    ("derive/README.md", "systems", system_catalogue.markdown_table),
    ("derive/verification/README.md", "files", partial(contents_table, "derive/verification")),
    ("solvers/runge_kutta/README.md", "methods", methods_table),
    ("solvers/runge_kutta/README.md", "files", partial(contents_table, "solvers/runge_kutta")),
    ("solvers/scenes/README.md", "models", model_catalogue.markdown_table),
    ("solvers/sweeps/README.md", "map kinds", map_kinds.markdown_table),
    ("solvers/sweeps/README.md", "statuses of motions", status_table),
)


def readmes() -> list[GeneratedFiles]:
    """The READMEs beside the packages, with current tables; none in an installation.

    A `ValueError` names a README without the markers of its table.
    """
    texts: dict[str, str] = {}
    for name, title, table in TABLES:
        if (ROOT / name).is_file():
            text = texts.get(name) or (ROOT / name).read_text(encoding="utf-8")
            start, end = f"<!-- {title} -->\n", f"<!-- end of {title} -->"
            before, _, rest = text.partition(start)
            _, result, after = rest.partition(end)
            if not result:
                raise ValueError(
                    f"{ROOT / name} has no table of {title}: write the lines {start.strip()!r} and "
                    f"{end!r} where it belongs"
                )
            texts[name] = f"{before}{start}{table()}{end}{after}"
    return [GeneratedFiles(ROOT, texts, complete=False)] if texts else []
