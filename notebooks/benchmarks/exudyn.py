"""Kinematic trees in Exudyn, which joints may close; needs the extra ``bench``.

A link turns about an axis of the link before it: trees have as many coordinates as joints.
"""

import sys
from collections.abc import Callable, Sequence
from contextlib import redirect_stdout
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Vector = tuple[float, float, float]

#: Relative and absolute tolerance of Newton's method: looser ones limit the accuracy.
NEWTON = 1e-9, 1e-11


@dataclass(frozen=True)
class Link:
    """A body, its joint with the link before, and the start of that joint's angle."""

    angle: float  # relative to the link before
    rate: float
    mass: float = 0.0
    centre: Vector = (0.0, 0.0, 0.0)  # of mass
    moments: Vector = (0.0, 0.0, 0.0)  # about it
    joint: Vector = (0.0, 0.0, 0.0)  # in the frame of the link before
    axis: str = "Z"


@dataclass(frozen=True)
class Point:
    """A point of a link, or of the ground."""

    position: Vector
    tree: int | None = None
    link: int = 0


def fast(peer: Callable[[str], Any]) -> Any:
    """The package without checks of indices, by a function that imports packages."""
    sys.exudynFast = True  # type: ignore[attr-defined]  # read when the package is imported
    with redirect_stdout(sys.stderr):  # where it reports this
        return peer("exudyn")


class Model:
    """A mechanism of trees and joints, with weight."""

    def __init__(self, package: Any, gravity: Vector) -> None:
        self._package, self._gravity = package, gravity
        self._items: Any = import_module(f"{package.__name__}.itemInterface")
        self._container = package.SystemContainer()
        self._system = self._container.AddSystem()

    def add_tree(self, links: Sequence[Link]) -> int:
        """Add links, each of which turns about the one before; return the number of the tree."""
        package, n = self._package, len(links)
        node = self._items.NodeGenericODE2(
            referenceCoordinates=[0.0] * n,
            initialCoordinates=[link.angle for link in links],
            initialCoordinates_t=[link.rate for link in links],
            numberOfODE2Coordinates=n,
        )
        tree = self._items.ObjectKinematicTree(
            nodeNumber=self._system.AddNode(node),
            jointTypes=[getattr(package.JointType, f"Revolute{link.axis}") for link in links],
            linkParents=list(range(-1, n - 1)),
            jointTransformations=package.Matrix3DList([np.eye(3)] * n),
            jointOffsets=package.Vector3DList([list(link.joint) for link in links]),
            linkMasses=[link.mass for link in links],
            linkCOMs=package.Vector3DList([list(link.centre) for link in links]),
            linkInertiasCOM=package.Matrix3DList([np.diag(link.moments) for link in links]),
            gravity=self._gravity,
        )
        return int(self._system.AddObject(tree))

    def join(self, first: Point, second: Point, axes: Sequence[int]) -> None:
        """Let two points coincide along some of the three axes, those with a 1."""
        markers = [self._marker(point) for point in (first, second)]
        joint = self._items.ObjectJointSpherical(markerNumbers=markers, constrainedAxes=axes)
        self._system.AddObject(joint)

    def _marker(self, point: Point) -> int:
        if point.tree is None:
            ground = self._system.AddObject(self._items.ObjectGround())
            marker = self._items.MarkerBodyPosition(bodyNumber=ground, localPosition=point.position)
        else:
            marker = self._items.MarkerKinematicTreeRigid(
                objectNumber=point.tree, linkNumber=point.link, localPosition=point.position
            )
        return int(self._system.AddMarker(marker))

    def motion(self, solver: str, end: float, steps: int) -> Callable[[], tuple[Array, Array]]:
        """A function that integrates from the start and returns coordinates and velocities."""
        self._system.Assemble()
        settings = self._package.SimulationSettings()
        settings.solution.file.write = settings.solution.sensors.active = False
        integration = settings.timeIntegration
        integration.endTime, integration.numberOfSteps = end, steps
        integration.adaptiveStep = integration.automaticStepSize = False
        integration.stepInformation = 0
        integration.explicit.computeEndOfStepAccelerations = False
        integration.newton.useModifiedNewton = False
        integration.newton.relativeTolerance, integration.newton.absoluteTolerance = NEWTON
        kind = getattr(self._package.DynamicSolverType, solver)

        def run() -> tuple[Array, Array]:
            self._system.SolveDynamic(settings, solverType=kind)
            data = self._system.systemData
            return np.array(data.GetODE2Coordinates()), np.array(data.GetODE2Coordinates_t())

        return run
