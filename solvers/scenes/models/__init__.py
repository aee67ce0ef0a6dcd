"""Models of a motion, from the smallest to the full equations, each with its error."""
