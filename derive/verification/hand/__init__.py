"""Hand derivations in TOML files, judged equation by equation."""
