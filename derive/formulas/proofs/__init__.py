"""Proofs that expressions are zero or positive."""
