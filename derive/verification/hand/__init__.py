"""Anybody's hand derivation, judged equation by equation."""
