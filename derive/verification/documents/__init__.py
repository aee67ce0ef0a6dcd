"""Verdicts on the formulas of documents and programs."""
