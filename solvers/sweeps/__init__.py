"""Maps of many motions: axes, map kinds, folders, workers and plots."""
