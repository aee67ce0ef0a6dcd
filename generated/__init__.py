"""Equations of motion as code, one module a system; see ``holonomic derive``."""


__all__ = [
    "cart_3",
    "chain_3",
    "chaplygin_sleigh",
    "coupled_pendulums",
    "double_bar_pendulum",
    "double_pendulum",
    "driven_pendulum",
    "duffing",
    "elastic_pendulum",
    "foucault_pendulum",
    "furuta_pendulum",
    "heavy_top",
    "henon_heiles",
    "rotating_hoop",
    "single_pendulum",
    "spherical_pendulum",
    "swinging_atwood",
]
