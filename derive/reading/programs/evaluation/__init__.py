"""Programs followed statement by statement: the values of their variables."""
