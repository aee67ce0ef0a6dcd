"""Constraints: their derivatives, integrability and independence."""
