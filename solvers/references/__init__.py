"""Reference solutions, by families of methods that share nothing with those under test."""
