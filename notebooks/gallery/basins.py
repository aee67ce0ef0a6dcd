"""
Basins of two wells
===================

A mass in two wells, with friction and a harmonic force, settles about one of them; the boundary of
the two sets of starts is a fractal.
"""

from tempfile import mkdtemp

from solvers import sweep
from solvers.sweeps.sweep_figure import figure

basins = sweep("basins", mkdtemp())
picture = figure(basins)
