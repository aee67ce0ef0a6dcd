"""Arguments of a wrong type are refused by name, in every function that takes texts or tables."""

from collections.abc import Callable

import numpy as np
import pytest

import generated.double_pendulum as dp
from solvers.integration.ensemble import ensemble
from solvers.integration.integrate import integrate
from solvers.scenes.scene import Scene
from solvers.sweeps.axes import Grid
from solvers.sweeps.maps import Map
from solvers.sweeps.maps.final import Final
from solvers.sweeps.maps.first import First
from solvers.sweeps.sweep import Sweep

START = (1.0, 0.0, 0.0, 0.0)
AXES = Grid({"theta1": [0.0, 0.1], "theta2": [0.0]})
INVALID = [True, 0.5, 10**400, b"1", object(), print, np.zeros(4), np.zeros((4, 2)), np.array("a")]


def swept(one: Map) -> Sweep:
    return Sweep(dp, AXES, {"end": one}, 1.0)


CALLS: dict[str, Callable[..., object]] = {
    **{
        name: lambda **value: Scene(dp, dp.DEFAULTS, START, 1.0, **value)
        for name in ("model", "method", "form", "code", "outputs", "pictures", "label", "title")
    },
    "axes": lambda axes: Sweep(dp, axes, {"end": Final(("theta1",))}, 1.0),
    "maps": lambda maps: Sweep(dp, AXES, maps, 1.0),
    "values": lambda values: Sweep(dp, AXES, {"end": Final(("theta1",))}, 1.0, values),
    "of": lambda of: swept(Final(of)),
    "backend": lambda backend: integrate(dp, (0, 1), START, dp.DEFAULTS, backend=backend),
    "stop": lambda stop: ensemble(dp, (0, 1), np.zeros((4, 2)), dp.DEFAULTS, stop=stop),
}


@pytest.mark.parametrize("value", INVALID, ids=lambda value: repr(value)[:20])
@pytest.mark.parametrize("name", CALLS)
def test_values_of_another_type_are_refused_by_name(name: str, value: object) -> None:
    with pytest.raises(ValueError, match=rf"\b{name} = .* must be "):
        CALLS[name](**{name: value})


def test_parts_of_tables_are_checked_too() -> None:
    with pytest.raises(ValueError, match=r"maps\['end'\] = 0.5 must be a map"):
        Sweep(dp, AXES, {"end": 0.5}, 1.0)  # type: ignore[dict-item]
    with pytest.raises(ValueError, match=r"of = \('theta1',\) must be a mapping"):
        swept(First(("theta1",)))  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"values = 3 must be a mapping"):
        Grid(3)  # type: ignore[arg-type]
