"""Initial states that satisfy constraints, in doubles and in decimals."""
