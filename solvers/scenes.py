"""Scenes: a system, its parameters, where its motion begins and how long it lasts."""

from __future__ import annotations

from dataclasses import dataclass, field
from difflib import get_close_matches
from math import pi
from types import ModuleType


class UnknownSceneError(ValueError):
    """No scene has this name."""


@dataclass(frozen=True)
class Scene:
    """What moves, and from where.

    Attributes
    ----------
    name, title : str
        What to call it.
    system : str
        Name of the generated module.
    y0 : tuple of float
        Coordinates and velocities at time 0, in the order of the module's ``STATE``.
    duration : float
        In s.
    changed : dict of str to float
        Parameters that are not at the module's default.
    """

    name: str
    title: str
    system: str
    y0: tuple[float, ...]
    duration: float
    changed: dict[str, float] = field(default_factory=dict)

    def params(self, module: ModuleType) -> tuple[float, ...]:
        """All parameters, in the order of ``module.PARAMETERS``."""
        defaults = dict(zip(module.PARAMETERS, module.DEFAULTS, strict=True))
        return tuple((defaults | self.changed).values())


_REPORT = (pi / 2, pi, 0.0, 0.0)
_SCENES = (
    Scene("report", "the report's scene", "double_pendulum", _REPORT, 5.0),
    Scene("light_above", "the report's scene, m1 < m2", "double_pendulum", _REPORT, 5.0,
          {"m2": 3.0}),
    Scene("heavy_above", "the report's scene, m1 > m2", "double_pendulum", _REPORT, 5.0,
          {"m1": 3.0}),
    Scene("long", "the report's scene, longer", "double_pendulum", _REPORT, 20.0),
    Scene("small", "double pendulum, small motion", "double_pendulum", (0.02, -0.01, 0.0, 0.0),
          20.0),
    Scene("single", "single pendulum from 2 rad", "single_pendulum", (2.0, 0.0), 10.0),
)  # fmt: skip
SCENES = {scene.name: scene for scene in _SCENES}


def scene(name: str) -> Scene:
    """The scene of this name.

    Raises
    ------
    UnknownSceneError
        When there is none.
    """
    if name in SCENES:
        return SCENES[name]
    near = get_close_matches(name, SCENES, n=1)
    hint = f"; did you mean {near[0]!r}?" if near else ""
    raise UnknownSceneError(f"scene {name[:50]!r} is not one of {', '.join(SCENES)}{hint}")
