"""Other programs get the same equations, and are timed at equal errors of the same scenes."""

import math
import operator
import sys
from collections.abc import Callable, Iterator
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest
import sympy as sp
from benchmarks import heyoka, other_programs
from benchmarks.other_programs import Method, Run, SceneCosts, other_curves
from sharing import Shared

import generated.double_pendulum as dp
from derive import Derivation
from derive.formulas.generic_values import is_small
from solvers.app.modules import load as load_module
from solvers.equations.forms import Form, fastest_form
from solvers.scenes.scene_reading import find
from solvers.studies.work_precision.cost_curve import CostCurve, MeasuredRun
from solvers.studies.work_precision.reference import Reference

REPORT = find("report", load_module)


@pytest.fixture(scope="module")
def truth(shared: Shared) -> Reference:
    return shared("reference_report", lambda: Reference.of(REPORT))


@pytest.mark.long("other tests reach its code")
def test_installed_programs_have_curves(truth: Reference) -> None:
    # the state of the fastest form, which holds sine and cosine of each angle
    end = Form(dp, "rational", dp.DEFAULTS).from_ordinary(0.0, truth.end)

    class Package(ModuleType):
        @staticmethod
        def lsoda(*_: object, rtol: float, atol: float) -> tuple[np.ndarray, bool]:
            assert rtol == atol
            return np.array([end, end + rtol]), True

        @staticmethod
        def dop853(*_: object, rtol: float, atol: float) -> tuple[np.ndarray, bool]:
            return np.array([end, end]), False

    def package(name: str) -> ModuleType | None:
        return Package(name) if name == "numbalsoda" else None

    (lsoda, dop853), _ = other_curves(REPORT, truth, package)
    assert (lsoda.method, lsoda.form, lsoda.backend) == ("lsoda", "rational", "numbalsoda")
    for p in lsoda.points:
        assert 0.9 < p.global_error / p.setting["rtol"] < 1.5
    assert dop853.points == []
    assert other_curves(REPORT, truth, lambda _: None) == ([], {})


@pytest.mark.long("other tests reach its code")
def test_lsoda_gets_no_tolerance_of_which_it_warns(truth: Reference) -> None:
    end = Form(dp, "rational", dp.DEFAULTS).from_ordinary(0.0, truth.end)
    settings: dict[str, list[float]] = {"lsoda": [], "dop853": []}

    def solver(name: str) -> Callable[..., tuple[np.ndarray, bool]]:
        def solve(*_: object, rtol: float, atol: float) -> tuple[np.ndarray, bool]:
            settings[name] += [rtol] if rtol not in settings[name] else []
            return np.array([end]), True

        return solve

    program = ModuleType("numbalsoda")
    vars(program).update({name: solver(name) for name in settings})
    other_curves(REPORT, truth, lambda name: program if name == "numbalsoda" else None)
    assert settings["lsoda"] == pytest.approx(10.0 ** -np.arange(1, 13), abs=0)
    assert settings["dop853"] == pytest.approx(10.0 ** -np.arange(1, 15), abs=0)


def test_the_loop_for_numba_is_rk4(truth: Reference, monkeypatch: pytest.MonkeyPatch) -> None:
    tuples = ModuleType("numba.np.unsafe.ndarray")
    vars(tuples)["to_fixed_tuple"] = lambda stage, size: tuple(stage[:size])
    monkeypatch.setitem(sys.modules, tuples.__name__, tuples)
    monkeypatch.setattr(other_programs, "STEPS", np.array([500, 1000]))
    monkeypatch.setattr(other_programs, "median_seconds", lambda _: 1e-3)
    program = ModuleType("numba")
    vars(program)["njit"] = lambda function: function
    (one,), _ = other_curves(REPORT, truth, lambda name: program if name == "numba" else None)
    assert (one.backend, one.method) == ("numba", "rk4")
    assert [(p.setting, p.work_rhs) for p in one.points] == [
        ({"h": 0.01}, 2000),
        ({"h": 0.005}, 4000),
    ]
    coarse, fine = (p.global_error for p in one.points)
    assert fine < 1e-5
    assert coarse / fine > 0.9 * 2**4


class Expression:
    """A number in another program's arithmetic, which the functions of ``math`` refuse."""

    def __init__(self, value: float) -> None:
        self.value = value

    def __neg__(self) -> "Expression":
        return Expression(-self.value)


def arithmetic(operation: Callable[[float, float], float]) -> Callable[..., Expression]:
    def combined(one: Expression, other: "Expression | float") -> Expression:
        return Expression(operation(one.value, getattr(other, "value", other)))

    return combined


for name in ("add", "sub", "mul", "truediv"):
    setattr(Expression, f"__{name}__", arithmetic(getattr(operator, name)))
    reflected = arithmetic(lambda a, b, name=name: getattr(operator, name)(b, a))
    setattr(Expression, f"__r{name}__", reflected)


@pytest.mark.parametrize("system", ["henon_heiles", "foucault_pendulum", "driven_pendulum"])
def test_heyoka_gets_the_equations_of_every_system(system: str) -> None:
    module, t = load_module(system), 0.3
    form = Form(module, fastest_form(module), module.DEFAULTS)
    state = form.from_ordinary(t, np.linspace(0.2, 0.9, len(module.STATE)))

    def elementary(name: str) -> Callable[[Expression], Expression]:
        return lambda x: Expression(getattr(math, name)(x.value))

    functions = {name: staticmethod(elementary(name)) for name in ("sin", "cos", "sqrt")}
    values = dict(zip(form.state, state, strict=True))
    hy = type("Heyoka", (), {
        "expression": Expression,
        "time": Expression(t),
        "par": [*map(Expression, module.DEFAULTS)],
        "make_vars": staticmethod(lambda *names: [Expression(values[name]) for name in names]),
        **functions,
    })  # fmt: skip
    variables, rates = zip(*heyoka.generated(hy, module), strict=True)
    assert [x.value for x in variables] == state.tolist()
    expected = form.rhs(t, state)
    assert np.array([rate.value for rate in rates]) == pytest.approx(expected, rel=1e-14)


def test_heyoka_gets_the_derived_lagrangian_of_the_double_pendulum(double: Derivation) -> None:
    system = double.system
    variables = iter([system.q, system.qdot])
    hy = SimpleNamespace(
        make_vars=lambda *_: next(variables),
        par=[one.symbol for one in system.parameters],
        sin=sp.sin,
        cos=sp.cos,
        lagrangian=lambda function, *_: function,
    )
    for function in heyoka.double_pendulum(hy).values():
        assert is_small(function - double.lagrangian)


def test_a_program_that_fails_loses_no_other_curve(
    truth: Reference, monkeypatch: pytest.MonkeyPatch
) -> None:
    end = Form(dp, "rational", dp.DEFAULTS).from_ordinary(0.0, truth.end)

    def right(*_: object) -> Iterator[Method]:
        yield "right", lambda _: lambda: (end, None)

    def fails_at_once(*_: object) -> Iterator[Method]:
        raise AttributeError("no attribute 'STATE_RATIONAL'")
        yield

    def fails_later(*_: object) -> Iterator[Method]:
        def run(tolerance: float) -> Run:
            if tolerance < 1e-3:
                raise RuntimeError("out of memory")
            return lambda: (end, None)

        yield "first", run
        yield "second", lambda _: lambda: (end, None)

    programs = {"broken": fails_at_once, "partly": fails_later, "good": right}
    monkeypatch.setattr(other_programs, "PEERS", programs)
    (first, second, good), failures = other_curves(REPORT, truth, ModuleType)
    assert failures == {
        "broken": "AttributeError: no attribute 'STATE_RATIONAL'",
        "partly first": "RuntimeError: out of memory",
    }
    assert 1 <= len(first.points) < len(second.points) == len(good.points)


def test_summary_and_plot_compare_at_equal_errors() -> None:
    def curve(method: str, backend: str, factor: float) -> CostCurve:
        runs = ((factor * 2.0**k, 10.0**-k) for k in range(1, 5))
        points = [MeasuredRun({}, seconds, None, error, 0.0) for seconds, error in runs]
        return CostCurve("report", method, "rational", backend, points)

    ours = [curve("rk4", "compiled", 1e-6), curve("dp54", "compiled", 4e-6)]
    others = [curve("taylor", "heyoka", 3e-6)]
    costs = SceneCosts("report", "the scene, 5 s", ours, others, {"numba rk4": "no memory"})
    title, head, *rows, failure, _ = costs.summary()
    assert title == "the scene, 5 s: times relative to our cheapest method"
    assert head.split() == ["error", "time/µs", "cheapest", "heyoka", "taylor"]
    assert rows[0].split() == ["1e-01", "2.0", "rk4", "3"]
    assert failure == "numba rk4 failed: no memory"
    black, taylor = costs.plot().axes[0].lines
    assert black.get_label() == "holonomic"
    assert black.get_xdata() == pytest.approx([2e-6, 4e-6, 8e-6, 16e-6])
    assert (taylor.get_label(), len(taylor.get_xdata())) == ("heyoka taylor", 4)
