"""Continuation: families of periodic orbits in a parameter, or in the energy."""

from dataclasses import replace
from functools import partial
from math import inf

import numpy as np
from numpy.typing import ArrayLike

from solvers.equations.module import GeneratedModule
from solvers.equations.number_checks import positive, real_numbers
from solvers.equations.signature_checks import checked
from solvers.integration.orbits.continuation import (
    Limits,
    Walk,
    crossing_direction,
    doubling_direction,
    walk,
)
from solvers.integration.orbits.family import OrbitFamily, SpecialOrbit
from solvers.integration.orbits.orbit_shooting import OrbitConditions, OrbitStart, PeriodOf
from solvers.integration.orbits.periodic_orbit import ENERGY, PeriodicOrbit
from solvers.integration.orbits.solution_curve import UNIQUE, CurveNode, SolutionCurve
from solvers.integration.orbits.symmetry import Nature, Reversal, angles
from solvers.integration.problem import validation
from solvers.io.argument_types import check_direction
from solvers.io.suggestion import did_you_mean, shortened
from solvers.runge_kutta.stepper import Array

#: Longest period relative to that of the start.
LONGEST = 10.0
#: Changes that break a symmetry, relative to all, which count as none.
SYMMETRIC = 1e-6
#: Change of a parameter with which a period is checked.
VARIATION = 0.01
#: Directions in which a family can branch off, by the kind of the special orbit.
DIRECTIONS = {"branch point": crossing_direction, "period doubling": doubling_direction}


@checked
def orbit_family(
    module: GeneratedModule,
    start: PeriodicOrbit | SpecialOrbit,
    parameter: str = ENERGY,
    bounds: ArrayLike = (-inf, inf),
    *,
    direction: int = 0,
    period: PeriodOf | None = None,
    max_orbits: int = 200,
    max_period: float | None = None,
    max_step: float = 0.1,
    rtol: float = 1e-12,
    atol: float = 1e-12,
) -> OrbitFamily:
    """The family of periodic orbits through one of them, with its special points.

    The family is a curve in the space of start, period and parameter. From each orbit, Newton's
    method leads to the next one in the plane at the end of a step along the tangent, so that the
    curve may turn back (H. B. Keller, in: Applications of Bifurcation Theory, ed. P. H. Rabinowitz,
    1977, 359-384). Orbits of a conservative system form families of different energies without
    any parameter.

    Parameters
    ----------
    module, rtol, atol
        As in `integrate`.
    start : PeriodicOrbit or SpecialOrbit
        An orbit, as `periodic_orbit` returns it, with its parameters and its symmetry. From a
        branch point or a period doubling of another family, the family that branches off, which
        may have less symmetry.
    parameter : str, optional
        The parameter that varies, or ``energy`` of a conservative system. If a parameter of a
        conservative system varies, all orbits have the same period.
    bounds : pair of float, optional
        Smallest and largest value of the parameter, or of the energy in J; the family ends there.
    direction : {0, 1, -1}, optional
        Whether the family is followed to both sides, or from the start to larger values, or to
        smaller ones.
    period : callable, optional
        The period in s as a function of the parameters, a mapping by name, for systems that depend
        on time with a parameter: ``lambda p: 2 * pi / p["Omega"]``.
    max_orbits : int, optional
        Most orbits to each side.
    max_period : float, optional
        Longest period in s, by default `LONGEST` times that of the start.
    max_step : float, optional
        Largest distance between orbits, in rad and 1 m of coordinates, in these per radian of the
        period for velocities, and relative to the period of the start and the range of the
        parameter, or its value at the start if it has no bounds. Steps are shorter where the curve
        bends.

    Returns
    -------
    OrbitFamily
        Orbits, special points, and why the family ends. Two special points of one kind between
        successive orbits are not noticed.

    Raises
    ------
    ValueError
        When an argument is invalid, or the equations have a solution in more than one direction,
        as with another conserved quantity.

    Examples
    --------
    >>> import generated.henon_heiles as hh
    >>> from solvers import Event, orbit_family, periodic_orbit
    >>> section = Event(hh, "x", 0.0, direction=1)
    >>> orbit = periodic_orbit(hh, {"x": 0.0, "y": 0.0, "x_dot": 0.2, "y_dot": 0.1}, section, {})
    >>> family = orbit_family(hh, orbit, bounds=(0.001, 0.1))
    >>> family.ends
    ('bound', 'bound')
    """
    names = (ENERGY, *module.PARAMETERS)
    if parameter not in names:
        hint = did_you_mean(str(parameter), names)
        raise ValueError(f"parameter = {parameter!r}{hint} must be one of {', '.join(names)}")
    check_direction("direction", direction)
    orbit = start if isinstance(start, PeriodicOrbit) else start.orbit
    params = np.array(orbit.params)
    reversal = Reversal.of(module, orbit.symmetry, orbit.y, params) if orbit.symmetry else None
    if reversal and isinstance(start, SpecialOrbit) and start.direction is not None:
        breaks = np.abs(start.direction[reversal.changed]).max()
        if breaks > SYMMETRIC * np.abs(start.direction).max():
            reversal = None
    index = None if parameter == ENERGY else module.PARAMETERS.index(parameter)
    shooting = OrbitConditions(
        module, Nature.of(module, orbit.y, params, index), rtol, atol, reversal, index, period
    )
    ends = real_numbers("bounds", bounds, finite=False)
    if ends.shape != (2,):
        raise ValueError(f"bounds = {shortened(bounds)} must be two numbers, lowest and highest")
    low, high = ends.tolist()
    limits = Limits(
        low,
        high,
        positive("max_period", LONGEST * orbit.period if max_period is None else max_period),
        validation.count("max_orbits", max_orbits, 1),
        positive("max_step", max_step),
    )
    first = _first(shooting, start, limits)
    if not low <= first.value <= high:
        raise ValueError(f"bounds = ({low}, {high}) exclude the start, {parameter} = {first.value}")
    back = replace(first, tangent=-first.tangent, reference=-first.reference)
    follow = partial(walk, first.curve, limits=limits, branches_off=isinstance(start, SpecialOrbit))
    ahead = follow(first) if direction >= 0 else Walk([], end="start")
    behind = Walk([], end="closed" if ahead.end == "closed" else "start")
    if direction <= 0 and ahead.end != "closed":
        behind = follow(back)
    return _family(module, parameter, behind, first, ahead)


def _first(
    shooting: OrbitConditions, start: PeriodicOrbit | SpecialOrbit, limits: Limits
) -> CurveNode:
    """The first node, whose tangent leads to larger values."""
    orbit = start if isinstance(start, PeriodicOrbit) else start.orbit
    point = OrbitStart(orbit.y, orbit.period, np.array(orbit.params))
    if isinstance(start, SpecialOrbit) and start.kind == "period doubling":
        point = replace(point, period=2 * orbit.period)
    shooting.check_period(point)
    shooting.check_period(shooting.moved(point, np.array([*0 * point.y, 0.0, VARIATION])))
    if shooting.parameter is None and not shooting.nature.is_conservative:
        raise ValueError(
            f"{shooting.module.SYSTEM} does not conserve its energy: give a parameter, one of "
            f"{', '.join(shooting.module.PARAMETERS)}"
        )
    shot = shooting(point)
    curve = SolutionCurve(replace(shooting, advance=shot.advance), _scales(shooting, point, limits))
    if isinstance(start, SpecialOrbit):
        assert start.direction is not None
        tangent = start.direction / curve.scales
        tangent /= np.linalg.norm(tangent)
        return replace(curve.node(point, shot, tangent), tangent=tangent)
    node = curve.node(point, shot, np.zeros(len(point.y) + 2))
    if node.uniqueness < UNIQUE:
        raise ValueError(
            f"periodic orbits near y = {orbit.y} are more than one family: another quantity is "
            "conserved, or families cross there"
        )
    sign = -1.0 if node.rate_of_value < 0 else 1.0
    return replace(node, tangent=sign * node.tangent, reference=sign * node.tangent)


def _scales(shooting: OrbitConditions, point: OrbitStart, limits: Limits) -> Array:
    """Units of the start, the period and the parameter in which distances are measured."""
    module, n = shooting.module, len(shooting.module.COORDINATES)
    is_angle = angles(module)[:n] > 0
    sizes = np.where(is_angle, 1.0, np.maximum(1.0, np.abs(point.y[:n])))
    width = limits.high - limits.low
    if shooting.parameter is None or not np.isfinite(width):
        width = 1.0 if shooting.parameter is None else abs(point.params[shooting.parameter]) or 1.0
    return np.array([*sizes, *(2 * np.pi / point.period * sizes), point.period, width])


def _family(
    module: GeneratedModule, parameter: str, behind: Walk, first: CurveNode, ahead: Walk
) -> OrbitFamily:
    nodes = [*behind.nodes[::-1], first, *ahead.nodes]
    # the special nodes between each node and the next
    special = [entries[::-1] for entries in behind.special[::-1]] + ahead.special
    points = [
        SpecialOrbit(kind, node.orbit, k, DIRECTIONS[kind](node) if kind in DIRECTIONS else None)
        for k, entries in enumerate(special)
        for kind, node in entries
    ]
    ends = behind.end, ahead.end
    return OrbitFamily(module, parameter, [node.orbit for node in nodes], points, ends)
