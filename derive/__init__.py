"""From the positions of masses to equations of motion, and from these to code.

The stages of the derivation::

    System ─▶ Derivation ─▶ EquationsOfMotion ─▶ Lowering ─▶ Assignments ─▶ backend ─▶ files
    positions  SymPy values  one graph            operations  names, texts   Python, C, others

Systems: `System`, `Coordinate`, `Parameter`, `PointMass`, `RigidBody`, `Input`, `Constraint`,
`TIME`, `velocity`; those that ship: `names`, `load`.

Orientations: `Orientation`, `rotations`, `rotation_matrix`, `quaternion`.

Links: `Block`, `Box`, `Cart`, `Plate`, `Rail`, `Rod`, `Spring`, `Thread`, `Wheel`.

Joints: `ball`, `fixed_distance`, `hinge`, `pin`, `prismatic`, `rolling_on_line`,
`rolling_on_plane`, `slider`.

Derivations: `Derivation`, `Regressor`, `Linearisation`, `StateSpace`, `reduced`, `with_inputs`.

Files of equations and simulations: `write`, `export`, `Simulation`.
"""

from pathlib import Path

from solvers.io.lazy import attach

__getattr__, __dir__, __all__ = attach(__name__, Path(__file__).with_suffix(".pyi"))
