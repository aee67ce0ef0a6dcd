"""Equations of motion as mathematics on pages."""

from derive.formulas.typeset.typesetting import Formula
from solvers.equations.module import GeneratedModule, equations_of_motion


def equations(module: GeneratedModule) -> str:
    """The equations of motion of a system as HTML; empty if they are too long to read."""
    return "\n".join(Formula(text).html for text in equations_of_motion(module))
