"""Commands that derive, list and verify systems."""
