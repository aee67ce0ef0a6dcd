"""Checks of runs: energy, predictability, stability of steps, singularities, global errors."""
