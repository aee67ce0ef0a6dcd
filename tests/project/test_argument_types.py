"""Arguments of a wrong type are refused by name, in every function that takes texts or tables."""

from collections.abc import Callable, Iterable
from inspect import signature

import numpy as np
import pytest

import generated.double_pendulum as dp
import solvers
from solvers import Event
from solvers.equations.signature_checks import checked
from solvers.integration.ensemble import ensemble
from solvers.integration.integrate import integrate
from solvers.scenes.scene import Scene
from solvers.sweeps.definition.axes import Grid
from solvers.sweeps.definition.sweep import Sweep
from solvers.sweeps.maps import Map
from solvers.sweeps.maps.final import Final
from solvers.sweeps.maps.first import First

START = (1.0, 0.0, 0.0, 0.0)
REST = solvers.equilibria(dp, {})[0]
ORBIT = solvers.normal_mode_orbit(dp, REST, REST.modes[0], 0.1)
DATA = {"t": [0.0, 0.1], "theta1": [1.0, 0.9]}
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
    "by": lambda by: solvers.sensitivities(dp, (0, 1), START, {}, by),
    "box": lambda box: solvers.equilibria(dp, {}, box),
    "outputs": lambda outputs: solvers.linearise(dp, START, {}, outputs=outputs),
    "start": lambda start: solvers.orbit_family(dp, start),
    "bounds": lambda bounds: solvers.orbit_family(dp, ORBIT, bounds=bounds),
    "direction": lambda direction: Event(dp, "theta1", 0.0, direction),
    "name": lambda name: Event(dp, name, 0.0),
    "equilibrium": lambda equilibrium: solvers.normal_mode_orbit(dp, equilibrium, REST.modes[0], 1),
    "mode": lambda mode: solvers.backbone_slope(dp, REST, mode),
    "model": lambda model: solvers.fit(model, DATA),
    "data": lambda data: solvers.fit(dp, data),
    "unknown": lambda unknown: solvers.fit(dp, DATA, unknown),
    "fits": lambda fits: solvers.compare(fits, DATA),
    "kept": lambda kept: solvers.compare({}, kept),
    "ignored": lambda ignored: solvers.read_measurement("a.csv", dp, ignored),
    "beside": lambda beside: solvers.run_scene("rest").save("a.svg", beside=beside),
    "path": lambda path: solvers.save(solvers.panels("a")[0], path),
    "figure": lambda figure: solvers.save(figure, "a.svg"),
    "size": lambda size: solvers.panels("a", size=size),
    "scene": lambda scene: solvers.run_scene(scene),
    "definition": lambda definition: solvers.sweep(definition, "out"),
    "executor": lambda executor: solvers.Pool(executor),
    "count": lambda count: swept(solvers.Samples(("theta1",), count)),
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


def test_parts_of_an_iterator_are_left_to_the_function() -> None:
    @checked
    def joined(names: Iterable[str]) -> str:
        return "".join(names)

    assert joined(iter(["a", "b"])) == joined(["a", "b"]) == "ab"
    with pytest.raises(ValueError, match="names = "):
        joined([1, 2])  # type: ignore[list-item]


MODULES = {
    name: function
    for name in solvers.__all__
    if name != "Status"  # whose values take other arguments
    and "module" in signature(function := getattr(solvers, name)).parameters
}


@pytest.mark.parametrize("value", [None, *INVALID, "double_pendulum"], ids=lambda v: repr(v)[:20])
@pytest.mark.parametrize("function", MODULES.values(), ids=MODULES)
def test_every_function_refuses_what_is_no_module(
    function: Callable[..., object], value: object
) -> None:
    parameters = signature(function).parameters.values()
    others = {one.name: None for one in parameters if one.default is one.empty}
    with pytest.raises(ValueError, match=r"^module = .* must be a generated module, such as"):
        function(**{"module": value} | {n: None for n in others if n != "module"})


@pytest.mark.parametrize("name", ["step", "dt", "step_size"])
@pytest.mark.parametrize("function", [integrate, ensemble, solvers.prepare])
def test_another_name_of_the_step_size_is_answered(
    function: Callable[..., object], name: str
) -> None:
    message = rf"{function.__name__}\(\) has no argument '{name}' \(did you mean 'h'\?\); known"
    with pytest.raises(TypeError, match=message):
        function(dp, **{name: 0.1})


def test_a_scene_and_a_function_with_unknown_arguments_suggest_known_ones() -> None:
    with pytest.raises(TypeError, match=r"Scene\(\) has no argument 'h' \(did you mean 'step'\?\)"):
        Scene(dp, dp.DEFAULTS, START, 1.0, h=0.1)  # type: ignore[call-arg]
    with pytest.raises(TypeError, match=r"equilibria\(\) has no argument 'boxes' .*'box'"):
        solvers.equilibria(dp, {}, boxes={})  # type: ignore[call-arg]
