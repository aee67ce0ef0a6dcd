"""Results of scenes as text, as a note, as JSON and as a table; files, also plots and a page."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from solvers.equations.module import GeneratedModule, named, operations_on_state
from solvers.io.atomic_write import write_text
from solvers.player.player_page import Page
from solvers.player.sampled_motion import SampledMotion, tracks
from solvers.scenes.scene import Scene
from solvers.scenes.scene_run import SceneResult


def summary(result: SceneResult) -> Iterator[str]:
    """Lines on the selected model, the reasons against smaller ones, and the final state."""
    scene, model, state = result.scene, result.selection.model, result.final_state
    label = "" if scene.label == scene.title else f": {scene.label}"
    yield f"{scene.title}{label}, {scene.duration:g} s"
    if scene.completed:
        yield from f"start {scene.completed}".replace("; ", "\n  ").splitlines()
    yield f"model: {model.name}{_integration(result)}"
    yield f"  {model.why}"
    for name, reason in result.selection.declined.items():
        yield f"  not {name}: {reason}"
    met = "" if result.is_met else ": NOT MET, since the scene names the model or the step"
    yield f"error estimate {model.error_estimate:.1e}, requested {scene.accuracy:.0e}{met}"
    error, units = max(model.error_estimate, 1e-16), scene.module.UNITS
    decimals = int(np.clip(np.floor(-np.log10(error)), 0, 15)) if np.isfinite(error) else 0
    numbers = (f"{name} = {x:.{decimals}f} {units[name]}" for name, x in state.items())
    values = ", ".join(number.removesuffix(" 1") for number in numbers)
    no_digit = " (none of these digits is significant)" if model.error_estimate > 1 else ""
    yield f"final state: {values}{no_digit}"
    if result.energy is not None:
        yield f"energy: {result.energy[0]:.9g} J, changes by {np.ptp(result.energy):.1e} J"
    yield _cost(result)


def _integration(result: SceneResult) -> str:
    """Method, form and setting; empty for a closed form."""
    run = result.selection.model.run
    if not run:
        return ""
    text = f" by {result.method}, {result.form} form, {run.setting_name} = {run.setting:.3g}"
    if run.method_choice.is_extended:
        text += f", {run.method_choice.precision} numbers"
    if run.is_compensated:
        text += ", compensated sums"
    if not result.specialised_module:
        return text
    modules = (result.specialised_module, result.scene.module)
    special, general = (_operations(module, run.method_choice.form) for module in modules)
    ratio = result.general_code_seconds / result.work_seconds
    return (
        f"{text}, specialised code ({special} operations instead of {general}, general code takes "
        f"{ratio:.2f} x as long)"
    )


def _operations(module: GeneratedModule, form: str) -> int:
    return operations_on_state(module, named("rhs", form))


def _cost(result: SceneResult) -> str:
    """The time that the model takes, compared with the full equations."""
    seconds, full = result.work_seconds, result.full_equations_seconds
    text = f"cost: {_time(seconds)}, selected in {_time(result.selection_seconds)}"
    if result.method or full < seconds:
        return text
    ratio = f"{full / seconds:.2g} times as long"
    return f"{text}; the full equations take about {_time(full)}, {ratio}"


def _time(seconds: float) -> str:
    if seconds < 1e-3:
        return f"{seconds * 1e6:.3g} µs"
    return f"{seconds * 1e3:.3g} ms" if seconds < 1 else f"{seconds:.3g} s"


def together(results: Sequence[SceneResult]) -> list[SampledMotion]:
    """The motions of a scene and those beside it; the note of the first describes all."""
    motions = [motion for result in results for motion in result.sampled_motions()]
    if len(motions) == 1:
        return motions
    own = " ".join(results[0].scene.note.split())
    notes = (f"[{one.label}: {one.note.rpartition('[')[2]}" for one in motions)
    return [replace(motions[0], note=" ".join(filter(None, [own, *notes]))), *motions[1:]]


def figures(result: SceneResult) -> dict[str, Any]:
    """The same as values for JSON."""
    scene, model = result.scene, result.selection.model
    run = model.run
    return {
        "scene": scene.name,
        "title": scene.title,
        "label": scene.label,
        "model": model.name,
        "method": result.method,
        "form": result.form,
        "setting": {run.setting_name: run.setting} if run else None,
        "precision": run.method_choice.precision if run else None,
        "code": "specialised" if result.specialised_module else "general",
        "operations": _operations(run.motion.module, run.method_choice.form) if run else None,
        "initial_state": dict(zip(scene.module.STATE, scene.y0, strict=True)),
        "completed": scene.completed,
        "final_state": result.final_state,
        "units": {name: scene.module.UNITS[name] for name in result.final_state},
        "duration": scene.duration,
        "requested_accuracy": scene.accuracy,
        "error_estimate": model.error_estimate,
        "accuracy_met": result.is_met,
        "why": model.why,
        "declined_models": result.selection.declined,
        "selection_seconds": result.selection_seconds,
        "work_seconds": result.work_seconds,
        "full_equations_seconds": result.full_equations_seconds,
        "general_code_seconds": result.general_code_seconds,
    }


def table(result: SceneResult) -> str:
    """Times and requested outputs as comma-separated values, with units in the first line."""
    module = result.scene.module
    columns = {"t": result.t, **dict(zip(module.STATE, result.y, strict=True))}
    units = {"t": "s", **module.UNITS, "energy": "J"}
    if result.energy is not None:
        columns["energy"] = result.energy
    names = ["t", *(name for name in columns if name in result.scene.outputs)]
    lines = [",".join(f"{name} [{units[name]}]" for name in names)]
    rows = zip(*(columns[name].tolist() for name in names), strict=True)
    lines += [",".join(map(repr, row)) for row in rows]
    return "\n".join(lines) + "\n"


def file_names(scene: Scene, runs: int, *, plot: bool) -> dict[str, str]:
    """Names of the files of a scene with a number of runs, by their contents.

    There is a plot on request, and where the scene specifies its ``pictures``.
    """
    endings = {"table": ".csv", "page": ".html"}
    if plot or scene.pictures:
        endings["picture"] = ".png"
    endings |= {f"table {n}": f"_{n}.csv" for n in range(2, runs + 1)}
    return {contents: f"{scene.name}{ending}" for contents, ending in endings.items()}


def write_files(
    results: Sequence[SceneResult], folder: Path, equations: str = "", *, plot: bool = False
) -> dict[str, Path]:
    """Write tables, a page and plots of a scene and the scenes beside it; return their paths.

    Parameters
    ----------
    results : sequence of SceneResult
        The scene's own, then those of the scenes beside it.
    folder : pathlib.Path
        The folder of the files.
    equations : str, optional
        The equations of motion, HTML, which the page shows.
    plot : bool, optional
        Whether a scene without ``pictures`` is plotted, too; these load Matplotlib.
    """
    scene = results[0].scene
    names = file_names(scene, len(results), plot=plot)
    paths = {contents: folder / name for contents, name in names.items()}
    motions = together(results)
    if "picture" in paths:
        from solvers.io.figures import save
        from solvers.player.motion_plots import figure

        save(figure(motions), paths["picture"])
    write_text(paths["table"], table(results[0]))
    for n, result in enumerate(results[1:], 2):
        write_text(paths[f"table {n}"], table(result))
    if module := results[0].specialised_module:
        paths["code"] = Path(module.__file__ or "")
    page = Page(scene.title, motions[0].note, tracks(motions), equations)
    page.write(paths["page"])
    return paths
