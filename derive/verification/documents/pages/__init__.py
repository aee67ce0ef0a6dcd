"""Verdicts where formulas stand: pages, LaTeX and tables."""
