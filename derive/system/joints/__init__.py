"""Joints: constraints whose multipliers are forces."""
