"""Formulas typeset, as MathML and LaTeX."""
