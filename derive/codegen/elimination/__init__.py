"""Elimination in matrices of nodes: of general ones, with constraints, along kinematic trees."""
