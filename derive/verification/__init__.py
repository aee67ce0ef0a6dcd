"""Verification of hand derivations, equation by equation."""
