"""The stages of the demonstration, from positions to a map of motions."""

import platform
from collections.abc import Callable
from datetime import date
from importlib.metadata import version
from pathlib import Path

from solvers.app.demo.equations_stage import derivation, generation
from solvers.app.demo.methods_stage import cost, limits
from solvers.app.demo.motions_stage import flips, motion
from solvers.app.demo.stage import Stage
from solvers.app.demo.verdicts_stage import verification
from solvers.app.modules import load
from solvers.integration.prepare import no_compiler
from solvers.scenes.scene_reading import find
from solvers.sweeps.definition import sweep_reading

#: Packages whose versions the page states.
PACKAGES = ("holonomic", "sympy", "numpy", "scipy", "matplotlib")


def stages(folder: Path) -> dict[str, Callable[[], Stage]]:
    """The stages by name, in their order; the map of motions needs a compiler."""
    scene = find("report", load)

    def flip_map() -> Stage:
        if missing := no_compiler(scene.module):
            return Stage((f"left out: {missing}",))
        return flips(sweep_reading.find("flips", load), folder / "flips")

    return {
        "derive": derivation,
        "verify": verification,
        "generate": lambda: generation(load("double_pendulum")),
        "integrate": lambda: motion(scene),
        "chart": lambda: cost(scene),
        "stability": lambda: limits(scene),
        "map": flip_map,
    }


def versions() -> dict[str, str]:
    """Date, machine and versions."""
    return {
        "date": date.today().isoformat(),
        "machine": f"{platform.system()} {platform.machine()}",
        "Python": platform.python_version(),
        **{name: version(name) for name in PACKAGES},
    }
