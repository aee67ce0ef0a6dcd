"""What the parts of a sweep can and cannot be together."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import isfinite

from solvers.equations.module import GeneratedModule, has_function
from solvers.io.suggestion import did_you_mean
from solvers.sweeps.axes import Axes
from solvers.sweeps.barrier import lower_place
from solvers.sweeps.map import Map
from solvers.sweeps.maps import EnergyError, Final, First, Samples

#: What may vary or be given beside coordinates, velocities and parameters.
ENERGY = "energy"
#: Instead of a velocity's value: so much as the energy leaves for it.
FROM_ENERGY = "energy"
#: The map that says how motions ended.
STATUS = "status"
#: Characters of a map's name.
LONGEST = 50

Values = Mapping[str, float | str]


def check_names(module: GeneratedModule, axes: Axes, values: Values) -> None:
    """Refuse names that are not there, are there twice or are missing, and wrong numbers.

    Parameters
    ----------
    module : module
        A generated module.
    axes : Grid, Table or Random
        What varies.
    values : mapping of str to float or str
        What does not.

    Raises
    ------
    ValueError
        With what is allowed.
    """
    known, varied = (*module.STATE, *module.PARAMETERS, ENERGY), tuple(axes.smallest)
    for name in (*module.STATE, *module.PARAMETERS):
        if name in (ENERGY, STATUS):
            raise ValueError(
                f"the system has something called {name!r}, which has a meaning in a sweep: give "
                "it another name"
            )
    for name in (*varied, *values):
        if name not in known:
            raise ValueError(
                f"{name[:50]!r}{did_you_mean(name, known)} cannot vary or be given: known are "
                f"{', '.join(known)}"
            )
    for name in varied:
        if name in values:
            raise ValueError(f"{name} varies, and is given as {values[name]}: leave one")
    for name in module.COORDINATES:
        if name not in (*varied, *values):
            raise ValueError(f"{name} is missing: give its value, or let it vary")
    for name, value in values.items():
        if value != FROM_ENERGY and (isinstance(value, str) or not isfinite(value)):
            raise ValueError(f"{name} = {value!r} must be a finite number")
    for name, low in {**values, **axes.smallest}.items():
        if name in module.POSITIVE and not isinstance(low, str) and low <= 0:
            raise ValueError(f"{name} = {low} must be positive, in {module.UNITS[name]}")


def check_energy(module: GeneratedModule, given: Sequence[str], values: Values) -> None:
    """Refuse an energy that sets nothing, and velocities that are set by none.

    Parameters
    ----------
    module : module
        A generated module.
    given : sequence of str
        Names of what varies and of what does not.
    values : mapping of str to float or str
        What does not vary.

    Raises
    ------
    ValueError
        With what is allowed.
    """
    free = [name for name, value in values.items() if value == FROM_ENERGY]
    rates = module.STATE[len(module.COORDINATES) :]
    if len(free) > 1 or not {*free} <= {*rates}:
        raise ValueError(
            f'{", ".join(free)} = "{FROM_ENERGY}": the energy sets one velocity, one of '
            f"{', '.join(rates)}"
        )
    if bool(free) != (ENERGY in given):
        raise ValueError(
            "an energy and a velocity that it sets belong together: give energy, and "
            f'"{FROM_ENERGY}" as the value of one of {", ".join(rates)}'
        )


def check_maps(
    module: GeneratedModule, axes: Axes, maps: Mapping[str, Map], values: Values
) -> None:
    """Refuse maps without a proper name, and what they ask of the system in vain.

    Parameters
    ----------
    module : module
        A generated module.
    axes : Grid, Table or Random
        What varies.
    maps : mapping of str to Map
        What is kept.
    values : mapping of str to float or str
        What does not vary.

    Raises
    ------
    ValueError
        With what is allowed.
    """
    if not maps:
        raise ValueError("no maps: say what is to be kept of each motion")
    samples = {one.count for one in maps.values() if type(one) is Samples}
    if len(samples) > 1:
        raise ValueError(f"maps sample at {sorted(samples)} times: all must have as many")
    for name, one in maps.items():
        taken = (STATUS, ENERGY, *module.STATE, *module.PARAMETERS)
        if not name.isidentifier() or len(name) > LONGEST or name in taken:
            raise ValueError(
                f"{name[:LONGEST]!r} cannot be a map's name: use up to {LONGEST} letters, digits "
                f"and _, and none of {', '.join(taken)}"
            )
        for component in one.components:
            if component not in module.STATE:
                raise ValueError(
                    f"map {name} names {component[:50]!r}"
                    f"{did_you_mean(component, module.STATE)}: known are {', '.join(module.STATE)}"
                )
        if isinstance(one, Final) and not one.of:
            raise ValueError(f"map {name} keeps nothing: name some of {', '.join(module.STATE)}")
        if isinstance(one, First) and not one.events(module):
            raise ValueError(f"map {name} watches nothing: name values by component")
        one.events(module)
        climbs = isinstance(one, First) and bool(one.barrier)
        if (climbs or isinstance(one, EnergyError)) and has_function(module, "power"):
            raise ValueError(f"map {name}: of this system the energy is not kept")
        if isinstance(one, First) and one.barrier:
            _check_barrier(module, axes, name, one, values)


def _check_barrier(
    module: GeneratedModule, axes: Axes, name: str, one: First, values: Values
) -> None:  # fmt: skip
    for watched in one.of:
        if watched not in module.COORDINATES:
            raise ValueError(
                f"map {name} has a barrier: then {watched} cannot be watched, for its value says "
                "nothing of the energy"
            )
    varied = [name for name in axes.smallest if name in module.PARAMETERS]
    if varied:
        raise ValueError(
            f"map {name} has a barrier, and {varied[0]} varies: which place is lowest depends on "
            "it, so that nothing is proved; leave one of them out"
        )
    known = {**dict(zip(module.PARAMETERS, module.DEFAULTS, strict=True)), **values}
    params = [float(known[parameter]) for parameter in module.PARAMETERS]
    if lower := lower_place(module, one.of, one.barrier, params):
        place = ", ".join(f"{q} = {value:.6g}" for q, value in lower.items())
        raise ValueError(
            f"map {name}: its barrier is too high, there is less energy at {place}; name that "
            "place, too"
        )
