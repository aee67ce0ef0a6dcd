"""Scenes answered: by which model, with which motion, as text and as pictures."""
