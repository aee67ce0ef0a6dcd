"""Checks of the numbers and names of a scene; each raises a ValueError that states the remedy."""

from collections.abc import Sequence

import numpy as np

from solvers.equations.module import GeneratedModule, has_perturbation
from solvers.equations.number_checks import real_numbers
from solvers.integration.problem.validation import check_splitting
from solvers.io.suggestion import did_you_mean
from solvers.player.sampled_motion import curves_of
from solvers.runge_kutta.method_catalogue import SCIPY, load

#: Most samples, and the finest accuracy.
MOST_SAMPLES, FINEST = 1_000_001, 1e-13


def check_masses(module: GeneratedModule, params: Sequence[float], y0: Sequence[float]) -> None:
    """Refuse a mass matrix that is not finite, or has no inertia at all."""
    M = np.array(module.mass_matrix(0.0, y0, params))
    if not np.isfinite(M).all():
        raise ValueError("the mass matrix is not finite: numbers are too large")
    if not M.any():
        raise ValueError("no coordinate has inertia")


def check_method(
    module: GeneratedModule, method: object, form: object, step: float | None, duration: float
) -> None:
    """Refuse a method, a form and a step that are unknown or exclude each other."""
    forms = [name for name in module.FORMS if not has_perturbation(name)]
    if form is not None and form not in forms:
        raise ValueError(f"form = {str(form)[:50]!r} must be one of {', '.join(forms)}")
    if step is not None and method is None:
        raise ValueError(f'step = {step} s needs a method: name one, such as method = "rk4"')
    if step is not None and step > duration:
        raise ValueError(f"step = {step} s is longer than the duration, {duration} s")
    if method is None or method in SCIPY:
        if method and step is not None:
            raise ValueError(f"method = {method!r} is SciPy's: it controls its steps")
        return
    if not isinstance(method, str):
        raise ValueError(f"method = {str(method)[:50]} must be text in quotes")
    if load(method).is_splitting:
        check_splitting(module, method, str(form or "lagrangian"))
    if load(method).needs_jacobian and form == "rational":
        raise ValueError(f"method = {method!r} needs a Jacobian: not form = 'rational'")


def check_pictures(pictures: Sequence[str], state: Sequence[str]) -> None:
    """Refuse pictures of quantities that do not exist."""
    known = ("t", *state)
    for picture in pictures:
        names, over = curves_of(picture)
        if picture not in ("path", "energy") and not {*names, over} <= set(known):
            forms = f"'path', 'energy' or such as '{state[0]} over t', of {', '.join(known)}"
            raise ValueError(f"pictures name {picture[:50]!r}: write {forms}")


def check_outputs(outputs: Sequence[str], state: Sequence[str], known: Sequence[str]) -> None:
    """Refuse outputs that do not exist, or that contain no component of the state."""
    for name in outputs:
        if name not in known:
            guess, names = did_you_mean(name, known), ", ".join(known)
            raise ValueError(f"outputs name {name[:50]!r}{guess}: known are {names}")
    if not set(outputs) & set(state):
        text = f"outputs = {list(outputs)} names no component of the state"
        raise ValueError(f"{text}: add one of {', '.join(state)}")


def check_accuracy(accuracy: float) -> None:
    """Refuse more digits than double precision has."""
    if accuracy < FINEST:
        raise ValueError(f"accuracy = {accuracy} is below {FINEST}, the limit of double precision")


def check_choice(name: str, value: object, allowed: Sequence[str]) -> None:
    """Refuse a value that is neither None nor one of the allowed words."""
    if value is not None and value not in allowed:
        words = " or ".join(map(repr, allowed))
        raise ValueError(f"{name} = {str(value)[:50]!r} must be {words}, or be left out")


def sample_times(values: object, duration: float) -> tuple[float, ...]:
    """Increasing times in s of at least two samples, within the duration."""
    times = real_numbers("samples", values, "s")
    allowed = f"times in s that increase, two at least, from 0 to {duration:g} s"
    if times.ndim != 1 or not 2 <= len(times) <= MOST_SAMPLES:
        raise ValueError(f"samples has shape {times.shape}: give a number, or {allowed}")
    wrong = np.flatnonzero((times < 0) | (times > duration) | (np.diff(times, prepend=-1) <= 0))
    if wrong.size:
        raise ValueError(f"samples[{wrong[0]}] = {times[wrong[0]]:g} s: give {allowed}")
    return tuple(times.tolist())
