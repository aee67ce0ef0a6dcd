"""The forms of the equations of motion, as nodes of one graph."""
