"""
Poincaré sections
=================

States of double pendulums with one energy, each time the upper rod passes the vertical: regular
motions lie on curves, chaotic ones fill areas.
"""

from tempfile import mkdtemp

from solvers import sweep
from solvers.sweeps.sweep_figure import figure

sections = sweep("sections", mkdtemp())
picture = figure(sections)
