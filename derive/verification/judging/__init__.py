"""The judging engine: formulas and equations of motion compared with those of a derivation."""
