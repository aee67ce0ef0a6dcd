"""From the positions of masses to equations of motion, and from these to code.

The stages of the derivation::

    System ─▶ Derivation ─▶ EquationsOfMotion ─▶ Lowering ─▶ Assignments ─▶ backend ─▶ files
    positions  SymPy values  one graph            operations  names, texts   Python, C
"""

from pathlib import Path

from solvers.io.lazy import attach

__getattr__, __dir__, __all__ = attach(__name__, Path(__file__).with_suffix(".pyi"))
