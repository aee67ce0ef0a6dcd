"""Tokens of LaTeX without macros and layout, and the rows of displays."""
