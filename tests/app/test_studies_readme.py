"""Tables and statements of the README of studies are those of the code."""

import re
from math import log

import numpy as np
import pytest
from folders import ROOT

import generated.double_pendulum as dp
import generated.single_pendulum as sp
from solvers.app.modules import load
from solvers.app.report_evidence import Evidence
from solvers.app.report_verdicts import objectives
from solvers.runge_kutta.method_catalogue import load as load_method
from solvers.scenes.scene import Scene
from solvers.studies.failure_modes.chaos import CHAOTIC, LONG_RUNS, lyapunov, statistics
from solvers.studies.failure_modes.drift import EnergyDrift
from solvers.studies.failure_modes.separatrix import upright
from solvers.studies.failure_modes.stiffness import Stiffness, crossover
from solvers.studies.stability import CriticalStep

PATH = ROOT / "solvers" / "studies" / "README.md"
README = PATH.read_text(encoding="utf-8")
PROSE = " ".join(README.split())


@pytest.mark.long("critical steps of all methods in all scenes")
def test_the_table_of_longest_steps_is_true(report_steps: dict[str, CriticalStep]) -> None:
    rows = re.findall(r"^\| `(\w+)` \| (.*) \|$", README, re.MULTILINE)
    table = {name: cells.split(" | ") for name, cells in rows if name in report_steps}
    assert set(table) == set(report_steps)
    for name, step in report_steps.items():
        figures = (step.order, step.function.imaginary_stability_interval, step.predicted)
        cells = [float(cell.replace("∞", "inf")) for cell in table[name]]
        assert cells[:3] == pytest.approx(figures, rel=1e-4)
        # rounding errors decide where an iteration no longer converges
        accuracy = 0.1 if load_method(name).is_parallel else 2e-4
        assert cells[3] == pytest.approx(step.measured, rel=accuracy)


@pytest.mark.long("critical steps of all methods")
def test_the_growth_of_oscillations_is_true(report_steps: dict[str, CriticalStep]) -> None:
    growth = {name: step.growth_measured for name, step in report_steps.items()}
    assert f"by {100 * (np.exp(growth['rk1']) - 1):.0f} % per step" in PROSE
    assert f"by {growth['verner853']:.0e} per step with".replace("e-09", "e-9") in PROSE


@pytest.mark.long("other tests reach its code")
def test_the_exponent_and_the_horizons_are_true() -> None:
    exponent, error = map(float, re.findall(r"is (0\.\d+) ± (0\.\d+) per s", PROSE)[0])
    found = lyapunov(dp, dp.DEFAULTS, CHAOTIC, 5000)
    assert abs(found.value - exponent) < 4 * np.hypot(found.error, error)
    horizons = re.findall(
        r"(1e-\d+) (?:therefore gives an accurate trajectory )?for (\d+) s", PROSE
    )
    assert len(horizons) == 2
    for tolerance, horizon in horizons:
        assert round(log(1 / float(tolerance)) / exponent) == int(horizon)
    assert f"after {upright(sp).measured:.3f} s" in PROSE


@pytest.mark.long("a whole study")
def test_the_crossovers_of_stiff_scenes_are_true() -> None:
    methods = ("rk4", "verner853", "gauss2", "gauss3")
    costs = Stiffness((10.0, 30.0, 100.0), methods).run(load)
    stated = re.findall(r"frequencies of about (\d+), (\d+) and (\d+),", PROSE)[0]
    families = "short second rod", "light first mass", "stiff spring"
    for family, ratio in zip(families, stated, strict=True):
        assert crossover(costs, family, "work_rhs") == pytest.approx(float(ratio), rel=0.25)


def test_the_drifts_of_energy_are_true() -> None:
    cases = (
        ("rk4", "lagrangian", 60),
        ("verner853", "lagrangian", 15),
        ("gauss3", "hamiltonian", 20),
    )
    rk4, verner, gauss = EnergyDrift(1000, cases).run(load)
    rates = re.findall(
        r"at first (\S+) per period,.* gains (\S+) per period;.* below (\S+)\. -", PROSE
    )
    stated = list(map(float, rates[0]))
    assert stated == pytest.approx([-rk4.rate, verner.rate, gauss.largest_error], rel=0.1)


def test_the_calls_are_those_of_the_verdict() -> None:
    scene = Scene(dp, dp.DEFAULTS, CHAOTIC, 5.0)
    verdicts = objectives(Evidence(scene, scene, scene, scene), {"verified": 0, "misprint": 0})
    assert verdicts[2].number.removeprefix("for ") in PROSE.replace("`", "")


@pytest.mark.long("other tests reach its code")
def test_the_loss_of_energy_beyond_the_horizon_is_true() -> None:
    run = statistics(dp, 5e4, LONG_RUNS[-1])
    assert f"gives {run.kinetic.value:.0f} J; it loses {-100 * run.energy_error:.0f} %" in PROSE
