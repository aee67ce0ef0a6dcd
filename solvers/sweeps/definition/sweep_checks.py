"""Consistency of the parts of a sweep."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from math import prod

import numpy as np

from solvers.equations.module import GeneratedModule, has_constraints
from solvers.equations.number_checks import positive, quantity, real_number
from solvers.equations.singularities import Motion, examined
from solvers.io.argument_types import check_type
from solvers.io.suggestion import did_you_mean
from solvers.sweeps.definition.axes import Axes
from solvers.sweeps.maps import Map

#: A quantity beside coordinates, velocities and parameters.
ENERGY = "energy"
#: The value of a velocity that follows from the energy.
FROM_ENERGY = "energy"
#: The file that holds the status of each motion.
STATUS = "status"
#: Length of a map's name.
MAX_LENGTH = 50

Values = Mapping[str, float | str]


def unit(module: GeneratedModule, name: str) -> str:
    """The unit of a quantity."""
    return "J" if name == ENERGY else module.UNITS[name]


def check_names(module: GeneratedModule, axes: Axes, values: Values) -> None:
    """Check names and values of quantities."""
    own = (*module.STATE, *module.PARAMETERS)
    known, varied = (*own, ENERGY), tuple(axes.smallest)
    for name in own:
        if name in (ENERGY, STATUS):
            raise ValueError(f"the system calls a quantity {name!r}, a word reserved by sweeps")
    for name in (*varied, *values):
        if name not in known:
            hint = did_you_mean(name, known)
            raise ValueError(f"unknown quantity {name[:50]!r}{hint}; known are {', '.join(known)}")
    for name in varied:
        if name in values:
            raise ValueError(f"{name} varies and has the value {values[name]}; remove one")
    for name in module.COORDINATES:
        if name not in (*varied, *values) and not has_constraints(module):
            raise ValueError(f"{name} is missing: give its value or an axis")
    for name, value in {**values, **axes.smallest}.items():
        if isinstance(value, str) and value == FROM_ENERGY:
            continue
        if quantity(module, name, value, absent=False).ndim:
            raise ValueError(f"{name} = {value!r} must be one number")


def check_energy(module: GeneratedModule, given: Sequence[str], values: Values) -> None:
    """Check that an energy and one velocity that follows from it are given together."""
    free = [name for name, value in values.items() if value == FROM_ENERGY]
    velocities = module.STATE[len(module.COORDINATES) :]
    known = ", ".join(velocities)
    if len(free) > 1 or not {*free} <= {*velocities}:
        word = f'{", ".join(free)} = "{FROM_ENERGY}"'
        raise ValueError(f"{word}: the energy determines one velocity, one of {known}")
    if bool(free) != (ENERGY in given):
        raise ValueError(
            "an energy requires a velocity that follows from it, and vice versa: give energy, "
            f'and "{FROM_ENERGY}" as the value of one of {known}'
        )


def check_maps(
    module: GeneratedModule, axes: Axes, maps: Mapping[str, Map], values: Values
) -> None:
    """Check the names of maps, and each map against the sweep."""
    if not maps:
        raise ValueError("no maps: give at least one")
    for name, one in maps.items():
        check_type(f"maps[{name!r}]", one, Map, "a map, such as Final(('theta1',))")
    continued = [name for name, one in maps.items() if one.continued_along]
    if continued and len(maps) > 1:
        raise ValueError(
            f"map {continued[0]} follows motions along an axis: it must be the only map"
        )
    reserved = (STATUS, ENERGY, *module.STATE, *module.PARAMETERS)
    taken = {*map(str.casefold, reserved)}  # names of files, whose case may not count
    for name, one in maps.items():
        if not name.isidentifier() or len(name) > MAX_LENGTH or name.casefold() in taken:
            raise ValueError(
                f"{name[:MAX_LENGTH]!r} cannot be a map's name: use up to {MAX_LENGTH} letters, "
                f"digits and _, and none of {', '.join(reserved)}, nor the name of another map, in "
                "upper or lower case"
            )
        taken.add(name.casefold())
        try:
            one.check(module, axes, values)
        except ValueError as error:
            raise ValueError(f"map {name}: {error}") from error
    samplings = {one.sampling: name for name, one in maps.items() if one.sample_count}
    if len(samplings) > 1:
        both = " and ".join(samplings.values())
        raise ValueError(f"maps {both} have other times: all must have the same ones")
    counts = {one.sample_count for one in maps.values()} - {0}
    if len(counts) > 1:
        raise ValueError(f"maps have {sorted(counts)} samples: all must have the same number")


def check_duration(maps: Mapping[str, Map], duration: float | None, skip: float) -> None:
    """Check that exactly one of duration and maps determines the end of motions."""
    periodic = next((name for name, one in maps.items() if one.sampling), "")
    if real_number("skip", skip, "s") < 0:
        raise ValueError(f"skip = {skip:g} must not be negative")
    if not periodic:
        if duration is None:
            raise ValueError("duration is missing: give that of each motion in s")
        if skip >= positive("duration", duration):
            raise ValueError(f"skip = {skip:g} s must be less than duration = {duration:g} s")
    elif duration is not None:
        raise ValueError(
            f"duration = {duration:g}, but `every`, `skip` and `count` of map {periodic} determine "
            "it: leave it out"
        )
    elif skip:
        raise ValueError(f"skip = {skip:g} s: give `skip` of map {periodic}, in periods, instead")


def examined_motions(module: GeneratedModule, axes: Axes, values: Values) -> Iterator[Motion]:
    """Names, parameters and initial states of a few motions, with the corners of a grid."""
    ends = product(*((0, n - 1) for n in axes.shape))
    corners = (int(np.ravel_multi_index(end, axes.shape)) for end in ends)
    defaults = dict(zip(module.PARAMETERS, module.DEFAULTS, strict=True))
    at_rest = dict.fromkeys(module.STATE, 0.0)
    for k in sorted({*corners, *examined(prod(axes.shape))}):
        varied = {name: float(column[0]) for name, column in axes.columns(k, k + 1).items()}
        given = {**at_rest, **defaults, **values, **varied}
        where = ", ".join(f"{name} = {value:g}" for name, value in varied.items())
        # velocities do not matter, and one may follow from the energy
        state = [float(given[name]) for name in module.COORDINATES]
        state += [0.0] * len(module.COORDINATES)
        known = None if has_constraints(module) else state  # which determine coordinates later
        yield f"motion {k} ({where}): ", [float(given[p]) for p in module.PARAMETERS], known
