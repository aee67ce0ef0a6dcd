"""The pipeline from the positions of two bobs to their state after 5 s, in several programs.

Each program uses the equations that it derives itself, or those of SymPy's mechanics, and runs
with the loosest tolerance of sufficient accuracy.
"""

import tempfile
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import chdir
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from benchmarks import heyoka
from benchmarks.median_times import compile_loop
from benchmarks.motions import END, FINAL, START
from solvers.equations.module import GeneratedModule
from solvers.integration.accuracy.integration_run import median_seconds
from solvers.integration.prepare import prepare
from solvers.io.terminal import text_table

Array = NDArray[np.float64]
#: Takes a tolerance; returns a function that returns the final state.
Run = Callable[[float], Callable[[], Any]]
#: Seconds of derivation and of preparation, and the run.
Prepared = tuple[float, float, Run]
#: Derives a chain of pendulums.
Chain = Callable[[int, str], Any]
Mechanics = Callable[[int], Any]

#: Largest error of the final state in rad and rad/s, and the tolerances.
ERROR, TOLERANCES = 1e-9, 10.0 ** -np.arange(6, 14)


@dataclass(frozen=True)
class Pipeline:
    """Times of one program in s."""

    name: str
    derivation: float
    preparation: float  # of the first run
    run: float
    global_error: float  # of the final state


def pipelines(
    module: GeneratedModule, peer: Callable[[str], Any], chain: Chain, mechanics: Mechanics
) -> list[Pipeline]:
    """The pipelines of all programs, ours first; `peer` returns the package of another one."""
    programs: Mapping[str, Callable[[], Prepared]] = {
        "holonomic": lambda: _ours(module, chain),
        "heyoka.py": lambda: _heyoka(peer("heyoka"), module),
        "JiTCODE, equations by SymPy": lambda: _jitcode(peer("jitcode"), module, mechanics),
        "SciPy's DOP853, equations by holonomic": lambda: _scipy(module, chain),
        "PyDy with Cython, SymPy, SciPy's DOP853": lambda: _pydy(peer("pydy"), module, mechanics),
    }
    return [_measured(name, *prepared()) for name, prepared in programs.items()]


def summary(results: list[Pipeline]) -> Iterator[str]:
    """The pipelines as a table."""
    yield f"From positions to 5 s of motion, error below {ERROR:g}; seconds:"
    columns = {"": "", "derivation": ".2f", "preparation": ".2f", "run": ".2g", "ratio": ",.1f"}
    rows = ((p.name, p.derivation, p.preparation, p.run, p.run / results[0].run) for p in results)
    yield from text_table(columns, rows)


def _measured(name: str, derivation: float, preparation: float, run: Run) -> Pipeline:
    for tolerance in TOLERANCES:
        ready = run(float(tolerance))
        error = float(np.abs(np.asarray(ready())[: len(FINAL)] - FINAL).max())
        if error < ERROR:
            return Pipeline(name, derivation, preparation, median_seconds(ready), error)
    raise ArithmeticError(f"{name} does not reach an error of {ERROR:g} with any tolerance")


def _ours(module: GeneratedModule, chain: Chain) -> Prepared:
    derived, emitted, *_ = chain(2, "_rational")
    start = time.perf_counter()
    compile_loop(module)
    preparation = emitted + time.perf_counter() - start

    def run(tolerance: float) -> Callable[[], Any]:
        ready = prepare(module, module.DEFAULTS, method="verner98", rtol=tolerance, atol=tolerance)
        return lambda: ready((0.0, END), START)

    return derived, preparation, run


def _heyoka(hy: Any, module: GeneratedModule) -> Prepared:
    start = time.perf_counter()
    system = heyoka.double_pendulum(hy)["positions"]
    derived = time.perf_counter()
    hy.llvm_state.clear_memcache()
    run = partial(heyoka.single, hy, system, START, module.DEFAULTS, END)
    with heyoka.no_disk_cache(hy):
        run(1e-9)
    return derived - start, time.perf_counter() - derived, run


def _jitcode(package: Any, module: GeneratedModule, mechanics: Mechanics) -> Prepared:
    start = time.perf_counter()
    system = mechanics(2)
    derived = time.perf_counter()
    state = {s: package.y(k) for k, s in enumerate((*system.coordinates, *system.speeds))}
    values = dict(zip(system.constants, module.DEFAULTS, strict=True))
    field = [rate.subs({**state, **values}) for rate in system.rates]
    with tempfile.TemporaryDirectory() as folder, chdir(folder):
        ode = package.jitcode(field, verbose=False)
        ode.set_integrator("dop853")  # compiles
        ode.set_initial_value(np.array(START), 0.0)  # required before another tolerance
    preparation = time.perf_counter() - derived

    def run(tolerance: float) -> Callable[[], Any]:
        ode.set_integrator("dop853", rtol=tolerance, atol=tolerance)

        def ready() -> Any:
            ode.set_initial_value(np.array(START), 0.0)
            return ode.integrate(END)

        return ready

    return derived - start, preparation, run


def _scipy(module: GeneratedModule, chain: Chain) -> Prepared:
    derived, emitted, *_ = chain(2, "")
    return derived, emitted, lambda tol: partial(_dop853, module.rhs, tol, module.DEFAULTS)


def _pydy(package: Any, module: GeneratedModule, mechanics: Mechanics) -> Prepared:
    generators: Any = import_module(f"{package.__name__}.codegen.ode_function_generators")
    start = time.perf_counter()
    system = mechanics(2)
    derived = time.perf_counter()
    arguments = system.forcing, list(system.coordinates), list(system.speeds)
    options = {"constants": list(system.constants), "mass_matrix": system.mass_matrix}
    field = generators.generate_ode_function(*arguments, **options, generator="cython")
    preparation, params = time.perf_counter() - derived, np.array(module.DEFAULTS)

    def rhs(t: float, y: Array, params: Array) -> Any:
        return field(y, t, params)

    return derived - start, preparation, lambda tol: partial(_dop853, rhs, tol, params)


def _dop853(rhs: Callable[..., Any], tol: float, params: Any) -> Any:
    options = {"method": "DOP853", "rtol": tol, "atol": tol, "t_eval": [END]}
    return solve_ivp(rhs, (0.0, END), START, args=(params,), **options).y[:, -1]
