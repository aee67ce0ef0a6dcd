"""Straight-line operations: from nodes to named assignments."""
