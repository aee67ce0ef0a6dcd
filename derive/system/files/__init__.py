"""Systems by name or from TOML files."""
