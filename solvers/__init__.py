"""Solvers, studies and charts over the functions of generated modules.

Nothing here imports SymPy or a particular system: a generated module is an argument.
"""
