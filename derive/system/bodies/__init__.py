"""Rigid bodies and their orientations."""
