"""Equations of motion as solvers see them: generated modules, their forms and their energy."""
