"""
Hénon and Heiles: order and chaos
=================================

Sections of the potential of Hénon and Heiles at three energies. With more energy the regular
islands shrink.
"""

from tempfile import mkdtemp

from solvers import sweep
from solvers.sweeps.sweep_figure import figure

sections = sweep("henon_heiles", mkdtemp())
picture = figure(sections)
