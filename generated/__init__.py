"""Equations of motion as code, one module a system; see ``holonomic derive``."""


__all__ = [
    "double_pendulum",
    "single_pendulum",
]
