"""Plots of sweeps: images, lines, points and their labels."""
