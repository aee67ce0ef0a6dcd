"""Answers as text, as JSON and as a table."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from solvers.equations.module import GeneratedModule, operations_on_state
from solvers.scenes.models.full_equations import Full
from solvers.scenes.run import Answer


def told(answer: Answer) -> Iterator[str]:
    """What was chosen, why, and where the motion ends."""
    scene, model = answer.scene, answer.choice.model
    named = "" if scene.label == scene.title else f": {scene.label}"
    yield f"{scene.title}{named}, {scene.duration:g} s"
    yield f"model: {model.name}{how(answer)}"
    yield f"  {model.why}"
    for name, reason in answer.choice.declined.items():
        yield f"  not {name}: {reason}"
    met = "" if answer.is_met else ": NOT MET, since it is named how"
    yield f"error estimate {model.error_estimate:.1e}, asked {scene.accuracy:.0e}{met}"
    digits = trusted(answer)
    yield (
        "final state: "
        + ", ".join(
            f"{name} = {digits(value)} {scene.module.UNITS[name]}"
            for name, value in answer.final_state.items()
        )
        + (" (no digit of it can be trusted)" if model.error_estimate > 1 else "")
    )
    if answer.energy is not None:
        yield f"energy: {answer.energy[0]:.9g} J, changes by {np.ptp(answer.energy):.1e} J"
    yield cost(answer)


def trusted(answer: Answer) -> Callable[[float], str]:
    """A function that writes a number with the digits that its error leaves."""
    error = max(answer.choice.model.error_estimate, 1e-16)
    decimals = int(np.clip(np.floor(-np.log10(error)), 0, 15)) if np.isfinite(error) else 0
    return lambda value: f"{value:.{decimals}f}"


def how(answer: Answer) -> str:
    """Method and form, if it was integrated."""
    model = answer.choice.model
    if not isinstance(model, Full):
        return ""
    setting = _setting(answer, model)
    code = f", {_code(answer, model)}" if is_specialised(answer) else ""
    return f" by {answer.method}, {answer.form} form, {setting} = {model.setting:.3g}{code}"


def _setting(answer: Answer, model: Full) -> str:
    if model.way.is_series:
        return "digits"
    is_fixed = model.way.is_fixed or answer.scene.step is not None
    return "h" if is_fixed else "rtol"


def is_specialised(answer: Answer) -> bool:
    """Whether code was made for this scene alone."""
    return special_code(answer) is not None


def special_code(answer: Answer) -> Path | None:
    """The file of code that was made for this scene alone; None if there is none."""
    model = answer.choice.model
    if not isinstance(model, Full) or model.asked.module is answer.scene.module:
        return None
    return Path(model.asked.module.__file__ or "")


def _code(answer: Answer, model: Full) -> str:
    """What specialised code saves."""
    special, general = (
        _operations(module, model.way.form) for module in (model.asked.module, answer.scene.module)
    )
    return (
        f"specialised code ({special} operations instead of {general}, general code takes "
        f"{answer.general_seconds / answer.work_seconds:.2f} x as long)"
    )


def _operations(module: GeneratedModule, form: str) -> int:
    return operations_on_state(module, "rhs" if form == "lagrangian" else f"rhs_{form}")


def cost(answer: Answer) -> str:
    """What the model takes, beside the full equations."""
    took = f"cost: {_time(answer.work_seconds)}, chosen in {_time(answer.choosing_seconds)}"
    if isinstance(answer.choice.model, Full) or answer.full_seconds < answer.work_seconds:
        return took
    return (
        f"{took}; the full equations take about {_time(answer.full_seconds)}, "
        f"{answer.full_seconds / answer.work_seconds:.2g} times as long"
    )


def _time(seconds: float) -> str:
    if seconds < 1e-3:
        return f"{seconds * 1e6:.3g} us"
    return f"{seconds * 1e3:.3g} ms" if seconds < 1 else f"{seconds:.3g} s"


def figures(answer: Answer) -> dict[str, Any]:
    """The same for programs."""
    model = answer.choice.model
    return {
        "scene": answer.scene.name,
        "title": answer.scene.title,
        "label": answer.scene.label,
        "model": model.name,
        "method": answer.method,
        "form": answer.form,
        "setting": {_setting(answer, model): model.setting} if isinstance(model, Full) else None,
        "code": "specialised" if is_specialised(answer) else "general",
        "operations": _operations(model.asked.module, model.way.form)
        if isinstance(model, Full)
        else None,
        "general_seconds": answer.general_seconds,
        "final_state": answer.final_state,
        "units": {name: answer.scene.module.UNITS[name] for name in answer.final_state},
        "duration": answer.scene.duration,
        "accuracy_asked": answer.scene.accuracy,
        "error_estimate": model.error_estimate,
        "accuracy_met": answer.is_met,
        "why": model.why,
        "declined": answer.choice.declined,
        "choosing_seconds": answer.choosing_seconds,
        "work_seconds": answer.work_seconds,
        "full_seconds": answer.full_seconds,
    }


def table(answer: Answer) -> str:
    """Times and what was asked for, as comma-separated values with units in the first line."""
    module = answer.scene.module
    columns = {"t": answer.t, **dict(zip(module.STATE, answer.y, strict=True))}
    units = {"t": "s", **module.UNITS, "energy": "J"}
    if answer.energy is not None:
        columns["energy"] = answer.energy
    kept = ["t", *(name for name in columns if name in answer.scene.outputs)]
    lines = [",".join(f"{name} [{units[name]}]" for name in kept)]
    rows = zip(*(columns[name].tolist() for name in kept), strict=True)
    lines += [",".join(map(repr, row)) for row in rows]
    return "\n".join(lines) + "\n"
