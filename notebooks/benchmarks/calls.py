"""Calls of compiled right-hand sides of chains of pendulums, for timing."""

import ctypes
from collections.abc import Sequence
from importlib.resources import files
from typing import Any

import numpy as np

from benchmarks import heyoka
from solvers.integration.compiled.compiler import build

#: Number of doubles in a vector.
LANES = 8

CALLS = """
{program}
void calls(double *y, double *dy, const double *params, long count);
void calls(double *y, double *dy, const double *params, long count)
{{
    for (long i = 0; i < count; i++) {{
        {call};
        for (int k = 0; k < {state}; k++) {{
            y[k] += 1e-12*dy[k];
        }}
    }}
}}
"""

IN_LANES = """
typedef double lanes __attribute__((vector_size(64)));
#define HOLONOMIC_REAL lanes
#define HOLONOMIC_VECTOR
{header}
void calls(double *y, double *dy, const double *params, long count);
void calls(double *y, double *dy, const double *params, long count)
{{
    lanes state[{state}], rates[{state}], constants[{parameters}];
    for (int k = 0; k < {state}; k++) {{
        state[k] = y[k] - (lanes){{0}};
    }}
    for (int k = 0; k < {parameters}; k++) {{
        constants[k] = params[k] - (lanes){{0}};
    }}
    for (long i = 0; i < count; i++) {{
        {name}_rhs_rational(state[0], state, constants, rates);
        for (int k = 0; k < {state}; k++) {{
            state[k] += 1e-12*rates[k];
        }}
    }}
    for (int k = 0; k < {state}; k++) {{
        dy[k] = rates[k][0];
    }}
}}
"""


class Calls:
    """Repeated calls of a compiled right-hand side; `rates` has the result of the last one."""

    def __init__(self, text: str, state: int, params: Sequence[float], each: int) -> None:
        self._library = build(text).functions
        self._library.calls.restype = None
        self._y, self.rates = np.linspace(0.3, 0.9, state), np.zeros(state)
        self._params, self._each, self.repetitions = np.array(params), each, 2000

    @property
    def count(self) -> int:
        """Number of evaluated states."""
        return self.repetitions * self._each

    def __call__(self) -> None:
        """Make the calls."""
        arrays = self._y, self.rates, self._params
        pointers = [ctypes.c_void_p(array.ctypes.data) for array in arrays]
        self._library.calls(*pointers, ctypes.c_long(self.repetitions))


def parameters(n: int) -> list[float]:
    """Masses and lengths from 1 to 2, and g."""
    return [*np.linspace(1, 2, 2 * n).tolist(), 9.81]


def single(header: str, n: int) -> Calls:
    """Calls of the generated Lagrangian form with one state."""
    text = CALLS.format(program=header, call=f"chain_{n}_rhs(0.0, y, params, dy)", state=2 * n)
    return Calls(text, 2 * n, parameters(n), 1)


def textbook(n: int) -> Calls:
    """Calls of a textbook's equations, written by hand."""
    source = (files("benchmarks") / "textbook.c").read_text(encoding="utf-8")
    program = f"enum {{ N = {n} }};\n{source}"
    text = CALLS.format(program=program, call="textbook(y, dy, params)", state=2 * n)
    return Calls(text, 2 * n, parameters(n), 1)


def lanes(header: str, n: int) -> Calls:
    """Calls of the generated rational form with `LANES` states at once."""
    text = IN_LANES.format(header=header, name=f"chain_{n}", state=3 * n, parameters=2 * n + 1)
    return Calls(text, 3 * n, parameters(n), LANES)


class Evaluations:
    """heyoka's compiled function of many states."""

    count = 4096

    def __init__(self, hy: Any, n: int) -> None:
        q, rates, equations = heyoka.chain(hy, n)
        self._function = hy.cfunc([e for _, e in equations], [*q, *rates])
        self._inputs = np.tile(np.linspace(0.3, 0.9, 2 * n)[:, None], self.count)
        self._params = np.tile(np.array(parameters(n))[:, None], self.count)
        self._outputs = np.empty_like(self._inputs)

    def __call__(self) -> None:
        """Evaluate all states."""
        self._function(self._inputs, pars=self._params, outputs=self._outputs)
