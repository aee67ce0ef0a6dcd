"""Tables in the READMEs of a repository checkout, rendered from the code they describe."""

from collections.abc import Callable
from pathlib import Path

from derive.codegen.tree import Tree
from derive.commands import systems
from solvers.runge_kutta.methods_table import methods_table
from solvers.scenes.models import catalogue
from solvers.sweeps import map_kinds
from solvers.sweeps.status import STATUSES

ROOT = Path(__file__).parents[2]


def status_table() -> str:
    """The numbers of the statuses of motions, as a Markdown table."""
    rows = [f"| {code} | {status} |\n" for code, status in enumerate(STATUSES)]
    return "| number | status |\n|---|---|\n" + "".join(rows)


#: The table between the markers ``<!-- title -->`` and ``<!-- end of title -->`` of a README.
TABLES: tuple[tuple[str, str, Callable[[], str]], ...] = (
    ("derive/README.md", "systems", systems.markdown_table),
    ("solvers/runge_kutta/README.md", "methods", methods_table),
    ("solvers/scenes/README.md", "models", catalogue.markdown_table),
    ("solvers/sweeps/README.md", "map kinds", map_kinds.markdown_table),
    ("solvers/sweeps/README.md", "statuses of motions", status_table),
)


def readmes() -> list[Tree]:
    """The READMEs beside the packages, with current tables; none in an installation.

    A `ValueError` names a README without the markers of its table.
    """
    texts: dict[str, str] = {}
    for name, title, table in TABLES:
        if (ROOT / name).is_file():
            text = texts.get(name) or (ROOT / name).read_text(encoding="utf-8")
            start, end = f"<!-- {title} -->\n", f"<!-- end of {title} -->"
            before, _, rest = text.partition(start)
            _, found, after = rest.partition(end)
            if not found:
                raise ValueError(
                    f"{ROOT / name} has no table of {title}: write the lines {start.strip()!r} and "
                    f"{end!r} where it belongs"
                )
            texts[name] = f"{before}{start}{table()}{end}{after}"
    return [Tree(ROOT, texts, complete=False)] if texts else []
