"""Integration of equations of motion: one motion, many motions, and prepared loops."""
