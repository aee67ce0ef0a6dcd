"""Equilibria, and the equations linearised about a state."""
