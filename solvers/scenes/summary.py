"""Answers as text, as JSON and as a table."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from solvers.equations.module import GeneratedModule, operations_on_state
from solvers.scenes.models.full_equations import Full
from solvers.scenes.run import SceneResult


def summary(result: SceneResult) -> Iterator[str]:
    """What was chosen, why, and where the motion ends."""
    scene, model = result.scene, result.selection.model
    named = "" if scene.label == scene.title else f": {scene.label}"
    yield f"{scene.title}{named}, {scene.duration:g} s"
    yield f"model: {model.name}{how(result)}"
    yield f"  {model.why}"
    for name, reason in result.selection.declined.items():
        yield f"  not {name}: {reason}"
    met = "" if result.is_met else ": NOT MET, since it is named how"
    yield f"error estimate {model.error_estimate:.1e}, asked {scene.accuracy:.0e}{met}"
    digits = trusted(result)
    yield (
        "final state: "
        + ", ".join(
            f"{name} = {digits(value)} {scene.module.UNITS[name]}"
            for name, value in result.final_state.items()
        )
        + (" (no digit of it can be trusted)" if model.error_estimate > 1 else "")
    )
    if result.energy is not None:
        yield f"energy: {result.energy[0]:.9g} J, changes by {np.ptp(result.energy):.1e} J"
    yield cost(result)


def trusted(result: SceneResult) -> Callable[[float], str]:
    """A function that writes a number with the digits that its error leaves."""
    error = max(result.selection.model.error_estimate, 1e-16)
    decimals = int(np.clip(np.floor(-np.log10(error)), 0, 15)) if np.isfinite(error) else 0
    return lambda value: f"{value:.{decimals}f}"


def how(result: SceneResult) -> str:
    """Method and form, if it was integrated."""
    model = result.selection.model
    if not isinstance(model, Full):
        return ""
    setting = _setting(result, model)
    code = f", {_code(result, model)}" if is_specialised(result) else ""
    return f" by {result.method}, {result.form} form, {setting} = {model.setting:.3g}{code}"


def _setting(result: SceneResult, model: Full) -> str:
    if model.method_choice.is_series:
        return "digits"
    is_fixed = model.method_choice.is_fixed or result.scene.step is not None
    return "h" if is_fixed else "rtol"


def is_specialised(result: SceneResult) -> bool:
    """Whether code was made for this scene alone."""
    return special_code(result) is not None


def special_code(result: SceneResult) -> Path | None:
    """The file of code that was made for this scene alone; None if there is none."""
    model = result.selection.model
    if not isinstance(model, Full) or model.asked.module is result.scene.module:
        return None
    return Path(model.asked.module.__file__ or "")


def _code(result: SceneResult, model: Full) -> str:
    """What specialised code saves."""
    special, general = (
        _operations(module, model.method_choice.form)
        for module in (model.asked.module, result.scene.module)
    )
    return (
        f"specialised code ({special} operations instead of {general}, general code takes "
        f"{result.general_seconds / result.work_seconds:.2f} x as long)"
    )


def _operations(module: GeneratedModule, form: str) -> int:
    return operations_on_state(module, "rhs" if form == "lagrangian" else f"rhs_{form}")


def cost(result: SceneResult) -> str:
    """What the model takes, beside the full equations."""
    took = f"cost: {_time(result.work_seconds)}, chosen in {_time(result.choosing_seconds)}"
    if isinstance(result.selection.model, Full) or result.full_seconds < result.work_seconds:
        return took
    return (
        f"{took}; the full equations take about {_time(result.full_seconds)}, "
        f"{result.full_seconds / result.work_seconds:.2g} times as long"
    )


def _time(seconds: float) -> str:
    if seconds < 1e-3:
        return f"{seconds * 1e6:.3g} us"
    return f"{seconds * 1e3:.3g} ms" if seconds < 1 else f"{seconds:.3g} s"


def figures(result: SceneResult) -> dict[str, Any]:
    """The same for programs."""
    model = result.selection.model
    return {
        "scene": result.scene.name,
        "title": result.scene.title,
        "label": result.scene.label,
        "model": model.name,
        "method": result.method,
        "form": result.form,
        "setting": {_setting(result, model): model.setting} if isinstance(model, Full) else None,
        "code": "specialised" if is_specialised(result) else "general",
        "operations": _operations(model.asked.module, model.method_choice.form)
        if isinstance(model, Full)
        else None,
        "general_seconds": result.general_seconds,
        "final_state": result.final_state,
        "units": {name: result.scene.module.UNITS[name] for name in result.final_state},
        "duration": result.scene.duration,
        "accuracy_asked": result.scene.accuracy,
        "error_estimate": model.error_estimate,
        "accuracy_met": result.is_met,
        "why": model.why,
        "declined": result.selection.declined,
        "choosing_seconds": result.choosing_seconds,
        "work_seconds": result.work_seconds,
        "full_seconds": result.full_seconds,
    }


def table(result: SceneResult) -> str:
    """Times and what was asked for, as comma-separated values with units in the first line."""
    module = result.scene.module
    columns = {"t": result.t, **dict(zip(module.STATE, result.y, strict=True))}
    units = {"t": "s", **module.UNITS, "energy": "J"}
    if result.energy is not None:
        columns["energy"] = result.energy
    kept = ["t", *(name for name in columns if name in result.scene.outputs)]
    lines = [",".join(f"{name} [{units[name]}]" for name in kept)]
    rows = zip(*(columns[name].tolist() for name in kept), strict=True)
    lines += [",".join(map(repr, row)) for row in rows]
    return "\n".join(lines) + "\n"
