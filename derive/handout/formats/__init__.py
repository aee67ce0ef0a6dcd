"""Documents as pages, LaTeX and notebooks."""
