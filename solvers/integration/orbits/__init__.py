"""Periodic orbits: Newton's method, Floquet multipliers, families and their special points."""
