"""Corrections of wrong formulas: the search for the one mistake."""
