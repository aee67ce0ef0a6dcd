"""
A bent resonance
================

The amplitude of Duffing's oscillator jumps at another frequency of the force when this rises than
when it falls.
"""

from tempfile import mkdtemp

from solvers import sweep
from solvers.sweeps.sweep_figure import figure

response = sweep("response", mkdtemp())
picture = figure(response)
