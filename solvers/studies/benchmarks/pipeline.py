"""The whole way from the positions of two bobs to where they are after 5 s, in several programs.

Each takes the equations that it derives itself, or else those of SymPy's mechanics, and is run
with the loosest tolerance whose measured error is small enough.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import chdir
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from solvers.equations.module import GeneratedModule
from solvers.integration.compiled.compiler import build
from solvers.integration.compiled.kernel_source import program
from solvers.integration.compiled.native import equations
from solvers.integration.prepare import prepare
from solvers.integration.timing import median_seconds
from solvers.runge_kutta.catalogue import load
from solvers.studies import heyoka as peers
from solvers.studies.benchmarks.curves import END, FINAL, START

Array = NDArray[np.float64]
#: Gives the state at the end, for a tolerance.
Run = Callable[[float], Callable[[], Any]]

#: The error that all are to reach, in rad and rad/s, and the tolerances that are tried for it.
ERROR, TOLERANCES = 1e-9, 10.0 ** -np.arange(6, 14)


@dataclass(frozen=True)
class Way:
    """What the way takes in one program.

    Attributes
    ----------
    name : str
        Of the program.
    derivation, preparation, run : float
        Seconds until there are equations, until these can be run, and of one run.
    global_error : float
        At the end of the run.
    """

    name: str
    derivation: float
    preparation: float
    run: float
    global_error: float


def ways(
    module: GeneratedModule, peer: Callable[[str], Any], chain: Callable[[int, str], Any],
    mechanics: Callable[[int], Any],
) -> list[Way]:  # fmt: skip
    """The way in each program.

    Parameters
    ----------
    module : module
        The generated double pendulum.
    peer : callable
        Gives another program's package.
    chain, mechanics : callable
        Derive a chain of pendulums, here and with SymPy's mechanics.

    Returns
    -------
    list of Way
        Ours first.

    Raises
    ------
    ArithmeticError
        When a program does not come within `ERROR` of the end with any tolerance.
    """
    programs: Mapping[str, Callable[[], tuple[float, float, Run]]] = {
        "holonomic": lambda: _ours(module, chain),
        "heyoka.py": lambda: _heyoka(peer("heyoka"), module),
        "JiTCODE, equations by SymPy": lambda: _jitcode(peer("jitcode"), module, mechanics),
        "SciPy's DOP853, equations by holonomic": lambda: _scipy(module, chain),
        "PyDy with Cython, SymPy, SciPy's DOP853": lambda: _pydy(peer("pydy"), module, mechanics),
    }
    return [_way(name, *prepared()) for name, prepared in programs.items()]


def told(found: list[Way]) -> Iterator[str]:
    """The ways as a table."""
    yield f"From positions to 5 s of motion, error below {ERROR:g}; seconds:"
    yield f"{'':<40}{'derivation':>11}{'preparation':>13}{'run':>11}"
    for way in found:
        yield (
            f"{way.name:<40}{way.derivation:>11.2f}{way.preparation:>13.2f}{way.run:>11.2g}"
            f"{way.run / found[0].run:>9,.1f} x"
        )


def _way(name: str, derivation: float, preparation: float, run: Run) -> Way:
    for tolerance in TOLERANCES:
        ready = run(float(tolerance))
        error = float(np.abs(np.asarray(ready())[: len(FINAL)] - FINAL).max())
        if error < ERROR:
            return Way(name, derivation, preparation, median_seconds(ready), error)
    raise ArithmeticError(f"{name} does not come within {ERROR:g} of the end with any tolerance")


def _ours(
    module: GeneratedModule, chain: Callable[[int, str], Any]
) -> tuple[float, float, Run]:  # fmt: skip
    derived, emitted, *_ = chain(2, "_rational")
    begin = time.perf_counter()
    source = equations(module, "rational")
    text = program(source, load("verner98"), lanes=False, compensated=False)
    build(f"{text}/* {time.perf_counter_ns()} */")  # new to the cache
    preparation = emitted + time.perf_counter() - begin

    def run(tolerance: float) -> Callable[[], Any]:
        ready = prepare(module, module.DEFAULTS, method="verner98", rtol=tolerance, atol=tolerance)
        return lambda: ready((0.0, END), START)

    return derived, preparation, run


def _heyoka(hy: Any, module: GeneratedModule) -> tuple[float, float, Run]:
    begin = time.perf_counter()
    found = peers.double_pendulum(hy)["positions"]
    derived = time.perf_counter()
    hy.llvm_state.clear_memcache()
    hy.llvm_state.set_diskcache_enabled(False)

    def run(tolerance: float) -> Callable[[], Any]:
        return peers.single(hy, found, START, module.DEFAULTS, END, tolerance)

    try:
        run(1e-9)
    finally:
        hy.llvm_state.set_diskcache_enabled(True)
    return derived - begin, time.perf_counter() - derived, run


def _jitcode(
    package: Any, module: GeneratedModule, mechanics: Callable[[int], Any]
) -> tuple[float, float, Run]:
    begin = time.perf_counter()
    found = mechanics(2)
    derived = time.perf_counter()
    state = {s: package.y(k) for k, s in enumerate((*found.coordinates, *found.speeds))}
    values = dict(zip(found.constants, module.DEFAULTS, strict=True))
    field = [rate.subs({**state, **values}) for rate in found.rates]
    with tempfile.TemporaryDirectory() as folder, chdir(folder):
        ode = package.jitcode(field, verbose=False)
        ode.set_integrator("dop853")  # compiles
        ode.set_initial_value(np.array(START), 0.0)  # must be there before another tolerance
    preparation = time.perf_counter() - derived

    def run(tolerance: float) -> Callable[[], Any]:
        ode.set_integrator("dop853", rtol=tolerance, atol=tolerance)

        def ready() -> Any:
            ode.set_initial_value(np.array(START), 0.0)
            return ode.integrate(END)

        return ready

    return derived - begin, preparation, run


def _scipy(
    module: GeneratedModule, chain: Callable[[int, str], Any]
) -> tuple[float, float, Run]:  # fmt: skip
    derived, emitted, *_ = chain(2, "")

    def run(tolerance: float) -> Callable[[], Any]:
        return lambda: _dop853(module.rhs, tolerance, module.DEFAULTS)

    return derived, emitted, run


def _pydy(
    _: GeneratedModule, module: GeneratedModule, mechanics: Callable[[int], Any]
) -> tuple[float, float, Run]:
    generators: Any = import_module("pydy.codegen.ode_function_generators")
    begin = time.perf_counter()
    found = mechanics(2)
    derived = time.perf_counter()
    field = generators.generate_ode_function(
        found.forcing, list(found.coordinates), list(found.speeds),
        constants=list(found.constants), mass_matrix=found.mass_matrix, generator="cython",
    )  # fmt: skip
    preparation, params = time.perf_counter() - derived, np.array(module.DEFAULTS)

    def rhs(t: float, y: Array, params: Array) -> Any:
        return field(y, t, params)

    def run(tolerance: float) -> Callable[[], Any]:
        return lambda: _dop853(rhs, tolerance, params)

    return derived - begin, preparation, run


def _dop853(rhs: Callable[..., Any], tolerance: float, params: Any) -> Any:
    return solve_ivp(
        rhs, (0.0, END), START, method="DOP853", rtol=tolerance, atol=tolerance, t_eval=[END],
        args=(params,),
    ).y[:, -1]  # fmt: skip
