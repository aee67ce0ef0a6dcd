"""
When a double pendulum first turns over
=======================================

One pixel is one pendulum, released at rest; its colour is the time until a rod first turns over.
Inside the line the energy does not suffice, so that nothing has to be integrated there.
"""

from tempfile import mkdtemp

from solvers import sweep
from solvers.sweeps.sweep_figure import figure

flips = sweep("flips", mkdtemp())
picture = figure(flips)
