"""Mechanical systems: their parts, symbols, files and catalogue."""
