"""From the positions of masses to equations of motion, and from these to code.

The way of the data, one module a station::

    system ─▶ derivation ─▶ mechanics ─▶ lowering ─▶ assignments ─▶ python ─▶ tree
    positions  SymPy values  one graph    operations  names, texts   module    files

``system`` holds positions and masses, ``derivation`` the textbook steps,
``mechanics`` and the two forms say how each function is computed, ``graph`` shares what is
equal, ``lowering`` orders the operations, ``python`` lays out the module, and
``tree`` puts it in its place.
"""

from derive.catalogue import load, names
from derive.derivation import Derivation
from derive.linearisation import Linearisation
from derive.parts import Coordinate, Parameter, PointMass, RigidBody
from derive.symbols import TIME, velocity
from derive.system import System
from derive.writing import write

__all__ = [
    "TIME",
    "Coordinate",
    "Derivation",
    "Linearisation",
    "Parameter",
    "PointMass",
    "RigidBody",
    "System",
    "load",
    "names",
    "velocity",
    "write",
]
