"""All studies of where methods fail, one after the other, in full or in small."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import pi
from typing import Any

from solvers.equations.module import GeneratedModule
from solvers.studies.failure_modes import (
    chaos,
    drift,
    oscillation,
    separatrix,
    singular,
    stiffness,
    tolerances,
)

#: The report's motion from rest, which is chaotic.
CHAOTIC = (pi / 2, pi, 0.0, 0.0)
#: Runs over many horizons: accurate ones by three families, and one whose energy drifts.
LONG_RUNS: tuple[Mapping[str, Any], ...] = (
    {"method": "verner98", "rtol": 1e-11, "atol": 1e-11},
    {"method": "dop853", "rtol": 1e-10, "atol": 1e-10},
    {"method": "gauss3", "form": "hamiltonian", "h": 0.025},
    {"method": "rk4", "form": "lagrangian", "h": 0.02},
)


@dataclass(frozen=True)
class Size:
    """How much is computed.

    Attributes
    ----------
    periods : float
        Of the energy's drift.
    ratios : tuple of float
        Of stiff scenes.
    masses : tuple of float
        Of nearly singular ones, in kg.
    exponent, horizon, statistics : float
        Durations of chaotic runs in s: for the exponent, for horizons, for means.
    scenes : int
        How many are used to judge tolerances.
    methods : tuple of str
        Whose horizons and tolerances are judged.
    """

    periods: float
    ratios: tuple[float, ...]
    masses: tuple[float, ...]
    exponent: float
    horizon: float
    statistics: float
    scenes: int
    methods: tuple[str, ...]


FULL = Size(
    1e5, stiffness.RATIOS, singular.MASSES, 1e5, 40.0, 5e4, tolerances.SCENES, tolerances.METHODS
)
SMALL = Size(1e3, (3.0, 100.0, 300.0), (1.0, 1e-4), 1e4, 20.0, 5e3, 6, ("dp54", "verner98", "RK45"))


def studies(
    double: GeneratedModule, single: GeneratedModule, elastic: GeneratedModule, size: Size
) -> dict[str, Callable[[], Any]]:
    """Each study by its name, to be run when it is wanted."""
    return {
        "oscillation": lambda: oscillation.study(single),
        "stiffness": lambda: stiffness.study(double, elastic, size.ratios),
        "drift": lambda: drift.study(double, size.periods),
        "singular": lambda: singular.study(double, size.masses),
        "chaos": lambda: chaos_study(double, size),
        "separatrix": lambda: {
            "sensitivity": separatrix.sensitivity(single),
            "falls": separatrix.falls(single),
            "upright": separatrix.upright(single),
        },
        "tolerances": lambda: tolerances.study(double, size.methods, size.scenes),
    }


def chaos_study(double: GeneratedModule, size: Size) -> dict[str, Any]:
    """Exponent, separation, horizons and what holds beyond them.

    Parameters
    ----------
    double : module
        The generated double pendulum; it moves from `CHAOTIC` with its default parameters.
    size : Size
        How much is computed: `FULL`, `SMALL` or another. Of its methods SciPy's are left out.

    Returns
    -------
    dict of str
        ``exponent``, a `chaos.Mean` in 1/s; ``separation``, a `chaos.Separation`;
        ``horizons``, a list of `chaos.Horizon`; ``statistics``, a list of
        `chaos.Statistics`, one for each of `LONG_RUNS`.

    Raises
    ------
    solvers.runge_kutta.catalogue.UnknownMethodError
        When one of the other methods does not exist.
    """
    params = double.DEFAULTS
    exponent = chaos.lyapunov(double, params, CHAOTIC, size.exponent)
    t, truth = chaos.reference(double, params, CHAOTIC, size.horizon)
    ours = tuple(method for method in size.methods if method.islower())
    return {
        "exponent": exponent,
        "separation": chaos.separation(double, params, t, truth),
        "horizons": chaos.horizons(double, params, t, truth, exponent.value, ours),
        "statistics": chaos.statistics(double, params, CHAOTIC, size.statistics, LONG_RUNS),
    }
