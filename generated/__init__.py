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
    "four_bar",
    "free_body",
    "furuta_pendulum",
    "gyroscope",
    "heavy_top",
    "henon_heiles",
    "rolling_disc",
    "rotating_hoop",
    "single_pendulum",
    "slider_crank",
    "spherical_pendulum",
    "swinging_atwood",
    "two_link_arm",
]
