"""Parameters of a system from measurements of its motions."""
