"""Bifurcation diagrams follow attractors from value to value, and figures show all states."""

from math import pi

import numpy as np
import pytest

import generated.duffing as duffing
from solvers import Bifurcation, Final, Grid, Results, Sweep, integrate, sweep
from solvers.sweeps.sweep_figure import figure

PERIOD = "2*pi/Omega"
#: A stiffening spring, whose resonance is bent over these frequencies.
VALUES = {"m": 1.0, "k": 1.0, "c": 0.15, "beta": 1.0, "F": 0.3, "x": 0.0}
OMEGA = np.linspace(1.2, 1.9, 15)
MAP = Bifurcation(("x", "x_dot"), "Omega", PERIOD, skip=60, count=3)


@pytest.fixture(scope="module")
def diagram(tmp_path_factory: pytest.TempPathFactory) -> Results:
    axes = Grid({"F": [0.2, 0.3], "Omega": OMEGA})
    values = {name: value for name, value in VALUES.items() if name != "F"}
    definition = Sweep(duffing, axes, {"orbit": MAP}, values=values, rtol=1e-11, atol=1e-11)
    return sweep(definition, tmp_path_factory.mktemp("diagram"))


@pytest.mark.long("more cases of the same kind")
@pytest.mark.parametrize("direction", [0, 1])
def test_states_are_those_of_one_motion_whose_parameter_changes(
    diagram: Results, direction: int
) -> None:
    state, order = np.zeros(2), range(len(OMEGA))[:: 1 - 2 * direction]
    for k in order:
        omega = OMEGA[k]
        params = duffing.params(**{n: v for n, v in VALUES.items() if n != "x"}, Omega=omega)
        times = 2 * pi / omega * np.arange(64)
        options = {"rtol": 1e-11, "atol": 1e-11, "t_eval": times, "method": "dop853"}
        run = integrate(duffing, (0, times[-1]), state, params, **options)
        state = run.y[:, -1]
        assert diagram.maps["orbit"][1, k, :, :, direction] == pytest.approx(
            run.y[:, 61:], abs=1e-6
        )


def test_two_attractors_at_one_value_are_both_found(diagram: Results) -> None:
    up, down = np.moveaxis(diagram.maps["orbit"][1, :, 0, -1], -1, 0)
    differs = np.abs(up - down) > 0.1
    assert 2 < differs.sum() < len(OMEGA) - 2
    # between the jumps, and nowhere else
    assert np.diff(np.flatnonzero(differs)).tolist() == [1] * (differs.sum() - 1)
    assert np.abs(up - down)[~differs].max() < 1e-4


def test_the_figure_has_all_states_in_a_colour_for_each_direction(diagram: Results) -> None:
    panels = [panel for panel in figure(diagram).axes if panel.axison]
    assert len(panels) == 4
    for n, panel in enumerate(panels):
        states = diagram.maps["orbit"][n // 2, :, n % 2]
        down, up = panel.get_lines()
        assert (down.get_label(), up.get_label()) == ("down", "up")
        assert down.get_color() != up.get_color()
        for line, k in ((up, 0), (down, 1)):
            assert np.array_equal(line.get_xdata(), np.repeat(OMEGA, 3))
            assert np.array_equal(line.get_ydata(), states[..., k].ravel())
        # the states span the axes
        assert np.ptp(states) > 0.8 * np.ptp(panel.get_ylim())
        assert np.ptp(OMEGA) > 0.8 * np.ptp(panel.get_xlim())
        assert "Omega" in panel.get_xlabel()


def test_the_parameter_is_the_last_axis_and_the_map_the_only_one() -> None:
    with pytest.raises(ValueError, match="must be a parameter and the last axis of a grid"):
        Sweep(duffing, Grid({"Omega": OMEGA, "F": [0.2, 0.3]}), {"orbit": MAP}, values={"x": 0.0})
    maps = {"orbit": MAP, "end": Final(("x",))}
    with pytest.raises(ValueError, match="follows motions along an axis: it must be the only map"):
        Sweep(duffing, Grid({"Omega": OMEGA}), maps, values=VALUES)
