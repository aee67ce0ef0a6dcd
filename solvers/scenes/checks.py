"""What numbers of a scene can and cannot be together."""

from __future__ import annotations

import re
import warnings
from collections.abc import Sequence

import numpy as np

from solvers.catalogue import UnknownMethodError, load
from solvers.forms import FORMS, has_form
from solvers.request import SCIPY
from solvers.scenes.scene import Scene

#: Condition of the mass matrix from which on digits are lost, and none is left.
DOUBTFUL, SINGULAR = 1e12, 1e15
PICTURE = re.compile(r"(\w+(?:, *\w+)*) +over +(\w+)\Z")


class MassMatrixWarning(UserWarning):
    """The mass matrix is nearly singular: digits are lost."""


def check_masses(scene: Scene) -> None:
    """Refuse coordinates that hardly move mass: those that are absent do not move any.

    Raises
    ------
    ValueError
        When the mass matrix is singular to rounding.

    Warns
    -----
    MassMatrixWarning
        When it nearly is.
    """
    module, n = scene.module, len(scene.module.COORDINATES)
    worst, weakest = 0.0, ""
    for place in (scene.y0, (*scene.y0[:1] * n, *[0.0] * n)):  # where it begins; and all aligned
        M = np.array(module.mass_matrix(place, scene.params))
        alive = np.flatnonzero(np.diag(M))
        if not alive.size:
            raise ValueError("no coordinate moves any mass")
        size = np.sqrt(np.diag(M)[alive])
        values, vectors = np.linalg.eigh(M[np.ix_(alive, alive)] / np.outer(size, size))
        condition = float(values[-1] / values[0]) if values[0] > 0 else float("inf")
        if condition > worst:
            worst = condition
            weakest = module.COORDINATES[alive[np.argmax(np.abs(vectors[:, 0]))]]
    said = f"the mass matrix has condition {worst:.0e}: {weakest} hardly moves mass of its own"
    if worst >= SINGULAR:
        raise ValueError(f"{said}; leave that coordinate out, or make masses more alike")
    if worst >= DOUBTFUL:
        warnings.warn(f"{said}; so many digits are lost", MassMatrixWarning, stacklevel=2)


def check_method(scene: Scene) -> None:
    """Refuse a method, form and step that do not go together.

    Raises
    ------
    ValueError
        With what is allowed.
    """
    method, form, step = scene.method, scene.form, scene.step
    if form is not None and not (form in FORMS[:3] and has_form(scene.module, form)):
        known = [name for name in FORMS[:3] if has_form(scene.module, name)]
        raise ValueError(f"form = {str(form)[:50]!r} must be one of {', '.join(known)}")
    if step is not None and method is None:
        raise ValueError(f'step = {step} s needs a method: name one, such as method = "rk4"')
    if step is not None and step > scene.duration:
        raise ValueError(f"step = {step} s is longer than the duration, {scene.duration} s")
    if method is None or method in SCIPY:
        if method and step is not None:
            raise ValueError(f"method = {method!r} is SciPy's: it controls its steps")
        return
    if not isinstance(method, str):
        raise ValueError(f"method = {str(method)[:50]} must be text in quotes")
    try:
        tableau = load(method)
    except UnknownMethodError as error:
        raise ValueError(str(error)) from error
    if step is None and not tableau.b_hat:
        raise ValueError(f"method = {method!r} does not control its steps: give a step, such as "
                         'step = "0.01 s"')  # fmt: skip
    if not tableau.is_explicit and form == "rational":
        raise ValueError(f"method = {method!r} needs a Jacobian: not form = 'rational'")


def check_pictures(pictures: Sequence[str], scene: Scene) -> tuple[str, ...]:
    """Refuse pictures of what is not there.

    Raises
    ------
    ValueError
        With what can be drawn.
    """
    known = ("t", *scene.module.STATE)
    for picture in pictures:
        found = PICTURE.match(picture)
        names = [*re.split(", *", found[1]), found[2]] if found else []
        if picture not in ("path", "energy") and not (names and set(names) <= set(known)):
            raise ValueError(
                f"pictures name {picture[:50]!r}: write 'path', 'energy' or such as "
                f"'{scene.module.STATE[0]} over t', of {', '.join(known)}"
            )
    return tuple(pictures)
