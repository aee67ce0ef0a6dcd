"""Expressions as one shared graph, and what is computed on it."""
