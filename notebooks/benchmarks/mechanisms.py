"""Times of mechanisms here and in Exudyn, whose solvers are compiled, too."""

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from itertools import zip_longest
from typing import Any

from benchmarks import equal_error
from benchmarks.equal_error import OTHER, POWERS, Program
from benchmarks.mechanism_models import END, MECHANISMS, Mechanism
from solvers.equations.module import GeneratedModule

#: Largest errors of coordinates and velocities at the end, in rad and rad/s.
ERRORS = (1e-3, 1e-6, 1e-9)


def figures(modules: Mapping[str, GeneratedModule], package: Any) -> list[dict[str, Any]]:
    """For each mechanism, and each error that Exudyn reaches, the seconds of all programs."""
    results = []
    for name, module in modules.items():
        mechanism = MECHANISMS[name]
        runs = _programs(mechanism, module, package)
        curves = equal_error.measured(runs, mechanism.reference(module))
        results += [{"mechanism": name} | row for row in equal_error.rows(ERRORS, curves)]
    return results


def _programs(
    mechanism: Mechanism, module: GeneratedModule, package: Any
) -> Iterator[dict[str, Program]]:
    start, part = mechanism.whole_start(module).tolist(), partial(mechanism.part, module)
    for power, steps in zip_longest(POWERS, mechanism.steps):
        runs = equal_error.programs(module, start, END, 10.0**power, part)
        if steps:
            run = mechanism.exudyn(package, module, steps)
            runs[OTHER] = run, run
        yield runs


def summary(rows: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """A table of times and ratios."""
    yield f"Mechanisms, {END:g} s, and Exudyn at equal error of the state at the end:"
    yield from equal_error.table(rows, "mechanism", "Exudyn")
