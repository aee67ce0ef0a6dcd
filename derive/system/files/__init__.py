"""Systems as TOML files."""
