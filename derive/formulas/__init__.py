"""Formulas: parsing text safely, zero tests, and typesetting."""
