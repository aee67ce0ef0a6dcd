"""
The smallest sufficient model
=============================

The lower mass is so light that the upper rod moves as a single pendulum: elliptic functions give
its motion, with the error that the light mass causes.
"""

from solvers import run_scene

result = run_scene("flea")
print(result)
picture = result.plot()
