"""Times of Andrews' squeezer here, and by SciPy's Radau with a textbook's equations in Python."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from scipy.integrate import solve_ivp

from benchmarks import equal_error
from benchmarks.equal_error import OTHER, POWERS, Program
from benchmarks.motions import Array
from benchmarks.textbook_squeezer import textbook
from solvers.equations.module import GeneratedModule
from solvers.references.taylor import taylor

#: Published angles in rad at the start, where the mechanism is at rest, and the duration in s.
START, END = (
    (
        *(-0.06171389001427650, 0.0, 0.4552798191630704, 0.2226683901658859, 0.4873649795438426),
        *(-0.2226683901658859, 1.230547444549821, *[0.0] * 7),
    ),
    0.03,
)
#: Largest errors of the angles at the end, in rad.
ERRORS = (1e-4, 1e-6, 1e-8)
#: The power of ten of the tightest tolerance of Radau, with which a run takes seconds.
FINEST_OF_RADAU = -9


def figures(module: GeneratedModule) -> list[dict[str, Any]]:
    """For each error the seconds of our programs and of SciPy's Radau."""
    exact = taylor(module, module.DEFAULTS, START, [0.0, END], 20)[-1]
    curves = equal_error.measured(_programs(module), _angles(exact))
    return [{"program": "Radau"} | row for row in equal_error.rows(ERRORS, curves)]


def _programs(module: GeneratedModule) -> Iterator[dict[str, Program]]:
    for power in POWERS:
        runs = equal_error.programs(module, START, END, 10.0**power, _angles)
        if power >= FINEST_OF_RADAU:
            runs[OTHER] = radau(10.0**power)
        yield runs


def radau(tol: float) -> Program:
    """SciPy's method with the textbook's equations."""
    options: dict[str, Any] = {"method": "Radau", "rtol": tol, "atol": tol, "t_eval": [END]}

    def run() -> Array:
        return _angles(solve_ivp(textbook, (0.0, END), START, **options).y[:, -1])

    return run, run


def _angles(state: Array) -> Array:
    return state[:7]


def summary(rows: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """A table of times and ratios."""
    yield "Andrews' squeezer, 0.03 s, and SciPy's Radau with a textbook's equations in Python:"
    yield from equal_error.table(rows, "program", "Radau")
