"""Verdicts on the report: equations, programs, claims, objectives and recommendations."""
