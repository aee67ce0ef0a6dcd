"""Integration of generated equations of motion, models of scenes, sweeps and studies.

Generated modules are arguments, so that nothing here needs SymPy.
"""

from pathlib import Path

from solvers.io.lazy import attach

__getattr__, __dir__, __all__ = attach(__name__, Path(__file__).with_suffix(".pyi"))
