"""What is true: motions by families of methods that share nothing with those under test."""
