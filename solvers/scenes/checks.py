"""What numbers of a scene can and cannot be together."""

from __future__ import annotations

import re
import warnings
from collections.abc import Sequence

import numpy as np

from solvers.equations.module import GeneratedModule
from solvers.io.suggestion import did_you_mean, shortened
from solvers.runge_kutta.catalogue import SCIPY, UnknownMethodError, load

#: Samples that fit into memory, and the finest accuracy.
MOST_SAMPLES, FINEST = 1_000_001, 1e-13
#: Condition of the mass matrix from which on digits are lost, and none is left.
DOUBTFUL, SINGULAR = 1e12, 1e15
PICTURE = re.compile(r"(\w+(?:, *\w+)*) +over +(\w+)\Z")


class MassMatrixWarning(UserWarning):
    """The mass matrix is nearly singular: digits are lost."""


def check_masses(module: GeneratedModule, params: Sequence[float], y0: Sequence[float]) -> None:
    """Refuse coordinates that hardly move mass: those that are absent do not move any.

    Parameters
    ----------
    module : module
        A generated module.
    params, y0 : sequence of float
        In the order of ``module.PARAMETERS`` and ``module.STATE``.

    Raises
    ------
    ValueError
        When the mass matrix is singular to rounding.

    Warns
    -----
    MassMatrixWarning
        When it nearly is.
    """
    n = len(module.COORDINATES)
    worst, weakest = 0.0, ""
    for place in (y0, [y0[0]] * n + [0.0] * n):  # where it begins; and all aligned
        M = np.array(module.mass_matrix(0.0, place, params))
        if not np.isfinite(M).all():
            raise ValueError("the mass matrix is not finite: numbers are too large")
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


def check_method(
    module: GeneratedModule, method: object, form: object, step: float | None, duration: float
) -> None:
    """Refuse a method, form and step that do not go together.

    Parameters
    ----------
    module : module
        A generated module.
    method, form : object
        Their names, or None.
    step : float or None
        In s.
    duration : float
        Of the scene in s.

    Raises
    ------
    ValueError
        With what is allowed.
    """
    known = [name for name in module.FORMS if name != "variational"]
    if form is not None and form not in known:
        raise ValueError(f"form = {str(form)[:50]!r} must be one of {', '.join(known)}")
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
    try:
        tableau = load(method)
    except UnknownMethodError as error:
        raise ValueError(str(error)) from error
    if not tableau.is_explicit and form == "rational":
        raise ValueError(f"method = {method!r} needs a Jacobian: not form = 'rational'")


def check_pictures(pictures: Sequence[str], state: Sequence[str]) -> None:
    """Refuse pictures of what is not there.

    Parameters
    ----------
    pictures : sequence of str
        Such as ``theta1 over t``.
    state : sequence of str
        Components of the state.

    Raises
    ------
    ValueError
        With what can be drawn.
    """
    known = ("t", *state)
    for picture in pictures:
        names, over = curves_of(picture)
        if picture not in ("path", "energy") and not {*names, over} <= set(known):
            raise ValueError(
                f"pictures name {picture[:50]!r}: write 'path', 'energy' or such as "
                f"'{state[0]} over t', of {', '.join(known)}"
            )


def curves_of(picture: str) -> tuple[list[str], str]:
    """What is drawn over what; nothing over nothing where that is not said."""
    found = PICTURE.match(picture)
    return (re.split(", *", found[1]), found[2]) if found else ([], "")


def check_outputs(outputs: Sequence[str], state: Sequence[str], known: Sequence[str]) -> None:
    """Refuse to be asked for what is not there, or for no part of the state.

    Parameters
    ----------
    outputs : sequence of str
        What is asked for.
    state : sequence of str
        Components of the state.
    known : sequence of str
        All that can be asked for.

    Raises
    ------
    ValueError
        With what there is.
    """
    for name in outputs:
        if name not in known:
            raise ValueError(
                f"outputs name {name[:50]!r}{did_you_mean(name, known)}: known are "
                f"{', '.join(known)}"
            )
    if not set(outputs) & set(state):
        raise ValueError(
            f"outputs = {list(outputs)} names no part of the state: add one of {', '.join(state)}"
        )


def check_samples(value: object) -> None:
    """Refuse what is no number of samples.

    Parameters
    ----------
    value : object
        How many are asked for.

    Raises
    ------
    ValueError
        With what is allowed.
    """
    if isinstance(value, bool) or not isinstance(value, int) or not 2 <= value <= MOST_SAMPLES:
        raise ValueError(
            f"samples = {shortened(value)} must be a whole number from 2 to {MOST_SAMPLES}"
        )


def check_accuracy(accuracy: float) -> None:
    """Refuse what numbers cannot resolve.

    Parameters
    ----------
    accuracy : float
        How large errors may be.

    Raises
    ------
    ValueError
        With the finest accuracy.
    """
    if accuracy < FINEST:
        raise ValueError(f"accuracy = {accuracy} is below {FINEST}, what numbers resolve")


def check_params(module: GeneratedModule, params: Sequence[float]) -> None:
    """Refuse negative masses, lengths and stiffnesses.

    Parameters
    ----------
    module : module
        A generated module.
    params : sequence of float
        In the order of ``module.PARAMETERS``.

    Raises
    ------
    ValueError
        With the name of the first.
    """
    for name, value in zip(module.PARAMETERS, params, strict=True):
        if name in module.POSITIVE and value < 0:
            raise ValueError(f"{name} = {value} must be positive, in {module.UNITS[name]}")


def check_choice(name: str, value: object, allowed: Sequence[str]) -> None:
    """Refuse what is not one of a few words, or left out.

    Parameters
    ----------
    name : str
        Of what is chosen.
    value : object
        What somebody chose; None if it is left out.
    allowed : sequence of str
        The words.

    Raises
    ------
    ValueError
        With these words.
    """
    if value is not None and value not in allowed:
        raise ValueError(
            f"{name} = {str(value)[:50]!r} must be {' or '.join(map(repr, allowed))}, or be left "
            "out"
        )
