"""Fixtures that several tests use, and the selection and order of the tests."""

import gc
import os
import re
import shutil
import signal
from collections.abc import Callable, Iterator
from datetime import date
from functools import cache
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

import cheap_compiler
import pytest
import sympy as sp
from browser import Player
from case_choice import cases_beyond
from recording import RECORDS, Record
from sharing import Shared

from derive import Derivation, load
from derive.formulas.expression import Namespace
from derive.verification import hand_derivation_files
from derive.verification.judging.reference_system import ReferenceSystem
from solvers.app.modules import load as load_module
from solvers.integration.checks import predictability
from solvers.scenes.scene_reading import find
from solvers.studies.failure_modes.chaos import Chaos, ChaosResults
from solvers.studies.stability import CriticalStep, SceneStability

#: The environment variable that chooses the cases of long tests which run on a day.
SEED = "HOLONOMIC_TEST_SEED"


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the options for the long part of the tests, and for recorded outputs."""
    parser.addoption("--long", action="store_true", help="also run tests that are marked long")
    parser.addoption("--record", action="store_true", help="write recorded outputs anew")


def pytest_configure(config: pytest.Config) -> None:
    """Compile with less optimisation, and let all workers choose the same cases."""
    gc.disable()  # until all files are imported, of which nothing is garbage
    flags = cheap_compiler.LONG if config.getoption("long") else cheap_compiler.SHORT
    cheap_compiler.install(flags)
    os.environ.setdefault(SEED, date.today().isoformat())


def pytest_collection_finish() -> None:
    """Collect garbage less often, and never what importing the tests' files created."""
    gc.freeze()
    gc.enable()
    gc.set_threshold(100_000, 20, 20)


def pytest_report_header(config: pytest.Config) -> str:
    """How to repeat the choice of cases."""
    return f"cases of long tests: {SEED}={os.environ[SEED]}"


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave out the long part, unless requested, and let every worker begin with slow tests.

    With the long part, cases beyond those of the day belong to the campaign. Tests that are named
    one by one are requested. Workers receive equal parts of the list.
    """
    if not any("::" in argument for argument in config.args):
        if config.getoption("long"):
            for item in cases_beyond(items, "daily", os.environ[SEED]):
                item.add_marker("campaign")
        else:
            left_out = cases_beyond(items, "keep", os.environ[SEED])
            config.hook.pytest_deselected(items=[*left_out])
            items[:] = [item for item in items if item not in left_out]
    workers = getattr(config, "workerinput", {}).get("workercount", 1)
    slow = [item for item in items if item.get_closest_marker("slow")]
    other = [item for item in items if not item.get_closest_marker("slow")]
    total = len(items)
    items.clear()
    for k in range(workers):
        first = slow[k::workers]
        size = (total - len(items)) // (workers - k) - len(first)
        items += [*first, *other[:size]]
        other = other[size:]


@pytest.fixture(scope="session")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Shared:
    """``shared(name, compute)``: a result that one worker computes and all workers use."""
    folder = tmp_path_factory.getbasetemp()
    return Shared(folder.parent if "PYTEST_XDIST_WORKER" in os.environ else folder)


@pytest.fixture(scope="session")
def large_module() -> Callable[[str], ModuleType]:
    """Modules that take long to load, once a worker."""
    return cache(load_module)  # type: ignore[return-value]


@pytest.fixture
def record(request: pytest.FixtureRequest) -> Record:
    """The recorded output of the test."""
    name = re.sub(r"^test_|_(is|are)_as_recorded", "", request.node.name)
    stem = re.sub(r"\W+", "_", name).strip("_")
    return Record(RECORDS / f"{stem}.txt", request.config.getoption("--record"))


@pytest.fixture
def fused() -> Iterator[None]:
    """Fuse products and sums as users' compilers do, in less time."""
    with cheap_compiler.compiling(cheap_compiler.LONG):
        yield


@pytest.fixture
def predictable_times() -> None:
    """Compute the times up to which motions are predictable in the short part, too."""


@pytest.fixture(autouse=True)
def few_predictable_times(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """In the short part, compute them only where they are tested: each needs another library."""
    is_needed = request.config.getoption("long") or "predictable_times" in request.fixturenames
    if not is_needed:
        monkeypatch.setattr(predictability, "_has_perturbations", lambda _module: False)


@pytest.fixture(scope="session", autouse=True)
def interrupt_signals() -> None:
    """Tests interrupt programs; a background job of a shell ignores the signal at first."""
    signal.signal(signal.SIGINT, signal.default_int_handler)


#: Systems without constraints or explicit time, whose coordinates may have any value.
PLAIN = ("double_pendulum", "elastic_pendulum", "single_pendulum")


@pytest.fixture(scope="session", params=PLAIN)
def derivation(request: pytest.FixtureRequest) -> Derivation:
    return Derivation(load(request.param))


@pytest.fixture(scope="session")
def module(derivation: Derivation) -> ModuleType:
    return import_module(f"generated.{derivation.system.name}")


@pytest.fixture(scope="session")
def report_steps(shared: Shared) -> dict[str, CriticalStep]:
    """Critical steps of all methods for the scene of the report."""
    with cheap_compiler.compiling():  # roundings decide
        steps = shared("report_steps", lambda: SceneStability.of(find("report", load_module)).steps)
    return {step.method: step for step in steps}


@pytest.fixture(scope="session", autouse=True)
def shared_references() -> Iterator[None]:
    """Let hand derivations about equal systems share the derivation and its states."""
    models: dict[object, ReferenceSystem] = {}

    def model(derivation: Derivation, names: Namespace) -> ReferenceSystem:
        key = derivation, frozenset(names.items())
        return models.setdefault(key, ReferenceSystem(derivation, names))

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(hand_derivation_files, "Derivation", cache(Derivation))
        patch.setattr(hand_derivation_files, "ReferenceSystem", model)
        yield


@pytest.fixture(scope="session")
def chaotic(shared: Shared) -> ChaosResults:
    """The study of chaos with small settings."""
    results: ChaosResults = shared("chaos", lambda: Chaos.small().run(load_module))
    return results


@pytest.fixture(scope="session")
def double() -> Derivation:
    return Derivation(load("double_pendulum"))


@pytest.fixture(scope="session")
def motion(derivation: Derivation) -> dict[sp.Symbol, sp.Expr]:
    """Accelerations by coordinates and velocities, solved by SymPy from the residuals."""
    system = derivation.system
    solution = sp.solve(list(derivation.euler_lagrange), system.qddot, dict=True)
    return dict(solution[0])


CHROMIUM = (
    "--headless=new --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-sync "
    "--disable-background-networking --disable-component-update"
).split()


@pytest.fixture(scope="session")
def driver(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    webdriver = pytest.importorskip("selenium.webdriver", reason="needs: pip install selenium")
    programs = shutil.which("chromium"), shutil.which("chromedriver")
    if None in programs:
        pytest.skip("needs Chromium: apt-get install chromium chromium-driver")
    options = webdriver.ChromeOptions()
    options.binary_location = programs[0]
    profile = tmp_path_factory.mktemp("profile")
    for flag in (*CHROMIUM, f"--user-data-dir={profile}"):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    service = webdriver.ChromeService(programs[1])
    driver = webdriver.Chrome(options=options, service=service)
    yield driver
    driver.quit()


@pytest.fixture
def player(driver: Any, tmp_path: Path) -> Iterator[Player]:
    driver.get("about:blank")
    driver.get_log("browser")
    yield Player(driver, tmp_path / "page.html")
    assert driver.get_log("browser") == []  # after every test
