"""Runge–Kutta methods: tableaus, order conditions, stability functions, steps and step control."""
