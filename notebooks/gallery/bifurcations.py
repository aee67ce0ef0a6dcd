"""
Bifurcations of a driven pendulum
=================================

Velocities of a pendulum whose pivot oscillates vertically, once a period of the drive: it swings,
rotates, and doubles its period again and again until it moves chaotically. The amplitude of the
drive rises (blue) and falls (red) in small steps: where both differ, there are two attractors.
"""

from tempfile import mkdtemp

from solvers import sweep
from solvers.sweeps.sweep_figure import figure

diagram = sweep("bifurcations", mkdtemp())
picture = figure(diagram)
