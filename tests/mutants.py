"""Whether the tests notice mistakes: plants them one at a time, and runs the tests of the line.

A mistake is a change of one operator, number or condition in a line of Python or C, chosen at
random in every room. A first run of the tests on a copy of the project, in which each chosen place
reports when it is reached, yields the tests that reach it. Each mistake is then planted in another
copy, where these tests run, and after them those of its room. With ``--long``, mistakes that none
of them notices are tried with the long tests of the room, with the long cases of these tests, and
with the long tests of their files, if few other places are reached by them.
Reported are the mistakes that no test notices. ``make mutants`` runs this.
"""

import argparse
import ast
import os
import random
import re
import shutil
import subprocess
import sys
import time
from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from queue import SimpleQueue
from tempfile import TemporaryDirectory

ROOT = Path(__file__).parents[1]
#: Seconds after which a test that does not end has noticed a mistake.
TIMEOUT = 100
#: Most tests of a line, half of them those that reach few other lines, half those that reach many.
MOST_TESTS = 120
#: Most of these whose files are run with all their long tests.
MOST_FILES = 10
#: Options for the tests that are in the long part alone.
LONG = ("--long", "-m", "long and not campaign")
#: Exit codes of pytest: all tests passed, and there was none.
PASSED = (0, 5)
#: Folders of tests that have not the name of the room.
OTHER_FOLDERS = {"derive/commands": "app"}
#: Folders of tests of C code: of the loops, and of mock-up units, which are exported.
C_FOLDERS = {"solvers": "integration", "derive": "app"}
#: Fields of nodes of Python that hold no code of the program.
OTHER_FIELDS = ("annotation", "returns", "type_params", "decorator_list")
#: Systems, which are data, compared with other sources as a whole.
LEFT_OUT = ("derive/systems/",)
#: Arguments that change no result: checks of lengths, and the style of drawings and of output.
STYLE = ("strict", "flush", "zorder", "alpha", "linewidth", "fontsize", "markersize", "pad", "dpi",
    "indent")  # fmt: skip
#: Comparisons with another value at equality.
COMPARISONS = {ast.Lt: "<=", ast.LtE: "<", ast.Gt: ">=", ast.GtE: ">"}
OPERATORS = {ast.Add: "-", ast.Sub: "+", ast.Mult: "/", ast.Div: "*", ast.FloorDiv: "*",
    ast.Pow: "*", ast.Mod: "+", ast.MatMult: "*"}  # fmt: skip
#: Pieces of a line of C and what replaces them.
C_PIECES = {
    r" \+ ": " - ", r" - ": " + ", r"(?<=\w)\*(?=\w)": "/", r"(?<=; \w) < ": " <= ",
    r" < ": " >= ", r" <= ": " > ", r" > ": " <= ", r" >= ": " < ", r" == ": " != ",
    r" != ": " == ", r" && ": " || ",
    r" \|\| ": " && ", r"\+\+": "--", r" \+= ": " -= ", r"\b0\.5\b": "0.6", r"\b2\.0\b": "3.0",
    r"\blane_fabs\(": "(", r"\bfabs\(": "(", r" & ~": " & ", r"(?<= = )-(?=\w)": "",
    r"\b1\.0\b": "2.0", r"\[0\]": "[1]",
}  # fmt: skip
#: A module that Python loads at its start: it notes the tests that reach a place.
PROBE = """
import builtins, os
_last = {}
def _reached(number):
    test = os.environ.get("PYTEST_CURRENT_TEST", "")
    if _last.get(number) != test:
        _last[number] = test
        with open(os.path.join(os.environ["REACHED"], str(number)), "a", encoding="utf-8") as file:
            file.write(test.rpartition(" (")[0] + "\\n")
builtins._reached = _reached
"""
#: A plugin of pytest that selects the tests of a file, without those that fail anyway.
SELECTION = """
import os
from pathlib import Path
SELECTED, FAILED = (os.environ.get(name) for name in ("SELECTED", "FAILED"))
def lines(path):
    return Path(path).read_text(encoding="utf-8").splitlines() if path else []
def pytest_collection_modifyitems(config, items):
    order, failed = {name: k for k, name in enumerate(lines(SELECTED))}, set(lines(FAILED))
    def place(one):  # of the test, or of all its cases
        return order.get(one.nodeid, order.get(one.nodeid.partition("[")[0]))
    chosen = [one for one in items if one.nodeid not in failed]
    if order:
        chosen = sorted((one for one in chosen if place(one) is not None), key=place)
    items[:] = chosen
def pytest_runtest_logreport(report):
    if report.failed and "REACHED" in os.environ:
        with open(os.path.join(os.environ["REACHED"], "failed"), "a", encoding="utf-8") as file:
            file.write(report.nodeid + "\\n")
"""


@dataclass(frozen=True)
class Mutant:
    """A mistake in one line of a file; columns count bytes."""

    file: str
    line: int
    start: int
    end: int
    text: str

    @property
    def folder(self) -> str:
        """The folder of the tests of its room."""
        if self.room == "C":
            return C_FOLDERS[self.file.partition("/")[0]]
        return OTHER_FOLDERS.get(self.room, self.room.rpartition("/")[2])

    @property
    def room(self) -> str:
        """The room of the file, such as ``solvers/scenes``, or that of the C code."""
        return "C" if self.file.endswith((".h", ".c")) else "/".join(self.file.split("/")[:2])

    def applied(self, lines: Sequence[bytes], text: str | None = None) -> bytes:
        """The changed line."""
        line, new = lines[self.line - 1], (self.text if text is None else text).encode()
        return line[: self.start] + new + line[self.end :]

    def __str__(self) -> str:
        lines = (ROOT / self.file).read_bytes().splitlines()
        before = lines[self.line - 1].decode().strip()
        return (
            f"{self.file}:{self.line}\n    - {before}\n    + {self.applied(lines).decode().strip()}"
        )


def python_mutants(file: str) -> Iterator[Mutant]:
    """All mistakes that are planted in a Python file."""
    source = (ROOT / file).read_bytes()
    lines = source.splitlines()

    def visit(node: ast.AST) -> Iterator[ast.AST]:
        yield node
        for name, value in ast.iter_fields(node):
            if name in OTHER_FIELDS or isinstance(node, ast.JoinedStr):
                continue
            for child in value if isinstance(value, list) else [value]:
                is_style = isinstance(child, ast.keyword) and child.arg in STYLE
                is_code = isinstance(child, ast.AST) and not isinstance(child, ast.pattern)
                if is_code and not is_style:
                    yield from visit(child)

    for node in visit(ast.parse(source)):
        if not isinstance(node, ast.expr) or node.lineno != node.end_lineno:
            continue
        start, end = node.col_offset, node.end_col_offset
        assert end is not None
        own = lines[node.lineno - 1][start:end].decode()
        for new in replacements(node, own, lines[node.lineno - 1]):
            yield Mutant(file, node.lineno, start, end, new)


def replacements(node: ast.expr, own: str, line: bytes) -> Iterator[str]:
    """Other texts of an expression."""

    def part(one: ast.expr) -> str:
        return line[one.col_offset : one.end_col_offset].decode()

    match node:
        case ast.Compare(left=left, ops=[op], comparators=[right]):
            yield f"(not {own})"
            if type(op) in COMPARISONS and (is_count(left) or is_count(right)):
                yield f"({part(left)} {COMPARISONS[type(op)]} {part(right)})"
        case ast.BinOp(left=left, op=op, right=right) if type(op) in OPERATORS:
            is_text = any(isinstance(x, ast.Constant | ast.JoinedStr) and not isinstance(
                getattr(x, "value", ""), int | float) for x in (left, right))  # fmt: skip
            if not is_text:
                yield f"(({part(left)}) {OPERATORS[type(op)]} ({part(right)}))"
        case ast.BoolOp(op=op, values=values):
            word = " or " if isinstance(op, ast.And) else " and "
            yield f"({word.join(f'({part(value)})' for value in values)})"
        case ast.UnaryOp(op=ast.Not() | ast.USub(), operand=operand):
            yield f"({part(operand)})"
        case ast.Call(func=ast.Name(id="abs" | "sorted" | "reversed"), args=[argument]):
            yield f"({part(argument)})"
        case ast.Constant(value=bool()):
            yield str(not node.value)
        case ast.Constant(value=int() | float()):
            yield f"({own} + 1)"
        case ast.IfExp(test=test, body=body, orelse=orelse):
            yield f"({part(orelse)} if {part(test)} else {part(body)})"


def is_count(node: ast.expr) -> bool:
    """Whether an expression is a whole number; other numbers are hardly ever equal."""
    match node:
        case ast.Constant(value=value):
            return type(value) is int
        case ast.Call(func=ast.Name(id=name)):
            return name in ("len", "int")
    return False


def c_mutants(file: str) -> Iterator[Mutant]:
    """All mistakes that are planted in a file of C."""
    text = (ROOT / file).read_text(encoding="utf-8")
    code = re.sub(r"/\*.*?\*/", lambda m: re.sub(r"[^\n]", " ", m[0]), text, flags=re.DOTALL)
    for number, line in enumerate(code.splitlines(), 1):
        if line.lstrip().startswith("#") or not line.isascii() or line.startswith("enum"):
            continue
        for piece, new in C_PIECES.items():
            for found in re.finditer(piece, line):
                yield Mutant(file, number, found.start(), found.end(), new)


def chosen(count: int, seed: int) -> list[Mutant]:
    """Random mistakes, as many in each room as in the others, at most one in a line."""
    everywhere: dict[str, dict[tuple[str, int], list[Mutant]]] = defaultdict(dict)
    files = subprocess.check_output(["git", "ls-files", "derive", "solvers"], cwd=ROOT, text=True)
    for file in files.splitlines():
        kinds = {".py": python_mutants, ".h": c_mutants, ".c": c_mutants}
        is_code = file.count("/") > 1 and not file.startswith(LEFT_OUT)
        if is_code and (kind := kinds.get(Path(file).suffix)):
            for mutant in kind(file):
                place = (file, mutant.line)
                everywhere[mutant.room].setdefault(place, []).append(mutant)
    rng = random.Random(seed)
    rooms = sorted(everywhere)
    shares = Counter(rooms * (count // (len(rooms) + 1)))
    shares["C"] *= 2
    shares.update(rng.sample(rooms, count % (len(rooms) + 1) % len(rooms)))
    return [
        rng.choice(lines[place])
        for room in rooms
        for lines in [everywhere[room]]
        for place in rng.sample(sorted(lines), min(shares[room], len(lines)))
    ]


def copy(folder: Path) -> Path:
    """A copy of the project, whose tests import it and nothing else of the project."""
    files = subprocess.check_output(["git", "ls-files"], cwd=ROOT, text=True).splitlines()
    for file in files:
        (folder / file).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(ROOT / file, folder / file)
    (folder / "selection.py").write_text(SELECTION)
    if (beside := ROOT.parent / "shared").exists() and not (folder.parent / "shared").exists():
        (folder.parent / "shared").symlink_to(beside)
    return folder


def pytest(project: Path, *arguments: str, **environment: str) -> int:
    """The exit code of the tests of a copy."""
    own = {"PYTHONPATH": str(project), "XDG_CACHE_HOME": str(project.parent / "cache")}
    limits = f"timeout={TIMEOUT}", f"faulthandler_timeout={TIMEOUT + 20}"
    options = ["-q", "-p", "no:cacheprovider", *(f"--override-ini={limit}" for limit in limits)]
    command = [sys.executable, "-m", "pytest", *options, "-p", "selection", *arguments]
    quiet = subprocess.DEVNULL
    return subprocess.run(command, cwd=project, env=os.environ | own | environment,
        stdout=quiet, stderr=quiet, stdin=quiet, check=False).returncode  # fmt: skip


def reaching(mutants: Sequence[Mutant], place: Path) -> list[list[str]]:
    """Short tests that reach each mistake in Python, first those that reach few others."""
    project, reached = copy(place / "probed"), place / "reached"
    reached.mkdir()
    (project / "sitecustomize.py").write_text(PROBE)
    sites = sorted(enumerate(mutants), key=lambda one: (one[1].file, one[1].line, one[1].start))
    for number, mutant in reversed(sites):  # from the end of a line
        if mutant.room != "C":
            lines = (project / mutant.file).read_bytes().splitlines()
            own = lines[mutant.line - 1][mutant.start : mutant.end].decode()
            lines[mutant.line - 1] = mutant.applied(lines, f"(_reached({number}) or ({own}))")
            (project / mutant.file).write_bytes(b"\n".join(lines) + b"\n")
    outside: dict[tuple[str, int], list[str]] = defaultdict(list)
    for number, mutant in enumerate(mutants):
        for start in starts_of_functions(mutant):
            outside[mutant.file, start].append(f"_reached({number}); ")
    for (name, start), probes in sorted(outside.items(), reverse=True):
        lines = (project / name).read_bytes().splitlines()
        indent = len(lines[start - 1]) - len(lines[start - 1].lstrip())
        lines.insert(start - 1, b" " * indent + "".join(probes).encode())
        (project / name).write_bytes(b"\n".join(lines) + b"\n")
    workers = ("--numprocesses", str(processors()), "--dist", "worksteal")
    (reached / "failed").touch()
    pytest(project, *workers, REACHED=str(reached))
    failed = without_probes(place)
    print(f"{len(failed)} tests fail without a mistake and do not count", flush=True)
    tests = [
        [*dict.fromkeys(filter(None, (reached / str(n)).read_text().splitlines()))]
        if (reached / str(n)).exists() else []
        for n in range(len(mutants))
    ]  # fmt: skip
    frequency = Counter(test for names in tests for test in names)
    for names in tests:
        names.sort(key=frequency.__getitem__)
        del names[MOST_TESTS // 2 : -MOST_TESTS // 2]
    return tests


def processors() -> int:
    """The number of processors that this process may use."""
    affinity = getattr(os, "sched_getaffinity", None)
    return len(affinity(0)) if affinity else os.cpu_count() or 1


def without_probes(place: Path) -> list[str]:
    """Tests that fail in a copy without probes too; some only examine the text of the code."""
    failed, again = place / "reached" / "failed", place / "again"
    again.write_text(failed.read_text(encoding="utf-8"), encoding="utf-8")
    failed.write_text("", encoding="utf-8")
    if tests := {*again.read_text(encoding="utf-8").splitlines()}:
        files = sorted({test.partition("::")[0] for test in tests})
        pytest(copy(place / "clean"), *files, SELECTED=str(again), REACHED=str(failed.parent))
    return sorted({*failed.read_text(encoding="utf-8").splitlines()})


def starts_of_functions(mutant: Mutant) -> list[int]:
    """Lines at which functions of the file start, if the mistake is outside of functions.

    Python runs its line once a process, and all functions of the file may depend on it.
    """
    starts: list[int] = []
    if mutant.room == "C":
        return starts
    for node in ast.walk(ast.parse((ROOT / mutant.file).read_bytes())):
        if isinstance(node, ast.FunctionDef):
            body = node.body[1:] if ast.get_docstring(node) is not None else node.body
            if node.body[0].lineno <= mutant.line <= (node.end_lineno or 0):
                return []
            if body and body[0].lineno > node.lineno:
                first = body[0]
                decorators = getattr(first, "decorator_list", None) or [first]
                starts.append(min(one.lineno for one in decorators))
    return starts


def is_noticed(mutant: Mutant, tests: Sequence[str], project: Path, options: Sequence[str]) -> bool:
    """Whether a test fails with a mistake in a copy, which is undone, and not without it."""
    path, place = project / mutant.file, project.parents[1]
    original, before = path.read_bytes(), place / "reached" / "failed"
    lines = original.splitlines()
    lines[mutant.line - 1] = mutant.applied(lines)
    changed = b"\n".join(lines) + b"\n"
    selected, reached = project.parent / "selected", project.parent / "reached"
    selected.write_text("\n".join(tests), encoding="utf-8")
    reached.mkdir(exist_ok=True)
    room = project / "tests" / mutant.folder
    of_tests = [test.partition("::")[0] for test in tests]
    parts = [({"SELECTED": str(selected)}, sorted({*of_tests})), ({}, [str(room)] * room.is_dir())]
    if options:  # the long tests beside short ones that reach the line and few others
        parts.append(({}, sorted({*of_tests[:MOST_FILES]})))
    for chosen, files in parts:
        if not files:
            continue
        failed = reached / "failed"
        failed.unlink(missing_ok=True)
        path.write_bytes(changed)
        environment = {**chosen, "FAILED": str(before), "REACHED": str(reached)}
        code = pytest(project, "-x", *options, *files, **environment)
        path.write_bytes(original)
        if code not in PASSED:
            first = failed.read_text(encoding="utf-8").splitlines()[:1] if failed.exists() else []
            if not first or not options or pytest(project, *options, *first) in PASSED:
                return True
    return False


def main() -> int:
    """Plant mistakes and report those that no test notices."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=200, help="number of mistakes")
    parser.add_argument("--seed", type=int, default=int(time.strftime("%Y%m%d")))
    parser.add_argument("--long", action="store_true", help="try survivors with the long tests")
    parser.add_argument("--only", type=Path, help="file with lines FILE:LINE of mistakes to plant")
    arguments = parser.parse_args()
    mutants = chosen(arguments.count, arguments.seed)
    if arguments.only:
        places = set(arguments.only.read_text(encoding="utf-8").split())
        mutants = [mutant for mutant in mutants if f"{mutant.file}:{mutant.line}" in places]
    print(f"{len(mutants)} mistakes of seed {arguments.seed}", flush=True)
    survivors: dict[str, list[Mutant]] = {"short": [], "long": []}
    with TemporaryDirectory(prefix="mutants-") as folder:
        place = Path(folder)
        tests = reaching(mutants, place)
        projects: SimpleQueue[Path] = SimpleQueue()
        workers = processors()
        for k in range(workers):
            projects.put(copy(place / f"worker{k}" / "holonomic"))

        def tried(number: int) -> None:
            project = projects.get()
            mutant, own = mutants[number], tests[number]
            functions = [*dict.fromkeys(test.partition("[")[0] for test in own)]
            for part, names, options in (("short", own, ()), ("long", functions, LONG)):
                if part == "long" and not arguments.long:
                    break
                if is_noticed(mutant, names, project, options):
                    break
                survivors[part].append(mutant)
                reach = f"reached by {len(own)} short tests"
                print(f"not noticed by the {part} tests, {reach}: {mutant}", flush=True)
            projects.put(project)

        with ThreadPoolExecutor(workers) as pool:
            list(pool.map(tried, range(len(mutants))))
    rooms, missed = (Counter(one.room for one in each) for each in (mutants, survivors["short"]))
    for room in sorted(rooms):
        print(f"{room:<24}{rooms[room] - missed[room]:>4} of {rooms[room]}")
    for part in ("short", "long")[: 1 + arguments.long]:
        found = len(mutants) - len(survivors[part])
        share = f"{found} of {len(mutants)}: {100 * found / len(mutants):.0f} %"
        print(f"noticed up to the {part} tests: {share}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
