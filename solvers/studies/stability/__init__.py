"""Stability of Runge–Kutta methods: exact regions, and what running steppers do."""
