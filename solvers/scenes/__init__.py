"""Scenes: what is there, and what is asked; files, and how they are read."""
