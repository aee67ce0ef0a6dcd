"""Exports: functions and simulations in other languages, with equal bits."""

import re
import shutil
import subprocess
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from math import atan2, cos, pi, sin, ulp
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
import sympy as sp
from velocity_constraints import CASES, stated

import generated
import generated.double_pendulum as dp
from derive import (
    Coordinate,
    Derivation,
    Parameter,
    PointMass,
    Simulation,
    System,
    export,
    load,
    reduced,
)
from derive.codegen.export.exported_program import operations
from derive.codegen.export.exported_system import ExportedSystem
from derive.codegen.export.language_export import exported_text
from derive.codegen.export.target import find_targets
from derive.codegen.module_functions import Functions
from solvers import Event, Solution, build, consistent_start, integrate
from solvers.app.modules import load as load_module
from solvers.runge_kutta import method_catalogue
from solvers.runge_kutta.step_control import GROW, SAFETY, SHRINK, Controller

#: How each target's file is run, after it is compiled; {} is its name without ending.
COMMANDS = {
    "c99": ("cc -std=c99 -O1 -ffp-contract=off {0}.c -o {0}_c -lm", "./{0}_c"),
    "cpp": ("c++ -std=c++17 -O1 -ffp-contract=off {0}.cpp -o {0}_cpp", "./{0}_cpp"),
    "javascript": ("", "node {0}.mjs"),
    "rust": ("rustc {0}.rs -o {0}_rs", "./{0}_rs"),
    "java": ("", "java {0}.java"),
    "fortran": ("gfortran -O1 -ffp-contract=off {0}.f90 -o {0}_f", "./{0}_f"),
    "go": ("go build -o {0}_go {0}.go", "./{0}_go"),
    "matlab": ("", "octave --no-gui --eval {0}"),
    "julia": ("", "julia {0}.jl"),
}
START = (pi / 2, pi, 0.0, 0.0)
PARAMS = (1.0, 1.0, 2.0, 2.0, 9.81)
FIXED = Simulation(method_catalogue.load("rk4"), PARAMS, START, 5.0, samples=5, steps=100)
CONTROLLED = replace(FIXED, method=method_catalogue.load("verner853"), steps=0)
WITH_EVENT = replace(CONTROLLED, event=("theta2", 1.0), name="with_event")


#: Systems and simulations; the start of a closed loop is found when it is needed.
SIMULATIONS = {
    "fixed steps": ("double_pendulum", FIXED),
    "controlled steps": ("double_pendulum", CONTROLLED),
    "an event": ("double_pendulum", WITH_EVENT),
    "a closed loop": ("four_bar", replace(CONTROLLED, y0=(), duration=1.0)),
}


@cache
def case(name: str) -> tuple[System, Simulation]:
    """The system and the simulation of this name."""
    system, simulation = SIMULATIONS[name]
    if not simulation.y0:
        module = load_module(system)
        start = consistent_start(module, {"phi": 1.0, "phi_dot": 2.0}, module.DEFAULTS)
        simulation = replace(simulation, params=module.DEFAULTS, y0=tuple(start.y))
    return load(system), simulation


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return tmp_path


def rows(text: str) -> list[list[float]]:
    """The numbers of rows of output, after the heading."""
    lines = text[text.index("t [s]") :].splitlines()[1:]
    return [[float(number) for number in line.split(",")] for line in lines]


def program(system: System, simulation: Simulation | None, target: str = "python") -> ModuleType:
    """An exported Python program as a module."""
    _, text = exported_text(system, target, simulation)
    module = ModuleType("exported")
    exec(compile(text, "exported", "exec"), module.__dict__)
    return module


def run(module: ModuleType) -> tuple[bool, list[list[float]]]:
    """Whether a Python program completed its motion, and its rows."""
    result: list[list[float]] = []
    module.__dict__["print_row"] = lambda t, values: result.append([t, *values])
    return module.simulate(), result


@cache
def motion(name: str) -> list[list[float]]:
    """The rows of a simulation in Python."""
    is_complete, result = run(program(*case(name)))
    assert is_complete
    return result


@cache
def works(program: str) -> bool:
    """Whether a program is installed: that of rustup may have no compiler."""
    if shutil.which(program) is None:
        return False
    command = [program, "version" if program == "go" else "--version"]
    return subprocess.run(command, capture_output=True, check=False).returncode == 0


def output(target: str, system: System, simulation: Simulation, folder: Path) -> str:
    """What a program prints; the test is left out if the language is not installed."""
    path, printed = export(system, target, folder, simulation=simulation), ""
    for command in filter(None, COMMANDS[target]):
        words = command.format(path.stem).split()
        if not words[0].startswith("./") and not works(words[0]):
            pytest.skip(f"needs {words[0]}")
        done = subprocess.run(words, cwd=folder, capture_output=True, text=True, check=True)
        printed = done.stdout
    return printed


@pytest.mark.parametrize("name", SIMULATIONS)
@pytest.mark.long("each further language takes seconds", keep=6, daily=18)
@pytest.mark.parametrize("target", COMMANDS)
def test_simulations_have_equal_bits_in_every_language(
    target: str, name: str, folder: Path
) -> None:
    assert rows(output(target, *case(name), folder)) == motion(name)


def test_every_language_is_run_or_is_a_library() -> None:
    libraries = {name for name, one in find_targets().items() if not one.has_simulations}
    assert {*COMMANDS, "python", "embedded_c", "opencl", "fmu"} | libraries == {*find_targets()}


def exact(duration: float, y0: Sequence[float] = START, **options: Any) -> Solution:
    """The motion of the double pendulum by collocation, to twelve digits."""
    tolerances = {"method": "gauss8", "rtol": 1e-13, "atol": 1e-13}
    return integrate(dp, (0, duration), y0, PARAMS, **tolerances, **options)


def test_errors_of_controlled_steps_follow_the_tolerances() -> None:
    reference, errors = exact(5, t_eval=range(6)).y, []
    for tolerance in (1e-7, 1e-10):
        simulation = replace(CONTROLLED, rtol=tolerance, atol=tolerance)
        _, result = run(program(load("double_pendulum"), simulation))
        errors.append(abs(np.array(result)[:, 1:5].T - reference).max())
    assert 1e-9 < errors[0] < 1e-5
    assert errors[1] < 2e-9


def test_step_control_is_that_of_the_package_without_its_memory() -> None:
    method, module = CONTROLLED.method, program(load("double_pendulum"), CONTROLLED)
    controller = Controller(method.error_order, CONTROLLED.rtol, CONTROLLED.atol)
    random = np.random.default_rng(0)
    y, end = random.normal(size=(2, 6))
    weights = np.array(method.error_weights, dtype=float)
    for size in (1e-12, 1e-9, 1e-6):
        derivatives = size * random.normal(size=(method.stages, 6))
        norms = [module.error_norm(0.1, y, end, derivatives.ravel(), one) for one in weights]
        norm = module.combined(*norms)
        assert norm == pytest.approx(
            controller.norm(0.1 * weights @ derivatives, y, end), rel=1e-12
        )
        ideal = SAFETY * norm ** (-1 / (method.error_order + 1))
        assert module.step_factor(norm) == pytest.approx(min(max(ideal, SHRINK), GROW), rel=0.08)
    assert module.step_factor(float("nan")) == SHRINK
    assert module.combined(0.0, 0.0) == 0.0


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize(
    ("name", "values"), [("double_pendulum", {"l1": 0.7}), ("driven_pendulum", {"Omega": 3.0})]
)
def test_fixed_steps_between_samples_are_those_of_the_package(
    name: str, values: dict[str, float]
) -> None:
    module = load_module(name)
    start, params = [1.0, 0.5, 0.0, 0.3][: len(module.STATE)], tuple(module.params(**values))
    given = {"params": params, "y0": tuple(start), "duration": 2.0, "samples": 4, "steps": 25}
    _, result = run(program(load(name), replace(FIXED, **given)))
    t = np.linspace(0, 2, 5)
    same = integrate(module, (0, 2), start, params, method="rk4", h=0.02, t_eval=t)
    rows = np.array(result)[:, : 1 + len(start)]
    assert rows == pytest.approx(np.column_stack([t, same.y.T]), abs=1e-10)


def test_halved_steps_of_a_method_of_order_four_have_a_sixteenth_of_the_error() -> None:
    reference, errors = exact(1).y[:, -1], []
    for steps in (200, 400, 800):
        simulation = replace(FIXED, duration=1.0, samples=1, steps=steps)
        _, result = run(program(load("double_pendulum"), simulation))
        errors.append(abs(np.array(result[-1])[1:5] - reference).max())
    assert errors[0] / errors[1] == pytest.approx(16, rel=0.15)
    assert errors[1] / errors[2] == pytest.approx(16, rel=0.15)


def test_events_are_those_of_the_motion() -> None:
    times = [row[0] for row in motion("an event") if row[-1] == 1.0]
    reference = exact(5, events=[Event(dp, "theta2", 1.0)])
    assert times == pytest.approx(reference.t_events[0].tolist(), abs=1e-8)


def test_angles_count_whole_turns() -> None:
    start = (0.0, 0.0, 9.0, 0.0)
    simulation = replace(CONTROLLED, y0=start, duration=3.0)
    _, result = run(program(load("double_pendulum"), simulation))
    angles = exact(3, start).y[:2, -1]
    assert max(abs(angles)) > 2 * pi
    assert result[-1][1:3] == pytest.approx(angles.tolist(), abs=1e-5)


def test_constraints_and_energy_are_kept() -> None:
    final = motion("a closed loop")[-1]
    y, params = final[1:-1], case("a closed loop")[1].params
    four_bar = load_module("four_bar")
    assert max(map(abs, np.ravel(four_bar.constraints(1.0, y, params)))) < 1e-14
    assert final[-1] == pytest.approx(motion("a closed loop")[0][-1], rel=1e-9)
    assert final[-1] == pytest.approx(four_bar.energy(1.0, y, params), rel=1e-13)


def test_integrals_of_constraints_of_velocities_are_kept() -> None:
    integral, rate, given = CASES["yoke"]
    system = stated("yoke", integral, rate)
    module = build(system)
    start = consistent_start(module, given, {}).y
    simulation = replace(CONTROLLED, params=module.DEFAULTS, y0=tuple(start), duration=1.0)
    _, result = run(program(system, simulation))
    before = module.integrals(0.0, start, module.DEFAULTS)
    after = module.integrals(1.0, result[-1][1:-1], module.DEFAULTS)
    assert len(before) == 1
    assert after == pytest.approx(before, abs=1e-14)
    lost = replace(simulation, rtol=1e-4, atol=1e-4)
    assert run(program(system, lost))[1][-1][1:3] != result[-1][1:3]


def test_the_arctangent_and_the_nearest_angle_are_accurate() -> None:
    module = program(load("double_pendulum"), CONTROLLED)
    for x in [0.0, 1.0, 0.4375, 0.6875, 5e-324, *np.random.default_rng(0).uniform(0, 1, 2000)]:
        assert abs(module.arctangent(x) - np.arctan(x)) <= 1.5 * ulp(np.arctan(x))
    for x in np.random.default_rng(1).uniform(-20, 20, 2000):
        assert module.angle(sin(x), cos(x), x + 3.0) == pytest.approx(x, abs=1e-14)
        assert module.angle(sin(x), cos(x), 0.0) == pytest.approx(atan2(sin(x), cos(x)), abs=1e-15)


def test_a_motion_that_breaks_has_no_further_rows() -> None:
    x, m = sp.Symbol("x", real=True), sp.Symbol("m", positive=True)
    falling = System(
        name="falling",
        title="Mass that is attracted by the cube of its distance",
        coordinates=[Coordinate(x, "m", "distance")],
        parameters=[Parameter(m, "kg", 1.0, "mass")],
        masses=[PointMass(m, (x, 0))],
        potential=-m / x**2,
    )
    simulation = replace(CONTROLLED, params=(1.0,), y0=(1.0, -1.0), duration=10.0)
    is_complete, result = run(program(falling, simulation))
    assert not is_complete
    assert [row[0] for row in result] == [0.0]


@pytest.mark.long("more cases of the same kind", keep=8)
@pytest.mark.parametrize("name", generated.__all__)
def test_libraries_of_python_have_the_values_of_generated_modules(name: str) -> None:
    library, own = program(load(name), None), load_module(name)
    functions, random = Functions(Derivation(reduced(load(name)))), np.random.default_rng(len(name))
    names = [one for one in functions.usual if one in own.OPERATIONS and hasattr(library, one)]
    assert {"rhs", "energy", "positions"} <= {*names}
    for function in functions.part(names).functions:
        sizes = {key: len(names) for key, names in function.arguments("y").items()}
        values = {key: random.uniform(0.1, 0.2, size).tolist() for key, size in sizes.items()}
        values["params"][: len(own.DEFAULTS)] = own.DEFAULTS
        arguments = [0.3, *values.values()] if function.state else [values["params"]]
        expected = np.ravel(getattr(own, function.name)(*arguments)).tolist()
        result = [0.0] * len(expected)
        value = getattr(library, function.name)(*arguments, *([result] if function.shape else []))
        assert (result if function.shape else [value]) == expected, function.name


@pytest.mark.parametrize("target", ["jax", "casadi", "numba", "heyoka"])
def test_libraries_have_the_values_of_generated_modules(target: str) -> None:
    pytest.importorskip(target)
    library = program(load("double_pendulum"), None, target)
    y, params = np.array([1.0, 2.0, 0.5, -0.3]), np.array(PARAMS)
    if target == "heyoka":
        import heyoka as hy

        variables = hy.make_vars("a", "b", "c", "d")
        value = hy.cfunc(library.rhs(0.0, variables, PARAMS), variables)(y)
    else:
        value = np.ravel(np.array(library.rhs(0.0, y, params)))
    assert value == pytest.approx(np.array(dp.rhs(0.0, y, PARAMS)), rel=1e-14)


@pytest.mark.parametrize("target", ["c99", "cpp", "rust", "java", "fortran", "go"])
def test_names_that_languages_reserve_are_changed(target: str, folder: Path) -> None:
    names = "x y m M end function range chan fn let mut impl E"
    symbols = {name: sp.Symbol(name, positive=True) for name in names.split()}
    x, y, m, *others = symbols.values()
    strange = System(
        name="strange",
        title="Mass with springs of strange names",
        coordinates=[Coordinate(x, "m", "position"), Coordinate(y, "m", "position")],
        parameters=[Parameter(one, "kg", 1.0, "a parameter") for one in (m, *others)],
        masses=[PointMass(m, (x, y))],
        potential=sum(other * x ** (k + 2) for k, other in enumerate(others)) + m * y**2,
    )
    simulation = replace(FIXED, params=(1.0,) * 11, y0=(0.1, 0.2, 0, 0), duration=0.1, steps=3)
    _, expected = run(program(strange, simulation))
    assert rows(output(target, strange, simulation, folder)) == expected


def test_a_file_has_no_name_of_a_function_in_it(folder: Path) -> None:
    simulation = replace(FIXED, name="step")
    path = export(load("double_pendulum"), "matlab", folder, simulation=simulation)
    assert path.name == "step_motion.m"
    assert rows(output("matlab", load("double_pendulum"), simulation, folder)) == motion(
        "fixed steps"
    )


def test_a_library_for_microcontrollers_needs_nothing_and_rounds_like_single_precision(
    folder: Path,
) -> None:
    if shutil.which("cc") is None:
        pytest.skip("needs a C compiler")
    path = export(load("double_pendulum"), "embedded_c", folder, simulation=FIXED)
    text = path.read_text()
    assert not re.search(r"#include|malloc|double ", re.sub(r"/\*.*?\*/", "", text, flags=re.S))
    main = """
        #include <stdio.h>
        #include "double_pendulum.h"
        int main(void) {
            float y[6] = {1.0f, 6.123233995736766e-17f, 1.2246467991473532e-16f, -1.0f, 0.0f, 0.0f};
            const float params[5] = {1.0f, 1.0f, 2.0f, 2.0f, 9.81f};
            float k[24], result[6];
            for (int n = 0; n < 100; n++) {
                step(0.0f, 0.01f, y, params, k, result);
                for (int i = 0; i < 6; i++) y[i] = result[i];
            }
            for (int i = 0; i < 6; i++) printf("%a ", (double)y[i]);
            return energy(0.0f, y, params) < 0.0f;
        }"""
    (folder / "main.c").write_text(main)
    flags = "-std=c99 -Wall -Wextra -Wconversion -pedantic -Werror -ffp-contract=off"
    subprocess.run(["cc", *flags.split(), "main.c"], cwd=folder, check=True)
    result = subprocess.run("./a.out", cwd=folder, capture_output=True, text=True, check=True)
    module = program(load("double_pendulum"), FIXED)
    y, params = ([*map(np.float32, one)] for one in (module.START_STATE, module.DEFAULTS))
    for _ in range(100):
        end = [np.float32(0.0)] * 6
        module.step(0.0, 0.01, y, params, [np.float32(0.0)] * 24, end)
        y = end
    assert [float.fromhex(x) for x in result.stdout.split()] == [*map(float, y)]


def test_a_kernel_of_opencl_has_the_bits_of_other_programs() -> None:
    cl = pytest.importorskip("pyopencl")
    _, text = exported_text(load("double_pendulum"), "opencl", FIXED)
    context = cl.create_some_context(interactive=False)
    queue, kernel = cl.CommandQueue(context), cl.Program(context, text).build().integrate
    module, flags = program(load("double_pendulum"), FIXED), cl.mem_flags
    starts = np.array([module.START_STATE] * 3)
    starts[1, 4:], starts[2, 4:] = 1.0, -2.0
    ends = np.empty_like(starts)
    params = np.array([module.DEFAULTS] * 3)
    read = flags.READ_ONLY | flags.COPY_HOST_PTR
    arrays = [cl.Buffer(context, read, hostbuf=one) for one in (starts, params)]
    result = cl.Buffer(context, flags.WRITE_ONLY, ends.nbytes)
    kernel(queue, (3,), None, *arrays, result, np.int32(100), np.float64(0.01))
    cl.enqueue_copy(queue, ends, result)
    for start, end in zip(starts.tolist(), ends.tolist(), strict=True):
        y, following = start, [0.0] * 6
        for k in range(100):
            module.step(0.01 * k, 0.01, y, module.DEFAULTS, [0.0] * 24, following)
            y = [*following]
        assert y == end


@pytest.mark.parametrize("simulation", [None, FIXED])
def test_opencl_has_a_kernel_if_there_are_steps(simulation: Simulation | None) -> None:
    _, text = exported_text(load("double_pendulum"), "opencl", simulation)
    assert text.count("__kernel void integrate(") == (simulation is not None)


@pytest.mark.long("other tests reach its code")
def test_headers_are_code_for_a_gpu(folder: Path) -> None:
    if shutil.which("nvcc") is None:
        pytest.skip("needs nvcc")
    export(load("double_pendulum"), "c99", folder)
    kernel = """
        #define HOLONOMIC_FUNCTION __device__ static inline
        #include "double_pendulum.h"
        __global__ void evaluate(const double *y, const double *params, double *result) {
            rhs(0.0, y, params, result);
        }"""
    (folder / "kernel.cu").write_text(kernel)
    done = subprocess.run(["nvcc", "-c", "kernel.cu"], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_stated_operations_are_those_that_a_step_executes() -> None:
    count = [0]

    class Counted(float):
        """A number that counts the operations on it."""

    def counting(name: str) -> Any:
        def operation(*values: Any) -> Counted:
            count[0] += 1
            return Counted(getattr(float, name)(*map(float, values)))

        return operation

    for name in "add radd sub rsub mul rmul truediv rtruediv".split():
        setattr(Counted, f"__{name}__", counting(f"__{name}__"))
    module = program(load("double_pendulum"), FIXED)
    y, params = [Counted(x) for x in module.START_STATE], [Counted(x) for x in module.DEFAULTS]
    derivatives, end = [Counted(0)] * 24, [Counted(0)] * 6
    module.rhs(0.0, y, params, end)
    of = ExportedSystem(Derivation(load("double_pendulum"))).simulation(FIXED)
    assert operations(of, "rhs") == count[0]
    count[0] = 0
    module.step(Counted(0), Counted(0.01), y, params, derivatives, end)
    assert operations(of, "step") == count[0]


@pytest.mark.parametrize(
    ("target", "changes", "message"),
    [
        ("rustt", {}, "did you mean 'rust'"),
        ("jax", {}, "jax is a library of functions and has no simulations"),
        ("c99", {"method": method_catalogue.load("gauss4")}, "is implicit"),
        ("c99", {"method": method_catalogue.load("leapfrog")}, "is a splitting"),
        ("c99", {"duration": -1.0}, "duration is -1.0, but must be finite and above 0"),
        ("c99", {"samples": 0}, "samples is 0"),
        ("c99", {"steps": -3}, "steps is -3, but must be 0 or more"),
        ("c99", {"method": CONTROLLED.method, "steps": 0, "rtol": 0.0}, "rtol is 0.0"),
        ("embedded_c", {"event": ("theta1", 0.0)}, "has no rows of output for an event"),
        ("opencl", {"method": CONTROLLED.method, "steps": 0}, "opencl has equal steps"),
        ("fmu", {}, "fmu has controlled steps"),
        ("c99", {"steps": 0}, "estimates no error, which step control needs"),
        ("c99", {"y0": (0.0, 0.0)}, "y0 is .* not finite numbers for theta1, theta2"),
        ("c99", {"params": (1, 1, 2, np.nan, 9.81)}, "params is"),
        ("c99", {"event": ("theta3", 0.0)}, "'theta3' .did you mean"),
    ],
)
def test_impossible_exports_are_refused(
    target: str, changes: dict[str, Any], message: str, folder: Path
) -> None:
    with pytest.raises(ValueError, match=message):
        export(load("double_pendulum"), target, folder, simulation=replace(FIXED, **changes))
    assert not [*folder.iterdir()]
