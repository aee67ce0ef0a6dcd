"""Motions with constraints in numbers longer than doubles: their digits, and their residuals."""

import ctypes
from collections.abc import Callable

import numpy as np
import pytest
import sympy as sp
from constrained_systems import pinned, two_rods

import generated.double_pendulum as dp
from derive import Constraint, Coordinate, Parameter, PointMass, System
from holonomic import build
from solvers.equations.forms import Form, fastest_form
from solvers.equations.module import GeneratedModule, functions, part
from solvers.integration.compiled import compiler
from solvers.integration.compiled.double_double import DoubleDouble, in_calls
from solvers.integration.compiled.extended import PRECISIONS, _parts, integrate_extended
from solvers.integration.compiled.native import equations
from solvers.references.taylor import taylor

#: Tolerances, and the largest residual of constraints, in units of 1 m.
FINE = {"double-double": 1e-27, "long double": 1e-19, "quadruple": 1e-24}
ROUNDED = {"double-double": 1e-30, "long double": 1e-18, "quadruple": 1e-32}
#: Appended to the C program: the largest residual at the end of a motion.
RESIDUAL = """
double residual(const double (*state)[PARTS], const double *params, double rtol)
{{
    static Motion motion;
    const double changes[PARAMETERS + SIZE] = {{0}}, times[] = {{0, 1.5}};
    double rows[2][ORDINARY], largest = 0;
    extended_start(&motion, 0, 1.5, state, params, changes);
    extended_advance(&motion, times, 2, *rows, rtol, 1e-12, 0, 10000, 60);
    number y[ORDINARY], all[PARAMETERS + 1], values[{count}];
    for (int k = 0; k < ORDINARY; k++) {{
        y[k] = {of_state};
    }}
    for (int k = 0; k < PARAMETERS; k++) {{
        all[k] = {of_params};
    }}
    {constraints}
    for (int k = 0; k < {count}; k++) {{
        const double value = fabs((double)values[k]{high});
        largest = value <= largest ? largest : value;
    }}
    return motion.t == 1.5 ? largest : INFINITY;
}}
"""


def wire() -> System:
    """A bead on a wire, whose constraint no method of Gauss keeps by itself."""
    x, y, g = sp.symbols("x y g", real=True)
    m, k = sp.symbols("m k", positive=True)
    return System(
        "wire",
        "Bead on a wire",
        [Coordinate(x, "m", "to the right"), Coordinate(y, "m", "upwards")],
        [
            Parameter(m, "kg", 1.0, "mass"),
            Parameter(k, "1/m^3", 0.5, "wire"),
            Parameter(g, "m/s^2", 9.81, "gravity"),
        ],
        [PointMass(m, (x, y))],
        constraints=[Constraint(y - k * x**4 + k * y * x**3, "wire")],
    )


#: Starts are exact in doubles.
STARTS: list[tuple[Callable[[], System], tuple[float, ...], tuple[float, ...]]] = [
    (wire, (0.0, 0.0, 2.0, 0.0), (1.0, 0.5, 9.81)),
    (pinned, (0.0, -0.75, 0.0, 2.25, 0.0, 3.0), (1.5, 0.75, 9.81)),
]


#: Of the pendulum, whose coordinates x and y precede the angle.
ROD = """\
    values[0] = y[0]*y[0] + y[1]*y[1] - all[1]*all[1];
    values[1] = y[0]*y[3] + y[1]*y[4];"""
ROD_IN_PAIRS = """\
    values[0] = add(multiply(y[0], y[0]), multiply(y[1], y[1]));
    values[0] = subtract(values[0], multiply(all[1], all[1]));
    values[1] = add(multiply(y[0], y[3]), multiply(y[1], y[4]));"""


def in_numbers(module: GeneratedModule, name: str) -> str:
    """The C program of a precision with the function of residuals."""
    precision, form = PRECISIONS[name], Form(module, fastest_form(module), module.DEFAULTS)
    source, function = equations(module, form.name), f"{module.SYSTEM}_constraints"
    text = {"of_state": "motion.y[COLUMN[k]]", "of_params": "motion.params[k]", "of_time": "1.5"}
    more, high = "", ""
    if isinstance(precision, DoubleDouble):
        text["of_state"] = "constant(motion.y[COLUMN[k]], motion.y_low[COLUMN[k]])"
        text = {k: v if k == "of_state" else f"constant({v}, 0)" for k, v in text.items()}
        high = ".high[0]"
    constraints = f"{function}({text.pop('of_time')}, y, all, values);"
    if module.SYSTEM == "pinned":
        constraints = ROD_IN_PAIRS if high else ROD
    elif high:
        more = in_calls(source, "CONSTRAINTS", function)
        constraints = constraints.replace(function, "CONSTRAINTS")
    tail = RESIDUAL.format(constraints=constraints, count=2, high=high, **text)
    return precision.program(source, form) + more + tail


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize(("make", "start", "params"), STARTS)
def test_constraints_are_kept_to_rounding_at_any_tolerance(
    make: Callable[[], System], start: tuple, params: tuple, precision: str
) -> None:
    built = build(make())
    module = part(built, *functions(built))  # residuals are in no header of a loop
    form = Form(module, fastest_form(module), module.DEFAULTS)
    library = compiler.build(
        in_numbers(module, precision), reproducible=precision == "double-double"
    )
    residual = library.functions.residual
    residual.restype, residual.argtypes = ctypes.c_double, [ctypes.c_void_p] * 2 + [ctypes.c_double]
    state, values = _parts(form, start), np.array(params)
    for rtol in (1e-6, 1e-14):
        assert residual(state.ctypes.data, values.ctypes.data, rtol) < ROUNDED[precision]


def test_series_of_few_digits_keep_the_constraints() -> None:
    module, (_, start, params) = build(wire()), STARTS[0]
    states = taylor(module, params, start, np.linspace(0, 1.5, 4), 10)
    residuals = module.constraints_many(0.0, states.T, params)
    assert np.abs(residuals).max() < 4e-16 * (1 + np.abs(states).max())


#: Of the double pendulum, and the start; the Lyapunov time is about 1 s.
PARAMS, RATES = (1.0, 0.5, 1.0, 0.75, 9.81), (4.0, 5.0)
SPEEDS = RATES[0], RATES[0] + 0.75 * RATES[1]
TIMES = [0.0, 1.0, 6.0]


@pytest.fixture(scope="module")
def expected() -> np.ndarray:
    """Cartesian states, from angles by Taylor series."""
    q1, q2, w1, w2 = taylor(dp, PARAMS, (0.0, 0.0, *RATES), TIMES, 26).T
    c1, s1, c2, s2 = np.cos(q1), np.sin(q1), np.cos(q2), np.sin(q2)
    first, second = np.array([s1, -c1, c1 * w1, s1 * w1]), np.array([s2, -c2, c2 * w2, s2 * w2])
    second = first + 0.75 * second
    return np.vstack([first[:2], second[:2], first[2:], second[2:]]).T


@pytest.fixture(scope="module")
def rods() -> GeneratedModule:
    return build(two_rods())


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize("precision", [*PRECISIONS, "decimal"])
def test_digits_are_those_of_fewest_coordinates(
    precision: str, rods: GeneratedModule, expected: np.ndarray
) -> None:
    start = (0.0, -1.0, 0.0, -1.75, SPEEDS[0], 0.0, SPEEDS[1], 0.0)
    if precision == "decimal":
        found = taylor(rods, PARAMS, start, TIMES[:2], 20)
    else:
        found = integrate_extended(rods, PARAMS, start, TIMES, precision, FINE[precision])
    allowed = 1e-13 if precision == "long double" else 1e-14
    assert np.abs(found - expected[: len(found)]).max() < allowed
