"""Scenes and sweeps by name, by file or as objects."""

from collections.abc import Callable
from os import PathLike, fspath
from pathlib import Path

from solvers.app.modules import load, specialiser
from solvers.equations.signature_checks import checked
from solvers.scenes import scene_run
from solvers.scenes.scene import Scene
from solvers.scenes.scene_reading import find as find_scene
from solvers.scenes.scene_run import SceneResult
from solvers.sweeps.definition import sweep_reading
from solvers.sweeps.definition.sweep import Sweep
from solvers.sweeps.execution import sweep_run as sweeps
from solvers.sweeps.execution.pool import Pool
from solvers.sweeps.results import Results


@checked
def load_scene(name: str | PathLike[str]) -> Scene:
    """The scene of this name, or in this TOML file.

    Parameters
    ----------
    name : str or path
        Name of a scene that ships, such as ``report``, or path of a file that ends in ``.toml``.

    Returns
    -------
    Scene
        With the scenes beside it; ``dataclasses.replace`` changes single fields.

    Raises
    ------
    solvers.io.toml_input.InputError
        If there is no such scene, or its file has a mistake.

    Examples
    --------
    >>> from solvers import load_scene
    >>> load_scene("report").duration
    5.0
    """
    return find_scene(fspath(name), load)


@checked
def run_scene(scene: Scene | str | PathLike[str]) -> SceneResult:
    """Compute the motion of a scene with the smallest sufficient model.

    Parameters
    ----------
    scene : Scene, str or path
        A scene, the name of one that ships, or the path of a TOML file.

    Returns
    -------
    SceneResult
        Times ``t`` and states ``y``, the selected model and its error estimate.

    Raises
    ------
    ValueError
        If there is no such scene, its file has a mistake, or no model describes it.
    ArithmeticError
        If no model reaches the requested accuracy.

    Examples
    --------
    >>> from solvers import run_scene
    >>> result = run_scene("report")
    >>> result.y.shape
    (4, 501)
    >>> result.is_met
    True
    """
    definition = scene if isinstance(scene, Scene) else load_scene(scene)
    return scene_run.run_scene(definition, specialiser)


@checked
def load_sweep(name: str | PathLike[str]) -> Sweep:
    """The sweep of this name, or in this TOML file.

    Parameters
    ----------
    name : str or path
        Name of a sweep that ships, such as ``flips``, or path of a file that ends in ``.toml``.

    Returns
    -------
    Sweep
        ``dataclasses.replace`` changes single fields.

    Raises
    ------
    solvers.io.toml_input.InputError
        If there is no such sweep, or its file has a mistake.

    Examples
    --------
    >>> from solvers import load_sweep
    >>> load_sweep("flips").motions
    262144
    """
    return sweep_reading.find(fspath(name), load)


@checked
def sweep(
    definition: Sweep | str | PathLike[str],
    folder: str | Path,
    *,
    pool: Pool = sweeps.THREADS,
    report: Callable[[str], None] = lambda _: None,
) -> Results:
    """Compute the maps of a sweep in a folder, or resume them.

    Parameters
    ----------
    definition : Sweep, str or path
        A sweep, the name of one that ships, or the path of a TOML file.
    folder : str or Path
        The folder is created; completed chunks of the same sweep are not repeated.
    pool : Pool, optional
        Executes the chunks; by default threads, one for each processor.
    report : callable, optional
        ``report(text)`` receives the progress.

    Returns
    -------
    Results
        The maps, which do not depend on how the motions were divided among workers.

    Raises
    ------
    ValueError
        If there is no such sweep, its file has a mistake, or the folder contains another sweep or
        one with other arithmetic, so that results would differ in their last bits.
    OSError
        If a file cannot be written, or the workers of the pool are lost.
    KeyboardInterrupt
        If the user interrupts; completed chunks are kept, and the same call resumes the sweep.

    Examples
    --------
    >>> import generated.double_pendulum as dp
    >>> from solvers import Extremes, Grid, Sweep, sweep
    >>> axes = Grid({"theta1": [0.1, 0.2, 0.3], "theta2": [0.0, 0.1]})
    >>> definition = Sweep(dp, axes, {"reach": Extremes(("theta2",))}, duration=5)
    >>> sweep(definition, "reach").maps["reach"].shape
    (3, 2, 1, 2)
    """
    if not isinstance(definition, Sweep):
        definition = load_sweep(definition)
    return sweeps.sweep(definition, folder, pool=pool, report=report)
