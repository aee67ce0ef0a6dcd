"""Commands that measure, tell and draw: what stands on top of everything else."""
