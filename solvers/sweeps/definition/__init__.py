"""The definition of a sweep: axes, maps, files and their checks."""
