"""The structure of the packages: floors, arrows and circles of every folder; repeated names.

``python tests/helpers/structure.py`` prints them.
"""

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[2]
PACKAGES = ("derive", "solvers", "notebooks/benchmarks")
#: Folders of which each file is found by its name.
REGISTERS = (
    *("backends", "commands", "formats", "languages", "maps", "methods", "models", "systems"),
    "targets",
)
Arrows = dict[str, set[str]]


@cache
def imported_names(path: Path) -> tuple[str, ...]:
    """Dotted names that a file imports, in functions and for type checkers, too."""
    names: list[str] = []
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module:
            names += [f"{node.module}.{alias.name}" for alias in node.names]
    return tuple(names)


@cache
def imported_files(path: Path) -> frozenset[Path]:
    """Files of the project that a file imports."""
    root = next(folder for folder in path.parents if (folder / "solvers").is_dir())
    found = set()
    for name in imported_names(path):
        parts = name.split(".")
        for length in (len(parts), len(parts) - 1):
            places = [place.joinpath(*parts[:length]) for place in (root, root / "notebooks")]
            files = [file for one in places if (file := one.with_suffix(".py")).is_file()]
            if length and files:
                found |= {*files} - {path}
                break
    return frozenset(found)


def arrows_within(folder: Path) -> Arrows:
    """Which files and folders of a folder import which others of it."""

    def part(path: Path) -> str:
        return path.relative_to(folder).parts[0].removesuffix(".py")

    arrows: Arrows = {}
    for path in sorted(folder.rglob("*.py")):
        if path.name != "__init__.py":
            inside = (file for file in imported_files(path) if file.is_relative_to(folder))
            arrows.setdefault(part(path), set()).update({*map(part, inside)} - {part(path)})
    return arrows


def circles(arrows: Arrows) -> list[list[str]]:
    """Groups of parts that import each other, directly or through others."""
    reached = {start: {*_reached(arrows, start)} for start in arrows}
    groups = {
        tuple(sorted(other for other in reached[one] if one in reached.get(other, ())))
        for one in arrows
        if one in reached[one]
    }
    return [[*group] for group in sorted(groups)]


def _reached(arrows: Arrows, start: str) -> Iterator[str]:
    waiting, seen = [*arrows.get(start, ())], set[str]()
    while waiting:
        one = waiting.pop()
        if one not in seen:
            seen.add(one)
            yield one
            waiting += arrows.get(one, ())


def floors(arrows: Arrows) -> int:
    """The length of the longest chain of imports; parts of a circle are on one floor."""
    together = {part: tuple(group) for group in circles(arrows) for part in group}

    @cache
    def floor(part: str) -> int:
        group = together.get(part, (part,))
        below = {other for one in group for other in arrows.get(one, ())} - {*group}
        return 1 + max(map(floor, below), default=0)

    return max(map(floor, arrows), default=0)


@dataclass(frozen=True)
class Folder:
    """The structure of a folder."""

    path: Path
    files: int  # in the folder itself
    lines: int
    floors: int  # of its files and folders
    arrows: int
    circles: list[list[str]]

    @classmethod
    def of(cls, path: Path) -> "Folder":
        """The structure of the folder of this path."""
        files = [one for one in path.glob("*.py") if one.name != "__init__.py"]
        lines = sum(len(one.read_text(encoding="utf-8").splitlines()) for one in files)
        arrows = arrows_within(path)
        count = sum(map(len, arrows.values()))
        return cls(path, len(files), lines, floors(arrows), count, circles(arrows))


def folders(package: str) -> list[Folder]:
    """The structure of a package and of all folders in it."""
    paths = {path.parent for path in (ROOT / package).rglob("*.py")}
    return [Folder.of(path) for path in sorted(paths)]


def repeated_names() -> dict[str, list[str]]:
    """Names of classes, and of files, that stand in more than one file, with these files.

    Names of files in a register are those of its entries, such as a format.
    """
    paths: dict[str, list[str]] = {}
    for package in ("derive", "solvers"):
        for path in sorted((ROOT / package).rglob("*.py")):
            tree = ast.parse(path.read_text(encoding="utf-8"))
            names = [node.name for node in tree.body if isinstance(node, ast.ClassDef)]
            if path.name != "__init__.py" and path.parent.name not in REGISTERS:
                names.append(path.name)
            for name in names:
                paths.setdefault(name, []).append(path.relative_to(ROOT).as_posix())
    return {name: files for name, files in paths.items() if files[1:]}


def repeated_definitions(tree: ast.Module) -> list[str]:
    """Names that a file defines twice at its top level: the last value is that of all uses."""
    names = [node.name for node in tree.body if isinstance(node, ast.FunctionDef | ast.ClassDef)]
    for node in tree.body:
        if isinstance(node, ast.Assign | ast.AnnAssign):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            parts = (part for target in targets for part in ast.walk(target))
            stored = (one for one in parts if isinstance(one, ast.Name))
            names += [one.id for one in stored if isinstance(one.ctx, ast.Store)]
    return sorted({name for name in names if names.count(name) > 1})


def main() -> None:
    """Print a table, and the names that are repeated."""
    rows = [row for package in PACKAGES for row in folders(package)]
    print("folder                              files   lines  floors  arrows  circles")
    for row in rows:
        name, groups = row.path.relative_to(ROOT).as_posix(), "; ".join(map(" ".join, row.circles))
        numbers = f"{row.files:>5}{row.lines:>8}{row.floors:>8}{row.arrows:>8}  {groups}"
        print(f"{name:<36}{numbers}".rstrip())
    files, lines = sum(row.files for row in rows), sum(row.lines for row in rows)
    print(f"{'all':<36}{files:>5}{lines:>8}")
    for name, places in repeated_names().items():
        print(f"{name} stands in {', '.join(places)}")


if __name__ == "__main__":
    main()
