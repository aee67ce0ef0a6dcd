"""The grammar of formulas in LaTeX: terminals, and trees from its rules."""
