"""``holonomic fit``."""

from argparse import ArgumentParser, Namespace
from collections.abc import Iterator
from dataclasses import replace
from os import path as paths
from pathlib import Path
from typing import TYPE_CHECKING, Any

from solvers.app.commands import options

if TYPE_CHECKING:
    from solvers.app.fitting import Model
    from solvers.scenes.fitting.fitted_model import Fit
    from solvers.scenes.fitting.measurement import Measurement
    from solvers.scenes.fitting.prediction import ModelComparison

SUMMARY = "fit parameters to measured motions"
#: Part of each run that is kept back to compare models if no run is.
KEPT = 0.25


def add_arguments(parser: ArgumentParser) -> None:
    """Describe the command and its arguments."""
    parser.description = (
        "Fit the parameters of a scene's system to measured motions, with confidence intervals; "
        "write a table, plots, and a scene with the fitted values. Columns of the data are t and "
        "components of the state, energy, positions of masses (x1, y1, x2 ...) or formulas, with "
        "units in brackets: theta1 [deg]. Empty cells are gaps. Columns of inputs, such as a "
        "torque, drive the motion."
    )
    meaning = "a scene or system: a name, or a file that ends in .toml; the first guess"
    action = parser.add_argument("scene", metavar="SCENE", help=meaning)
    options.complete_with(action, "scenes", options.shipped("scenes"))
    meaning = "file with comma-separated values; each file is a run with a start of its own"
    parser.add_argument("data", nargs="+", type=Path, metavar="DATA", help=meaning)
    add = parser.add_argument
    add("--unknown", metavar="NAMES", help="unknown parameters, separated by commas "
        "(default: all that the data determine)")  # fmt: skip
    add("--test", action="append", default=[], type=Path, metavar="DATA",
        help="run to keep back and predict; can be repeated")  # fmt: skip
    add("--compare", action="append", default=[], metavar="NAME=VALUE|SCENE",
        help="also fit a model with parameters held, such as c=0, or another scene or system, and "
        "select by prediction; can be repeated")  # fmt: skip
    add("--inputs", choices=("linear", "held"), default="linear",
        help="how inputs act between values: linearly, or each until the next")  # fmt: skip
    add("--ignore", default="", metavar="NAMES", help="columns to leave out, separated by commas")
    options.add_output(parser, "the table, plots and scene")
    options.add_json(parser)
    options.add_examples(
        parser,
        "holonomic fit pendulum.toml swing.csv",
        "holonomic fit pendulum.toml a.csv b.csv --test c.csv --compare c=0",
        "holonomic fit two_link_arm a.csv --unknown m1,m2 --inputs held --test b.csv",
    )


def run(arguments: Namespace) -> int:
    """Fit, print a summary and write files."""
    from solvers.app.fitting import fit, named_model, read_measurement
    from solvers.io.terminal import Progress
    from solvers.scenes.fitting import fit_summary, prediction
    from solvers.scenes.scene import Scene

    model = named_model(arguments.scene)
    module = model.module if isinstance(model, Scene) else model
    ignored, unknown = _names(arguments.ignore), _names(arguments.unknown or "") or None
    runs, tests = (
        [read_measurement(path, module, ignored, inputs=arguments.inputs) for path in files]
        for files in (arguments.data, arguments.test)
    )
    kept: list[tuple[Measurement, float | None]] = [(one, None) for one in tests]
    fitted = runs
    if arguments.compare and not kept:
        fitted, kept = _divided(runs)
    comparison = None
    with Progress() as report:
        report("fit")
        fits = {arguments.scene: fit(model, fitted, unknown)}
        for text in arguments.compare:
            report(f"fit with {text}")
            fits[text] = _other(text, model, fits[arguments.scene])
        if kept:
            report("predictions")
            comparison = prediction.compared(fits, kept)
            selected = comparison.selected.fit
        else:
            selected = fits[arguments.scene]
        report("plots")
        files = _write(arguments, selected, comparison)
    if arguments.json:
        results: dict[str, Any] = fit_summary.figures(selected)
        if comparison:
            results["comparison"] = fit_summary.comparison_figures(comparison)
        options.print_json(results | {"files": files})
        return 0
    print(*fit_summary.summary(selected), sep="\n")
    if comparison:
        print("", *fit_summary.comparison_lines(comparison), sep="\n")
    print(f"\nfiles: {', '.join(files.values())}")
    return 0


def _names(text: str) -> list[str]:
    return [name for part in text.split(",") if (name := part.strip())]


def _divided(
    runs: "list[Measurement]",
) -> "tuple[list[Measurement], list[tuple[Measurement, float | None]]]":
    """The first parts of runs, and the runs with the times from which they are kept back."""
    begins = [float(run.t[0] + (1 - KEPT) * (run.t[-1] - run.t[0])) for run in runs]
    pairs = [*zip(runs, begins, strict=True)]
    return [run.between(run.t[0], begin) for run, begin in pairs], [*pairs]


def _other(text: str, model: "Model", first: "Fit") -> "Fit":
    """The fit of a model with some parameters held, or of another scene or system."""
    from solvers.app.fitting import fit
    from solvers.io.toml_input import InputError, number

    if "=" not in text:
        return fit(text, first.runs)
    held, unknown, units = {}, first.unknown, first.outputs.module.UNITS
    for part in _names(text):
        name, _, value = part.partition("=")
        if name.strip() not in unknown:
            raise InputError(
                f"--compare {part}: {name.strip()!r} is not one of the unknown parameters, "
                f"{', '.join(unknown)}"
            )
        held[name.strip()] = number(f"--compare {name.strip()}", value.strip(), units[name.strip()])
    other = fit(model, first.runs, [name for name in unknown if name not in held], params=held)
    return replace(other, held={**first.held} | dict.fromkeys(held, "as compared"))


def _write(
    arguments: Namespace, fit: "Fit", comparison: "ModelComparison | None"
) -> dict[str, str]:
    from solvers.io.atomic_write import write_text
    from solvers.io.figures import save
    from solvers.scenes.fitting import fit_plots, fit_summary

    folder, name = arguments.output, f"{Path(arguments.scene).stem}_fit"
    folder.mkdir(parents=True, exist_ok=True)
    data = ", ".join(path.name for path in arguments.data)
    title = f"{Path(arguments.scene).stem} fitted to {data}"
    files = {kind: folder / f"{name}{end}" for kind, end in _endings(comparison)}
    save(fit_plots.figure(fit, title), files["plot"])
    write_text(files["table"], fit_summary.table(fit))
    driven = ", ".join(fit.runs[0].inputs)
    comments = [title, *([f"without {driven}, which the data have over time"] if driven else [])]
    comments += [*(f"{k} = {v.value:.6g} ± {v.error:.2g}" for k, v in fit.intervals.items())]
    write_text(files["scene"], fit_summary.scene_text(fit, _system(arguments, fit), comments))
    if comparison:
        save(fit_plots.prediction_figure(comparison, title), files["predictions"])
    return {kind: str(path) for kind, path in files.items()}


def _endings(comparison: "ModelComparison | None") -> Iterator[tuple[str, str]]:
    yield from (("scene", ".toml"), ("table", ".csv"), ("plot", ".png"))
    if comparison:
        yield "predictions", "_predictions.png"


def _system(arguments: Namespace, fit: "Fit") -> str:
    """The system as the new scene names it: a path is relative to its folder."""
    from solvers.io.toml_input import QUANTITY_HINT, read_table

    if not arguments.scene.endswith(".toml"):
        return fit.outputs.module.SYSTEM
    path = Path(arguments.scene)
    system = read_table(path, QUANTITY_HINT).get("system")
    if system is None:  # the file is that of a system
        return paths.relpath(path, arguments.output)
    if not str(system).endswith(".toml"):
        return str(system)
    return paths.relpath(path.parent / str(system), arguments.output)
