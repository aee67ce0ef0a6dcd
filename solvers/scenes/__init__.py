"""Scenes: motions in files, models of these motions, summaries and plots."""
