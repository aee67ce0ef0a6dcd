"""Loops over steps: in Python, in SciPy, compiled, through switches and singular configurations."""
