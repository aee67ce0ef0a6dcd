"""Input and output: TOML files, quantities, atomic writes, caches, figures and progress."""
