"""The command ``holonomic``: the one module that joins derivations, generated code and solvers."""

from __future__ import annotations

import argparse
import json
import sys
import warnings
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import asdict
from importlib import import_module
from importlib.metadata import version
from types import ModuleType
from typing import TYPE_CHECKING, Any

from solvers.app.modules import load as load_module
from solvers.app.modules import specialiser

if TYPE_CHECKING:
    from solvers.app.demo.station import Station

USAGE = """\
usage: holonomic COMMAND [OPTION ...]
       holonomic --version

Positions in, motion out: equations of motion derived, verified, generated and integrated.

commands:
  systems    list the systems that ship, with drawings
  derive     write the generated modules from the systems' positions, or check them
  verify     judge every equation, program and claim of the double-pendulum report
  demo       the whole way, on one screen and on one page
  run        scenes, with the smallest model that is good enough
  sweep      maps of very many motions: flips, exponents, sections
  chart      what each method, form and backend costs for an error
  stability  how long steps may be, exact and measured, and where methods fail
  bench      time compiled loops beside other programs, at equal error

holonomic COMMAND --help shows a command's options and an example.
"""


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command; return 0 done, 1 check failed, 2 input, 3 numerics, 4 files, 130 interrupt."""
    arguments = list(sys.argv[1:] if argv is None else argv)
    if not arguments or arguments[0] in ("-h", "--help"):
        print(USAGE, end="")
        return 0
    if arguments[0] == "--version":
        print(f"holonomic {version('holonomic')}")
        return 0
    name, *rest = arguments
    warnings.filterwarnings("default", message="integrating in Python")
    warnings.showwarning = _telling_once(name)
    if name not in COMMANDS:
        print(f"holonomic: unknown command {name[:50]!r}\n\n{USAGE}", end="", file=sys.stderr)
        return 2
    try:
        return COMMANDS[name](rest)
    except KeyboardInterrupt:
        return 130
    except BrokenPipeError:
        sys.stderr.close()  # the reader has gone: nothing to tell, and nobody to tell it to
        return 0
    except ValueError as error:
        print(f"holonomic {name}: {error}", file=sys.stderr)
        return 2
    except (ArithmeticError, MemoryError) as error:
        print(f"holonomic {name}: {error}", file=sys.stderr)
        return 3
    except OSError as error:
        print(f"holonomic {name}: {error}", file=sys.stderr)
        return 4


def _telling_once(name: str) -> Callable[..., None]:
    """Show warnings as lines of a command, each once: a command integrates many times."""
    told: set[str] = set()

    def show(message: Warning | str, *_: object) -> None:
        text = f"holonomic {name}: {message}"
        if text not in told:
            told.add(text)
            print(text, file=sys.stderr)

    return show


def _derive(argv: Sequence[str]) -> int:
    from derive.commands.derive import main as derive

    return derive(argv)


def _systems(argv: Sequence[str]) -> int:
    from derive.commands.systems import main as systems

    return systems(argv)


def _verify(argv: Sequence[str]) -> int:
    parser = argparse.ArgumentParser(
        prog="holonomic verify",
        description="Judge hand derivations: the double-pendulum report with its programs and "
        "claims, or anybody's equations. Exits with 1 if an equation is wrong; of the report, if "
        "it cannot be corrected.",
        epilog="examples:\n  holonomic verify --json > verdicts.json\n"
        "  holonomic verify my_equations.toml\n  holonomic verify swinging_atwood",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--json", action="store_true", help="print JSON instead of tables")
    parser.add_argument(
        "equations", nargs="*", metavar="EQUATIONS",
        help="TOML files, or systems whose published equations ship; the report",
    )  # fmt: skip
    arguments = parser.parse_args(argv)
    as_json = arguments.json
    if arguments.equations:
        from derive.commands.verify import verify

        return verify(arguments.equations, as_json=as_json)
    from solvers.io.progress import Progress

    with Progress() as tell:
        tell("judging the report")
        judged = judgement()
    if as_json:
        print(json.dumps(judged, indent=2, ensure_ascii=False))
    else:
        from solvers.app.tables import report

        print(report(judged), end="")
    return int(any(equation["verdict"] == "wrong" for equation in judged["equations"]))


def judgement() -> dict[str, Any]:
    """The verdicts on the report's equations, programs and claims, ready for JSON."""
    import generated.double_pendulum as double_pendulum
    from derive.verification.report.contexts import NUMBERS
    from derive.verification.report.judgement import verdicts
    from derive.verification.report.programs import PROSE, programs
    from solvers.app.verdict.claims import claims
    from solvers.app.verdict.evidence import Evidence, Setting
    from solvers.app.verdict.objectives import objectives, recommendations
    from solvers.runge_kutta.order_conditions import order

    def setting(scene: Any) -> Setting:
        values = [*scene.masses, *scene.lengths, scene.gravity]
        start = [*scene.angles, *scene.velocities]
        return Setting(tuple(map(float, values)), tuple(map(float, start)), float(scene.duration))

    found = programs()
    evidence = Evidence(
        double_pendulum, setting(PROSE), *(setting(program.scene) for program in found)
    )
    equations = verdicts(order)
    counts = Counter(verdict.verdict for verdict in equations)
    found_claims = [*objectives(evidence, counts), *claims(evidence), *recommendations(evidence)]
    return {
        "state": NUMBERS,
        "equations": [asdict(verdict) for verdict in equations],
        "programs": [
            {k: v for k, v in asdict(program).items() if k != "scene"} for program in found
        ],
        "claims": [asdict(claim) for claim in found_claims],
    }


def _demo(argv: Sequence[str]) -> int:
    from derive.verification.report.beside import STYLE
    from solvers.app.commands.demo import main as demo

    stations = {"derive": _derived, "verify": _verified, "generate": _generated}
    return demo(argv, load_module, stations, STYLE)


def _derived() -> Station:
    from derive import Derivation, load
    from derive.codegen.summary import broken_sum
    from derive.verification.report.beside import beside
    from derive.verification.report.judgement import named, verdict
    from solvers.app.commands.demo import WIDTH
    from solvers.app.demo.station import Station
    from solvers.runge_kutta.order_conditions import order

    derivation = Derivation(load("double_pendulum"))
    first, second = derivation.forcing
    every = beside(derivation, lambda name: verdict(named(name), order))
    return Station(
        (
            *broken_sum(f"L = {derivation.lagrangian}", WIDTH).splitlines(),
            f"M = {derivation.mass_matrix.tolist()[0]}",
            f"    {derivation.mass_matrix.tolist()[1]}",
            "and M qddot = (f1, f2) with",
            *broken_sum(f"f1 = {first}", WIDTH).splitlines(),
            *broken_sum(f"f2 = {second}", WIDTH).splitlines(),
        ),
        "".join(one.section for one in every),
    )


def _verified() -> Station:
    from derive.verification.report.beside import line
    from derive.verification.report.equation import Verdict
    from solvers.app.demo.station import Number, Station
    from solvers.app.demo.verdicts import verdicts
    from solvers.app.tables import counted

    judged = judgement()
    misprints = [
        line(Verdict(**row)) for row in judged["equations"] if row["verdict"] == "misprint"
    ]
    equations, claims = counted(judged["equations"]), counted(judged["claims"])
    return Station(
        (
            f"equations of the report: {equations}",
            f"objectives, claims and recommendations: {claims}",
            f"programs: {len(judged['programs'])}, of them "
            f"{sum(bool(program['stops']) for program in judged['programs'])} would not run as "
            "printed",
            "which and why, and the corrections: holonomic verify",
        ),
        verdicts(judged, misprints),
        (
            Number("equations of the report", equations,
                   "proved or refuted symbolically, and in numbers with 40 digits",
                   "holonomic verify"),
            Number("claims of the report", claims, "computed", "holonomic verify"),
        ),
    )  # fmt: skip


def _generated() -> Station:
    import generated.double_pendulum as dp
    from derive.commands.derive import planned
    from solvers.app.demo.code import listing
    from solvers.app.demo.station import Number, Station

    tree = planned(["double_pendulum"], None)
    state = "differs: run holonomic derive" if tree.differences() else "up to date"
    counts = {
        name: dp.OPERATIONS[name][0] for name in ("rhs", "rhs_hamiltonian", "jacobian", "energy")
    }
    return Station(
        (
            f"generated/double_pendulum.py: {state}",
            f"operations: {', '.join(f'{name} {n}' for name, n in counts.items())}",
        ),
        listing(dp),
        (
            Number("operations of a right-hand side", str(counts["rhs"]),
                   "counted in the generated function", "holonomic derive"),
        ),
    )  # fmt: skip


def _package(name: str) -> ModuleType | None:
    try:
        return import_module(name)
    except ImportError:
        return None


def _chart(argv: Sequence[str]) -> int:
    from solvers.app.commands.chart import main as chart

    return chart(argv, load_module, _package)


def _stability(argv: Sequence[str]) -> int:
    from solvers.app.commands.stability import main as stability

    return stability(argv, load_module)


def _run(argv: Sequence[str]) -> int:
    from solvers.app.commands.run import main as run

    return run(argv, load_module, specialiser)


def _sweep(argv: Sequence[str]) -> int:
    from solvers.app.commands.sweep import main as sweep

    return sweep(argv, load_module, _package)


def _bench(argv: Sequence[str]) -> int:
    import sympy

    from derive import Derivation, load
    from solvers.app.derivation_timing import chain, lagranges_method, mechanics
    from solvers.studies.benchmarks.table import main as bench

    def lambdified() -> Callable[..., Any]:
        derivation = Derivation(load("double_pendulum"))
        system = derivation.system
        rates = [*system.qdot, *derivation.accelerations]
        return sympy.lambdify([[*system.q, *system.qdot], system.params], rates, "numpy")

    def peer(name: str) -> ModuleType:
        found = _package(name)
        if found is None:
            raise OSError(f"{name} is not installed: pip install -e '.[bench]'")
        return found

    return bench(argv, load_module, lambdified, peer, chain, lagranges_method, mechanics)


COMMANDS: dict[str, Callable[[Sequence[str]], int]] = {
    "systems": _systems,
    "derive": _derive,
    "verify": _verify,
    "demo": _demo,
    "run": _run,
    "sweep": _sweep,
    "chart": _chart,
    "stability": _stability,
    "bench": _bench,
}
