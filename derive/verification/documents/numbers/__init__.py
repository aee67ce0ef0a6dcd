"""Formulas of documents in numbers: states and motions, for many meanings of letters at once."""
