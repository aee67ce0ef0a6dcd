"""``holonomic verify``."""

from argparse import ArgumentParser, Namespace
from pathlib import Path

from solvers.app.commands.options import add_examples, add_json, print_json

SUMMARY = "verify the report, documents, or other hand derivations"


def add_arguments(parser: ArgumentParser) -> None:
    """Describe the command and its arguments."""
    parser.description = (
        "Verify hand derivations: the double-pendulum report with its programs and claims, the "
        "formulas of a document, or equations of your own. The exit code is 1 if an equation is "
        "wrong (in the report, if it has no proved correction), otherwise 2 if an equation or a "
        "file is unreadable, and otherwise 3 if no formula of a document is judged."
    )
    meaning = (
        "documents (.tex, .md, .txt, .rst, .html, .ipynb), programs (.py, .js, .c, .m, .f90, .jl, "
        ".java, .go, .rs), TOML files, or systems with published equations (default: the report)"
    )
    parser.add_argument("equations", nargs="*", metavar="EQUATIONS", help=meaning)
    add_json(parser)
    meaning = (
        "write documents with the verdicts on their formulas: a page (.html), LaTeX (.tex), or a "
        "copy of a document in Markdown or of a notebook"
    )
    parser.add_argument("--annotate", type=Path, metavar="OUT", help=meaning)
    meaning = "the system of documents and programs: a name, or a TOML file"
    parser.add_argument("--system", metavar="SYSTEM", help=meaning)
    meaning = "a TOML file with the system and a table [names] of letters as formulas in its names"
    parser.add_argument("--names", type=Path, metavar="FILE", help=meaning)
    add_examples(
        parser,
        "holonomic verify --json > verdicts.json",
        "holonomic verify my_equations.toml",
        "holonomic verify my_paper.tex --annotate verdicts.html",
        "holonomic verify swinging_atwood",
    )


def run(arguments: Namespace) -> int:
    """Print the verdicts; return 1 if one is wrong, 2 or 3 if some or all are not judged."""
    if arguments.equations or arguments.annotate or arguments.system or arguments.names:
        from derive.commands.source_verdicts import verify
        from derive.verification.documents.letters.hints import hints
        from solvers.runge_kutta.order_conditions import order

        return verify(
            arguments.equations,
            order,
            as_json=arguments.json,
            annotation=arguments.annotate,
            hints=hints(arguments.system, arguments.names),
        )
    from solvers.app.report_verdicts import report_verdicts, tables
    from solvers.io.terminal import Progress

    with Progress() as report:
        report("verifying the report")
        verdicts = report_verdicts()
    if arguments.json:
        print_json(verdicts)
    else:
        print(tables(verdicts), end="")
    return int(any(equation["verdict"] == "wrong" for equation in verdicts["equations"]))
