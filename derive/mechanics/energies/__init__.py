"""Energies from the positions of masses, and their shortest forms."""
