"""Documents of a whole derivation: pages, LaTeX and notebooks, also with exercises."""
