"""Fits of parameters to measurements: the equations decide which of them can be unknown."""

import re
from collections.abc import Collection, Mapping, Sequence
from functools import cache
from os import PathLike, fspath
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from solvers.app.modules import generator_text, load, system_of
from solvers.app.scenes import load_scene
from solvers.equations.module import GeneratedModule, motion_times
from solvers.equations.module import inputs as input_names
from solvers.equations.module_cache import cached_module
from solvers.equations.signature_checks import checked
from solvers.integration.problem import validation
from solvers.io.suggestion import did_you_mean
from solvers.scenes.fitting import measurement_tables, prediction
from solvers.scenes.fitting.fitted_model import Fit, fitted
from solvers.scenes.fitting.measurement import (
    Interpolation,
    Measurement,
    Outputs,
    check_inputs,
)
from solvers.scenes.fitting.prediction import ModelComparison
from solvers.scenes.scene import Scene

if TYPE_CHECKING:
    from derive.mechanics.identifiability import Identifiability

#: A measurement, its columns by their heads, or the path of a file with them.
Data: TypeAlias = Measurement | Mapping[str, ArrayLike] | str | PathLike[str]
#: What is fitted: a scene, or a system, which has no first guess of the start.
Model: TypeAlias = Scene | GeneratedModule | str | PathLike[str]


@checked
def fit(
    model: Model,
    data: Data | Sequence[Data],
    unknown: Sequence[str] | None = None,
    *,
    params: Mapping[str, float] | None = None,
    inputs: Interpolation = "linear",
) -> Fit:
    """Fit parameters of a system to measured motions.

    Parameters
    ----------
    model : Scene, module, str or path
        A scene, whose parameters and initial state are the first guess, or a system; or the name
        or file of one.
    data : Measurement, mapping, path, or sequence of these
        One run or several. Columns are named ``t`` and by components of the state, ``energy``,
        positions of masses (``x1``, ``y1``, ``x2`` ...), or formulas of these; units are in
        brackets, as in ``theta1 [deg]``, and SI units otherwise. NaN and empty cells are gaps.
        Columns of inputs, such as a motor's torque, drive the motion.
    unknown : sequence of str, optional
        Names of the unknown parameters; by default all that the columns determine, where ``g`` is
        held first.
    params : mapping of str to float, optional
        Values of known parameters and first guesses of unknown ones, instead of the scene's.
        Inputs without a column are constant, and 0 by default.
    inputs : {'linear', 'held'}, optional
        How inputs act between their values: each until the next one, as those of a digital
        controller; or linearly, with their mean from each row to the next, so that the error is of
        second order in the interval.

    Returns
    -------
    Fit
        Values with confidence intervals, correlations, noise and residuals.

    Raises
    ------
    ValueError
        When a name is unknown, data are invalid or too few, or the columns determine only a
        combination of unknown parameters, which the message names.
    ArithmeticError
        When no fit is found from the first guess.

    Examples
    --------
    >>> import numpy as np
    >>> import generated.single_pendulum as sp
    >>> from solvers import fit, integrate
    >>> t = np.arange(0, 5, 1 / 30)
    >>> motion = integrate(sp, (0, 5), {"theta": 1.0}, {"l": 0.7}, t_eval=t)
    >>> noise = np.random.default_rng(0).normal(size=len(t))
    >>> result = fit(sp, {"t": t, "theta [deg]": np.degrees(motion.y[0]) + noise})
    >>> result
    Fit of single_pendulum to 1 run: l = 0.700832 ± 0.00063
    """
    module, start, values = _model(model)
    guesses = validation.parameters(module, values | dict(params or {}))
    values = dict(zip(module.PARAMETERS, guesses.tolist(), strict=True))
    check_inputs(runs := _measurements(module, data, inputs))
    outputs = outputs_of(module, runs)
    names, held = _unknown(module, outputs, unknown, values, runs[0].inputs)
    return fitted(outputs, runs, names, values, start, held)


@checked
def compare(
    fits: Mapping[str, Fit], kept: Data | Sequence[Data], *, inputs: Interpolation = "linear"
) -> ModelComparison:
    """Compare fitted models by their predictions of runs that were kept back.

    Parameters
    ----------
    fits : mapping of str to Fit
        Fits of models to the same runs, by name.
    kept : Measurement, mapping, path, or sequence of these
        Runs that were not fitted. The first half of each gives its start, the second half is
        predicted.
    inputs : {'linear', 'held'}, optional
        How inputs of these runs act between their values, as in `fit`.

    Returns
    -------
    Comparison
        The models with the errors of their predictions, and as ``selected`` the one with the fewest
        unknown parameters that predicts as well as the best, within two standard errors.

    Examples
    --------
    >>> import numpy as np
    >>> import generated.driven_pendulum as driven
    >>> from solvers import compare, fit, integrate
    >>> def swing(theta, seed):
    ...     t = np.arange(0, 9, 1 / 30)
    ...     motion = integrate(driven, (0, 9), {"theta": theta}, {"a": 0, "c": 0.05}, t_eval=t)
    ...     noise = np.random.default_rng(seed).normal(size=len(t))
    ...     return {"t": t, "theta": motion.y[0] + 0.01 * noise}
    >>> first, second = swing(1.0, 0), swing(1.5, 1)
    >>> fits = {
    ...     "friction": fit(driven, first, ["l", "c"], params={"a": 0}),
    ...     "none": fit(driven, first, ["l"], params={"a": 0, "c": 0}),
    ... }
    >>> print(compare(fits, second).reason)
    friction, with 2 unknown parameters, predicts best; simpler models predict significantly worse
    """
    if not fits:
        raise ValueError("fits = {} must hold one fit or more")
    first = next(iter(fits.values()))
    runs = _measurements(first.outputs.module, kept, inputs)
    return prediction.compared(fits, [(run, None) for run in runs])


@checked
def read_measurement(
    path: str | PathLike[str],
    module: GeneratedModule,
    ignored: Sequence[str] = (),
    *,
    inputs: Interpolation = "linear",
) -> Measurement:
    r"""The measurement of a system's motion in a file with comma-separated values.

    Parameters
    ----------
    path : str or path
        The file, with heads of columns as `fit` describes them.
    module : module
        The generated equations of the system.
    ignored : sequence of str, optional
        Names of columns to leave out.
    inputs : {'linear', 'held'}, optional
        How inputs act between their values, as in `fit`.

    Returns
    -------
    Measurement
        Times, values and inputs in SI units.

    Raises
    ------
    solvers.io.toml_input.InputError
        When there is no such file, or a line, column, unit or time is not valid.

    Examples
    --------
    >>> from pathlib import Path
    >>> import generated.single_pendulum as sp
    >>> from solvers import read_measurement
    >>> text = "t,theta [deg]\n0,57.3\n0.1,\n0.2,40.1\n"
    >>> file = Path("swing.csv").write_text(text)
    >>> read_measurement("swing.csv", sp)
    Measurement of theta: 3 times, 2 values
    """
    run = measurement_tables.read(Path(path), units(module), ignored)
    return _with_inputs(module, run, inputs)


def _with_inputs(
    module: GeneratedModule, run: Measurement, interpolation: Interpolation
) -> Measurement:
    """The measurement of which columns of inputs drive the motion."""
    names = input_names(module)
    for name in run.inputs:
        if name not in names:
            raise ValueError(
                f"{run.name}: {module.SYSTEM} has no input {name!r}{did_you_mean(name, names)}; "
                f"known are {', '.join(names) or 'none'}"
            )
    prescribed = {name.removesuffix("_time") for name in motion_times(module)}
    for name in (*run.values, *run.inputs):
        if any(name in (s, f"{s}_dot", f"{s}_ddot", f"{s}_time") for s in prescribed):
            raise ValueError(
                f"{run.name}: column {name} is of a prescribed motion, which a fit cannot follow: "
                "replace it by a function of time, with derive.with_inputs"
            )
    return run.with_inputs(names, interpolation)


def units(module: GeneratedModule) -> dict[str, str]:
    """Units of the quantities that a column can measure, by name."""
    rows = [f"{axis}{k}" for k in range(1, 1 + _masses(module)) for axis in "xyz"]
    own = {name: module.UNITS[name] for name in (*module.STATE, *input_names(module))}
    return {"energy": "J"} | dict.fromkeys(rows, "m") | own


def _masses(module: GeneratedModule) -> int:
    return len(module.positions(0.0, [1.0] * len(module.STATE), module.DEFAULTS))


def outputs_of(module: GeneratedModule, runs: Sequence[Measurement]) -> Outputs:
    """The quantities that runs measure, as functions of the state."""
    names = tuple(dict.fromkeys(name for run in runs for name in run.values))
    for name in names:
        if used := {*re.findall(r"\w+", name)} & {*runs[0].inputs}:
            raise ValueError(
                f"column {name} contains the input {used.pop()}, which changes: leave it out"
            )
    own = units(module)
    known = tuple(own.get(name, "") for name in names)
    if all(name in module.STATE for name in names):
        return Outputs(names, known, module)
    return Outputs(names, known, module, _formulas(module, names))


@cache
def _formulas(module: GeneratedModule, names: tuple[str, ...]) -> GeneratedModule:
    """The generated functions of quantities that are no components of the state."""
    from derive import Derivation
    from derive.codegen.module_files import output_texts
    from derive.mechanics.linearisation.point import outputs

    derivation = Derivation(system_of(module))
    expressions = outputs(derivation, names)
    key = f"{derivation.system!r}{names}{generator_text()}"
    return cached_module(module.SYSTEM, key, lambda: output_texts(derivation, expressions))


@cache
def _identifiable(
    module: GeneratedModule,
    unknown: tuple[str, ...],
    outputs: tuple[str, ...],
    known: tuple[tuple[str, float], ...],
) -> "Identifiability":
    from derive import Derivation
    from derive.mechanics.specialisation import specialised

    system = specialised(system_of(module), dict(known))
    return Derivation(system).identifiable(unknown, outputs)


def _unknown(
    module: GeneratedModule,
    outputs: Outputs,
    requested: Sequence[str] | None,
    values: Mapping[str, float],
    measured: Collection[str],
) -> tuple[list[str], dict[str, str]]:
    """The unknown parameters, and those that must be held, with reasons.

    The `measured` inputs are known; others have the `values`.
    """
    inputs = input_names(module)
    parameters = [name for name in module.PARAMETERS if name not in inputs]
    if not parameters:
        raise ValueError(f"{module.SYSTEM} has no parameters that a fit could determine")
    for name in requested or ():
        if name not in parameters:
            raise ValueError(
                f"{module.SYSTEM} has no parameter {str(name)[:50]!r}"
                f"{did_you_mean(name, parameters)}; known are {', '.join(parameters)}"
            )
    # a mass or length of 0 is absent
    exist = [name for name in parameters if values[name] or name not in module.POSITIVE]
    names = list(exist if requested is None else dict.fromkeys(requested))
    absent = {name: 0.0 for name in parameters if not values[name] and name not in names}
    constant = {name: values[name] for name in inputs if name not in measured}
    known = tuple((absent | constant).items())
    result = _identifiable(module, tuple(names), outputs.names, known)
    if requested is not None and result.groups:
        raise ValueError(
            f"{', '.join(outputs.names)} cannot determine these unknown parameters: "
            f"{'; '.join(map(str, result.groups))}"
        )
    reasons = {name: group.reason for group in result.groups for name in group.parameters}
    held = {name: reasons[name] for name in result.to_hold(["g"])}
    return [name for name in names if name not in held], held


def _model(model: Model) -> tuple[GeneratedModule, np.ndarray, dict[str, float]]:
    """Module, and first guesses of start and parameters."""
    if isinstance(model, str | PathLike):
        model = named_model(fspath(model))
    if isinstance(model, Scene):
        pairs = zip(model.module.PARAMETERS, model.params, strict=True)
        return model.module, np.array(model.y0), dict(pairs)
    rest = [float(name in model.POSITIVE) for name in model.STATE]
    return model, np.array(rest), dict(zip(model.PARAMETERS, model.DEFAULTS, strict=True))


def named_model(name: str) -> Scene | GeneratedModule:
    """The scene or system of this name, or in this file."""
    from solvers.io.toml_input import QUANTITY_HINT, read_table
    from solvers.scenes.scene_reading import names

    if name in names():
        return load_scene(name)
    if name.endswith(".toml"):
        path = Path(name)
        is_system = path.is_file() and "masses" in read_table(path, QUANTITY_HINT)
        return load(name) if is_system else load_scene(name)
    try:
        return load(name)
    except LookupError as error:
        known = ", ".join(names())
        raise ValueError(
            f"{error.args[0]}; scenes are {known}; your own files end in .toml"
        ) from None


def _measurements(
    module: GeneratedModule, data: Data | Sequence[Data], interpolation: Interpolation
) -> list[Measurement]:
    items = [data] if isinstance(data, Measurement | Mapping | str | PathLike) else [*data]
    if not items:
        raise ValueError("data = [] must hold one run or more")
    return [_measurement(module, item, interpolation) for item in items]


def _measurement(module: GeneratedModule, item: Data, interpolation: Interpolation) -> Measurement:
    match item:
        case Measurement():
            return _with_inputs(module, item, interpolation)
        case Mapping():
            run = measurement_tables.measurement(item, units(module))
            return _with_inputs(module, run, interpolation)
    return read_measurement(item, module, inputs=interpolation)
