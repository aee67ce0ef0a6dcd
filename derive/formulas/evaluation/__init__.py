"""Formulas in numbers: digits, samples, residues."""
