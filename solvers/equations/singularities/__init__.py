"""Singular mass matrices, configurations and coordinates."""
