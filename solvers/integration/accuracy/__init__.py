"""Motions whose errors stay below a requested accuracy: method, form, tolerance, precision."""
