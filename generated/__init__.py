"""Equations of motion as code, one module a system; see ``holonomic derive``."""


__all__ = [
    "double_pendulum",
    "elastic_pendulum",
    "single_pendulum",
]
