"""The work of every compiled loop: steps, rejected steps, evaluations, iterations."""

import ctypes
import re
from collections.abc import Sequence
from functools import cache
from math import pi
from typing import Any

import numpy as np
import pytest
import sympy
from friction import BELT, block
from recording import Record

import generated.double_pendulum as dp
import generated.duffing as duffing
import generated.elastic_pendulum as elastic
import generated.four_bar as four_bar
import generated.henon_heiles as hh
import generated.single_pendulum as sp
import generated.spherical_pendulum as spherical
from derive import TIME, Coordinate, Parameter, PointMass, System
from solvers.app.modules import build
from solvers.equations.module import GeneratedModule
from solvers.integration.compiled import extended, extended_source
from solvers.integration.compiled.extended import ExtendedKernel, integrate_extended
from solvers.integration.ensemble import ensemble
from solvers.integration.integrate import integrate
from solvers.integration.problem.events import Event
from solvers.integration.results.ensemble_solution import Ensemble
from solvers.integration.results.solution import Solution


@cache
def driven_oscillator() -> GeneratedModule:
    """A system whose equations contain the time, without functions."""
    x, m = sympy.Symbol("x", real=True), sympy.Symbol("m", positive=True)
    return build(
        System(
            "driven_oscillator", "", [Coordinate(x, "m", "position")],
            [Parameter(m, "kg", 1, "mass")], [PointMass(m, (x, 0))], x**4, forces=[TIME**3],
        )
    )  # fmt: skip


REPORT = (pi / 2, pi, 0.0, 0.0)
REGULAR = np.array([[0.1, 0.2, 0.05, 0.0], [0.2, 0.0, -0.1, 0.3], [0.3, 0.1, 0.2, 0.0], [0.1] * 4])
MANY = np.linspace(0, 10, 2001)
#: An elastic pendulum with a stiff spring.
SWING, STIFF = (1.2, 0.4, 0.0, 0.0), {"k": 1e5}
#: Motions with steps of each kind, and their options; functions give modules that are built.
MOTIONS: dict[str, tuple[Any, ...]] = {
    "explicit": (dp, (0, 9), REPORT, {}, {"method": "verner853"}),
    "first same as last": (dp, (0, 10), REPORT, {}, {"method": "dp54", "form": "lagrangian"}),
    "canonical": (dp, (0, 10), REPORT, {}, {"method": "tsit54", "form": "hamiltonian"}),
    "fixed": (dp, (0, 10), REPORT, {}, {"method": "rk4", "h": 0.0031}),
    "compensated": (sp, (0, 30), (3.1, 0.0), {}, {"method": "dop853", "compensated": True}),
    "splitting": (hh, (0, 40), (0.1, 0.2, 0.3, 0.2), {}, {"method": "leapfrog8", "h": 0.3}),
    "implicit": (elastic, (0, 0.4), SWING, STIFF, {"method": "radau5"}),
    "variable order": (elastic, (0, 0.4), SWING, STIFF, {"method": "radau", "rtol": 1e-6}),
    "implicit, absolute": (sp, (0, 5), (0, 20), {}, {"method": "radau5", "rtol": 0, "atol": 1.5}),
    "implicit, fixed": (elastic, (0, 3), SWING, STIFF, {"method": "gauss2", "h": 0.1}),
    "parallel": (dp, (0, 9), REPORT, {}, {"method": "gauss8"}),
    "parallel, loose": (dp, (0, 9), REPORT, {}, {"method": "gauss4", "rtol": 1e-4, "atol": 1e-4}),
    "samples": (dp, (0, 10), REPORT, {}, {"method": "radau3", "t_eval": MANY}),
    "parallel, samples": (dp, (0, 10), REPORT, {}, {"method": "gauss8", "t_eval": MANY}),
    # with tighter tolerances, roundings decide how many steps are rejected
    "constraints": (
        *(four_bar, (0, 5), {"phi": 1.0}, {}),
        {"method": "verner98", "rtol": 1e-8, "atol": 1e-8},
    ),
    "events": (
        *(duffing, (0, 100), (1.0, 0.0), {}),
        {"method": "verner98", "events": [Event(duffing, "x", 0.0), Event(duffing, "x_dot", 0.2)]},
    ),
    "events near an extremum": (
        *(sp, (0, 100), (1.0, 0.0), {}),
        {"method": "verner98", "rtol": 1e-4, "events": [Event(sp, "theta", 0.9999)]},
    ),
    "friction": (block, (0, 20), (0.5, 0.0), BELT, {"method": "verner853"}),
    "turns near a pole": (spherical, (0, 10), (1e-3, 0.0, 2.0, 1e-3), {}, {"method": "dp54"}),
    "backwards": (dp, (5, 0), REPORT, {}, {"method": "bs32", "rtol": 1e-5}),
    "backwards, samples": (
        *(dp, (5, 0), REPORT, {}),
        {"method": "verner98", "t_eval": MANY[1000::-1]},
    ),
    "lanes": (hh, (0, 40), REGULAR, {}, {"method": "verner853"}),
    "lanes, samples and events": (
        *(hh, (0, 40), REGULAR, {}),
        {"method": "dp54", "t_eval": MANY, "events": [Event(hh, "y", 0.1)]},
    ),
}
#: Statements of the loops in longer numbers, and the counter that each increases.
COUNTED = {
    r"motion->steps\+\+;": 0,
    r"const double factor = step\(motion": 1,
    r"(?<=\s)LOWER_RHS\(": 2,
    r"(?<=\s)RHS\(": 3,
}
#: Motions in longer numbers, to an end and a tolerance.
LONGER = {
    "double-double": (dp, REPORT, 6.0, 1e-24),
    "double-double, tight": (dp, REPORT, 1.0, 1e-33),
    "double-double, stiff": (elastic, SWING, 0.05, 1e-33),
    "double-double, driven": (driven_oscillator, (1.0, 0.5), 6.0, 1e-24),
    "long double": (elastic, SWING, 6.0, 1e-16),
    "quadruple": (hh, (0.1, 0.2, 0.3, 0.2), 6.0, 1e-22),
}


def built(module: Any) -> GeneratedModule:
    """A module, or that which a function builds."""
    return module() if callable(module) else module


def row(name: str, counts: Sequence[int], digits: int = 3) -> str:
    """A line of the record; with all digits, counts would depend on the compiler's rounding."""
    return f"{name}: {' '.join(f'{count:.{digits - 1}e}' for count in counts)}"


def work(motion: Solution | Ensemble) -> list[int]:
    """Steps, rejected steps, evaluations of derivatives and of their Jacobian."""
    counts = motion.steps, motion.rejected, motion.nfev, getattr(motion, "njev", ())
    return [int(count) for one in counts for count in np.ravel(one)]


def in_longer_numbers(name: str, monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Steps, attempts, and evaluations in shorter and in longer numbers, by statements added."""
    source, counted = extended_source.source, list[str]()

    def counting(file: str) -> str:
        text = source(file)
        for statement, k in COUNTED.items():
            counted.extend([statement] * len(re.findall(statement, text)))
            text = re.sub(statement, rf"work[{k}]++; \g<0>", text)
        if file != "extended_motion.h":
            return text
        return text.replace("typedef struct {", "int64_t work[4];\ntypedef struct {", 1)

    module, start, end, rtol = LONGER[name]
    module = built(module)
    params = module.params(**STIFF if "stiff" in name else {})
    precision, times = name.partition(",")[0], np.linspace(0, end, 4)
    with monkeypatch.context() as patch:
        patch.setattr(extended_source, "source", counting)
        patch.setattr("solvers.integration.compiled.double_double.source", counting)
        kernel = ExtendedKernel(module, precision)
    assert {*counted} == {*COUNTED}
    monkeypatch.setattr(extended, "kernel", lambda *_: kernel)
    integrate_extended(module, params, start, times, precision, rtol)
    return [*(ctypes.c_int64 * 4).in_dll(kernel.library.functions, "work")]


def test_the_work_of_motions_is_as_recorded(
    record: Record, monkeypatch: pytest.MonkeyPatch
) -> None:
    rows = []
    for name, (module, span, start, params, options) in MOTIONS.items():
        function = ensemble if name.startswith("lanes") else integrate
        rows.append(row(name, work(function(built(module), span, start, params, **options))))
    rows += [row(name, in_longer_numbers(name, monkeypatch), 2) for name in LONGER]
    record.check("\n".join(rows))
