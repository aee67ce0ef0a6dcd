"""A page that plays motions in real time: one HTML file that needs nothing else."""
