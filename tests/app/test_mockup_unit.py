"""Functional mock-up units: their description, and their functions by a loader of our own."""

import ctypes
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Sequence
from pathlib import Path
from tempfile import mkdtemp
from xml.etree import ElementTree

import numpy as np
import pytest

import generated.double_pendulum as dp
import generated.two_link_arm as arm
from derive import Simulation, load
from derive.codegen.export.targets.fmu import TRIVIAL, UNSUPPORTED
from solvers import Event, integrate
from solvers.app.cli import main
from solvers.app.mockup_unit import _description, write_unit
from solvers.runge_kutta import method_catalogue

pytestmark = pytest.mark.skipif(shutil.which("cc") is None, reason="needs a C compiler")
METHOD = method_catalogue.load("verner853")
START = (1.0, 2.0, 0.0, 0.5)


class Unit:
    """A unit whose functions are called as an importer calls them."""

    def __init__(self, path: Path, kind: str = "CoSimulation", *, has_events: bool = False) -> None:
        folder = Path(mkdtemp(dir=path.parent))  # a loaded library must not be overwritten
        with zipfile.ZipFile(path) as file:
            file.extractall(folder)
        root = ElementTree.parse(folder / "modelDescription.xml").getroot()
        rows = root.find("ModelVariables") or ()
        self.references = {one.attrib["name"]: int(one.attrib["valueReference"]) for one in rows}
        self.description = root
        (library,) = (folder / "binaries").glob("*/*")
        self.functions = ctypes.CDLL(str(library))
        instantiate = getattr(self.functions, f"fmi3Instantiate{kind}")
        instantiate.restype = ctypes.c_void_p
        texts, flags = (b"unit", b"token", b""), (False, False, has_events, has_events)
        self.instance = ctypes.c_void_p(instantiate(*texts, *map(ctypes.c_bool, flags)))

    def values(self, *names: str) -> list[float]:
        numbers = (ctypes.c_double * len(names))()
        self.call("GetFloat64", self._references(names), ctypes.c_size_t(len(names)), numbers)
        return [*numbers]

    def set(self, **values: float) -> None:
        numbers = (ctypes.c_double * len(values))(*values.values())
        self.call("SetFloat64", self._references([*values]), ctypes.c_size_t(len(values)), numbers)

    def step(self, t: float, size: float) -> float | None:
        """Advance to t + size, or to an event before, whose time is returned."""
        event, ends, is_early = (ctypes.c_bool() for _ in range(3))
        time, last = (ctypes.c_double(t), ctypes.c_double(size)), ctypes.c_double()
        outputs = map(ctypes.byref, (event, ends, is_early, last))
        self.call("DoStep", *time, ctypes.c_bool(True), *outputs)
        assert is_early.value == (last.value < t + size)
        assert last.value == t + size or event.value
        return last.value if event.value else None

    def call(self, name: str, *arguments: object) -> None:
        assert getattr(self.functions, f"fmi3{name}")(self.instance, *arguments) == 0

    def _references(self, names: Sequence[str]) -> object:
        return (ctypes.c_uint32 * len(names))(*(self.references[name] for name in names))


@pytest.fixture
def path(tmp_path: Path) -> Path:
    simulation = Simulation(METHOD, dp.DEFAULTS, START, 2.0, samples=4, rtol=1e-11, atol=1e-11)
    return write_unit(load("double_pendulum"), simulation, tmp_path)


def test_co_simulation_has_the_motion_of_the_system(path: Path) -> None:
    unit = Unit(path)
    unit.set(m2=0.5)
    unit.call("ExitInitializationMode")
    for k in range(4):
        unit.step(0.5 * k, 0.5)
    params = dp.params(m2=0.5)
    exact = integrate(dp, (0, 2), START, params, method="gauss8", rtol=1e-13, atol=1e-13)
    y = unit.values(*dp.STATE)
    assert y == pytest.approx(exact.y[:, -1].tolist(), abs=1e-8)
    assert unit.values("energy")[0] == pytest.approx(dp.energy(2.0, y, params), rel=1e-13)


def test_model_exchange_has_the_derivatives_of_the_system(path: Path) -> None:
    unit = Unit(path, "ModelExchange")
    random = np.random.default_rng(0)
    for y in random.normal(size=(20, 4)):
        states, result = (ctypes.c_double * 4)(*y), (ctypes.c_double * 4)()
        unit.call("SetContinuousStates", states, ctypes.c_size_t(4))
        unit.call("GetContinuousStateDerivatives", result, ctypes.c_size_t(4))
        expected = dp.rhs(0.0, y, dp.DEFAULTS)
        assert [*result] == pytest.approx(expected, rel=1e-12, abs=1e-13)
        names = [f"der({name})" for name in dp.STATE]
        assert unit.values(*names) == [*result]


def test_states_can_be_set_and_have_nominal_values_of_one(path: Path) -> None:
    unit, values = Unit(path, "ModelExchange"), (ctypes.c_double * 4)()
    for name, value in zip(dp.STATE, (0.1, -0.2, 0.3, 0.4), strict=True):
        unit.set(**{name: value})
    unit.call("GetContinuousStates", values, ctypes.c_size_t(4))
    assert [*values] == [0.1, -0.2, 0.3, 0.4]
    unit.call("GetNominalsOfContinuousStates", values, ctypes.c_size_t(4))
    assert [*values] == [1.0] * 4


def test_states_are_saved_and_restored(path: Path) -> None:
    unit, state = Unit(path), ctypes.c_void_p()
    unit.step(0.0, 0.5)
    before = unit.values(*dp.STATE)
    unit.call("GetFMUState", ctypes.byref(state))
    unit.step(0.5, 0.5)
    after = unit.values(*dp.STATE)
    unit.call("SetFMUState", state)
    assert unit.values(*dp.STATE) == before
    unit.step(0.5, 0.5)
    assert unit.values(*dp.STATE) == after
    unit.call("Reset")
    assert unit.values(*dp.STATE) == pytest.approx(START, abs=1e-15)


@pytest.mark.long("other tests reach its code")
def test_inputs_act_between_steps(tmp_path: Path) -> None:
    start = (0.1, 0.2, 0.0, 0.0)
    of = Simulation(METHOD, arm.DEFAULTS, start, 1.0, samples=2, rtol=1e-11, atol=1e-11)
    unit = Unit(write_unit(load("two_link_arm"), of, tmp_path))
    variables = unit.description.find("ModelVariables") or ()
    inputs = [one.attrib["name"] for one in variables if one.attrib.get("causality") == "input"]
    assert inputs == [*arm.INPUTS]
    unit.set(**dict.fromkeys(inputs, 2.0))
    unit.step(0.0, 1.0)
    params = arm.params(**dict.fromkeys(inputs, 2.0))
    exact = integrate(arm, (0, 1), start, params, method="gauss8", rtol=1e-13, atol=1e-13)
    assert unit.values(*arm.STATE) == pytest.approx(exact.y[:, -1].tolist(), abs=1e-8)


@pytest.fixture
def swinging(tmp_path: Path) -> tuple[Path, list[float]]:
    """A unit with the event theta1 = 0, and times of the event by `integrate`."""
    of = Simulation(METHOD, dp.DEFAULTS, START, 5.0, rtol=1e-11, atol=1e-11, event=("theta1", 0.0))
    event = Event(dp, "theta1", 0.0)
    options = {"method": "gauss8", "rtol": 1e-13, "atol": 1e-13, "events": event}
    motion = integrate(dp, (0, 5), START, dp.DEFAULTS, **options)
    return write_unit(load("double_pendulum"), of, tmp_path), motion.t_events[0].tolist()


def test_steps_of_co_simulation_end_at_events(swinging: tuple[Path, list[float]]) -> None:
    unit, t, times = Unit(swinging[0], has_events=True), 0.0, list[float]()
    while t < 5.0:
        event = unit.step(t, 5.0 - t)
        t = 5.0 if event is None else event
        if event is not None:
            times.append(event)
            assert unit.values("time") == [event]
            assert abs(unit.values("theta1")[0]) < 1e-12
    assert len(times) == 3
    assert times == pytest.approx(swinging[1], abs=1e-8)


def test_events_do_not_change_the_motion_without_event_mode(
    swinging: tuple[Path, list[float]],
) -> None:
    ends = []
    for has_events in (False, True):
        unit = Unit(swinging[0], has_events=has_events)
        t = 0.0
        while t < 5.0:
            event = unit.step(t, 5.0 - t)
            assert has_events or event is None
            t = 5.0 if event is None else event
        ends.append(unit.values(*dp.STATE))
    assert ends[0] == pytest.approx(ends[1], abs=1e-8)


def test_the_indicator_of_an_event_is_the_distance_to_its_value(
    swinging: tuple[Path, list[float]],
) -> None:
    unit, number = Unit(swinging[0], "ModelExchange"), ctypes.c_size_t()
    unit.call("GetNumberOfEventIndicators", ctypes.byref(number))
    assert number.value == 1
    for theta1 in (-7.0, -0.5, 0.0, 0.5, 2 * np.pi):
        states, indicator = (ctypes.c_double * 4)(theta1, 1.0, 0.0, 0.0), ctypes.c_double()
        unit.call("SetContinuousStates", states, ctypes.c_size_t(4))
        unit.call("GetEventIndicators", ctypes.byref(indicator), number)
        assert indicator.value == pytest.approx(theta1, abs=1e-14)
        assert unit.values("event") == [indicator.value]


def test_all_functions_of_the_standard_are_there_and_references_match(path: Path) -> None:
    unit = Unit(path)
    assert all(hasattr(unit.functions, f"fmi3{name}") for name in (*UNSUPPORTED, *TRIVIAL))
    assert unit.values("time", *dp.PARAMETERS) == [0.0, *dp.DEFAULTS]
    assert sorted(unit.references.values()) == [*range(len(unit.references))]


@pytest.mark.parametrize("event", [None, ("theta1", 0.5)])
def test_the_structure_refers_to_its_variables_as_the_standard_requires(
    event: tuple[str, float] | None,
) -> None:
    """Against the rules of FMI 3.0 (2.4.8) for each list, by causality, derivative and initial."""
    of = Simulation(METHOD, arm.DEFAULTS, START, 2.5, rtol=1e-9, atol=1e-9, event=event)
    root = ElementTree.fromstring(_description(load("two_link_arm"), of, "arm", "source"))
    variables = [one.attrib for one in root.findall("ModelVariables/*")]
    names = {one["valueReference"]: one["name"] for one in variables}
    assert len(names) == len(variables)

    def listed(kind: str) -> list[str]:
        return [
            names[one.attrib["valueReference"]] for one in root.findall(f"ModelStructure/{kind}")
        ]

    rates = {one["name"]: names[one["derivative"]] for one in variables if "derivative" in one}
    outputs = [one["name"] for one in variables if one.get("causality") == "output"]
    calculated = [one["name"] for one in variables if one.get("initial") == "calculated"]
    assert listed("Output") == outputs == [*arm.STATE, "energy"]
    assert listed("ContinuousStateDerivative") == [*rates]
    assert rates == {f"der({name})": name for name in arm.STATE}
    assert listed("InitialUnknown") == calculated
    assert listed("EventIndicator") == ["event"] * (event is not None)
    starts = {one["name"]: float(one["start"]) for one in variables if "start" in one}
    assert starts == dict(zip((*arm.STATE, *arm.PARAMETERS), (*START, *arm.DEFAULTS), strict=True))
    for one in variables:
        assert (one.get("causality") == "input") == (one["name"] in arm.INPUTS)
        assert (one.get("causality") == "parameter") == (
            one["name"] in {*arm.PARAMETERS} - {*arm.INPUTS}
        )
    assert root.find("DefaultExperiment").attrib == {"startTime": "0", "stopTime": "2.5"}


def test_an_importer_finds_no_problem_and_simulates(tmp_path: Path) -> None:
    fmpy = pytest.importorskip("fmpy")
    from fmpy.validation import validate_fmu

    path, python = tmp_path / "report.fmu", tmp_path / "report.py"
    for target in ("fmu", "python"):
        arguments = ["--to", target, "--event", "theta1 = 0", "--output", str(tmp_path)]
        assert main(["export", "report", *arguments]) == 0
    assert validate_fmu(str(path)) == []
    run = subprocess.run([sys.executable, python], capture_output=True, text=True, check=True)
    rows = [[*map(float, row.split(","))] for row in run.stdout.splitlines()[1:]]
    events = [row[0] for row in rows if row[-1] == 1]
    assert len(events) > 3
    options = {"solver": "CVode", "relative_tolerance": 1e-9, "output_interval": 0.5}
    options |= {"use_event_mode": True, "early_return_allowed": True, "stop_time": 5.0}
    for kind, error in (("CoSimulation", 1e-9), ("ModelExchange", 1e-5)):
        result = fmpy.simulate_fmu(str(path), fmi_type=kind, **options)
        assert result[-1]["theta1"] == pytest.approx(rows[-1][1], abs=error)
        zeros = [row["time"] for row in result if abs(row["theta1"]) < error]
        assert np.unique(np.round(zeros, 4)) == pytest.approx(np.round(events, 4))
    # an importer that permits no early return has whole steps
    options["early_return_allowed"] = False
    whole = fmpy.simulate_fmu(str(path), fmi_type="CoSimulation", **options)
    assert whole["time"] == pytest.approx(np.linspace(0, 5, 11))


def test_a_system_without_a_start_is_no_unit(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ["export", "double_pendulum", "--to", "fmu", "--output", str(tmp_path)]
    assert main(arguments) == 2
    assert "fmu is a simulation: give a scene" in capsys.readouterr().err
