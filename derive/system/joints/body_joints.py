"""Joints of two bodies in space, or of one with the ground: hinges and prismatic joints.

With the axes a of the first body and b of the second, a virtual rotation δθ of the first body
against the second changes a_k · b_j by δθ · (a_k × b_j). Where all axes but those of a hinge agree,
this is the component of δθ about an axis of the second body: the multiplier is a torque about it.
"""

import sympy as sp

from derive.system.constraints import Constraint, Point
from derive.system.joints.point_joints import canonical, coincidence, components, constraint_rows
from derive.system.orientation import AXES, Orientation, rotation_matrix
from derive.system.parts import SystemDefinitionError
from solvers.io.suggestion import shortened


def hinge(
    name: str,
    p: Point,
    q: Point,
    first: Orientation,
    second: Orientation | None = None,
    axis: str = "z",
) -> list[Constraint]:
    """A hinge in space: two points remain together, and two bodies turn about a common axis.

    Opposite axes satisfy the constraints, too: the guess of a start must be nearer to equal ones.

    Parameters
    ----------
    name : str
        Name of the hinge.
    p, q : sequence of sympy.Expr
        The points of the first and second body, of three components each.
    first, second : Orientation
        Orientations of the bodies, such as those of `rotations` or `quaternion`. Without `second`,
        the second body is the ground, with the axes of space.
    axis : str, optional
        The axis of both bodies that remains common: ``"x"``, ``"y"`` or ``"z"``.

    Returns
    -------
    list of Constraint
        Five constraints. Their multipliers ``name_x``, ``name_y`` and ``name_z`` are the force on
        p, and ``name_torque_x`` and ``name_torque_y``, of a hinge about z, the torque on the first
        body about the second body's axes.

    Raises
    ------
    SystemDefinitionError
        When a point does not have three components, `axis` is no axis, or an orientation is not
        one in space.

    Examples
    --------
    >>> from sympy import symbols
    >>> from derive import rotations
    >>> alpha, beta, gamma = symbols("alpha beta gamma", real=True)
    >>> door = rotations("xyz", (alpha, beta, gamma))
    >>> for one in hinge("A", door.turned((1, 0, 0)), (1, 0, 0), door)[3:]:
    ...     print(one.name, one.formula)
    A_torque_x sin(alpha)*cos(beta)
    A_torque_y sin(beta)
    """
    (a, b), k = _axes(name, first, second), _index(name, axis)
    i, j = (k + 1) % 3, (k + 2) % 3
    torques = [_torque(i, -_dot(a[k], b[j])), _torque(j, _dot(a[k], b[i]))]
    return [*coincidence(name, p, q, 3), *constraint_rows(name, torques, "N m")]


def prismatic(
    name: str,
    p: Point,
    q: Point,
    first: Orientation,
    second: Orientation | None = None,
    axis: str = "z",
) -> list[Constraint]:
    """A prismatic joint in space: one body slides along an axis of another, without turning.

    The axes of both bodies remain parallel. Those that are permuted, or opposite in pairs, satisfy
    the constraints, too: the guess of a start must be nearer to equal ones.

    Parameters
    ----------
    name : str
        Name of the joint.
    p, q : sequence of sympy.Expr
        A point of the first body, and a point of the axis, of three components each.
    first, second : Orientation
        Orientations of the bodies, such as those of `rotations` or `quaternion`. Without `second`,
        the second body is the ground, with the axes of space.
    axis : str, optional
        The axis of the second body along which p moves: ``"x"``, ``"y"`` or ``"z"``.

    Returns
    -------
    list of Constraint
        Five constraints. Their multipliers ``name_x`` and ``name_y``, along z, are the force on p
        across the axis, and ``name_torque_x``, ``name_torque_y`` and ``name_torque_z`` the torque
        on the first body, along and about the second body's axes. The forces on both bodies act
        at p.

    Raises
    ------
    SystemDefinitionError
        When a point does not have three components, `axis` is no axis, or an orientation is not
        one in space.

    Examples
    --------
    >>> from sympy import symbols
    >>> from derive import quaternion
    >>> x, y, z = symbols("x y z", real=True)
    >>> lift = quaternion(*symbols("e:4", real=True))
    >>> [one.name for one in prismatic("A", (x, y, z), (0, 0, 0), lift)]
    ['A_x', 'A_y', 'A_torque_x', 'A_torque_y', 'A_torque_z']
    """
    (a, b), k = _axes(name, first, second), _index(name, axis)
    pairs = zip(components(name, p, 3), components(name, q, 3), strict=True)
    arm = sp.Matrix([x - y for x, y in pairs])
    forces = [
        (AXES[i], _dot(arm, b[i]), f"force on the first body along the second's {AXES[i]} axis")
        for i in sorted({0, 1, 2} - {k})
    ]
    torques = [_torque(i, _dot(a[(i + 1) % 3], b[(i + 2) % 3])) for i in range(3)]
    return [*constraint_rows(name, forces), *constraint_rows(name, torques, "N m")]


def _axes(name: str, first: object, second: object) -> list[list[sp.Matrix]]:
    """The axes of each body; those of space for the ground."""
    ground = rotation_matrix(sp.eye(3).tolist())
    matrices = []
    for one in (first, ground if second is None else second):
        if not isinstance(one, Orientation):
            raise SystemDefinitionError(
                f"joint {name} has the orientation {shortened(one)}: give that of rotations, "
                "rotation_matrix or quaternion"
            )
        matrices.append(one.matrix)
    return [[matrix[:, k] for k in range(3)] for matrix in matrices]


def _index(name: str, axis: object) -> int:
    if not isinstance(axis, str) or axis not in {*AXES}:
        raise SystemDefinitionError(f"the axis of {name} is {shortened(axis)}: give x, y or z")
    return AXES.index(axis)


def _dot(a: sp.Matrix, b: sp.Matrix) -> sp.Expr:
    """The dot product, or its expanded form where that is shorter."""
    product = a.dot(b)
    return min(product, canonical(product), key=lambda form: int(form.count_ops()))


def _torque(axis: int, value: sp.Expr) -> tuple[str, sp.Expr, str]:
    meaning = f"torque on the first body about the second's {AXES[axis]} axis"
    return f"torque_{AXES[axis]}", value, meaning
