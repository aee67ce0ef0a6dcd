"""Mechanics: from positions to the Lagrangian and the equations of motion."""
