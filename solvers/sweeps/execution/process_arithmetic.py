"""The arithmetic of a process, on which the last bits of its results depend.

A compiler may fuse products with sums, a loop in Python sums in another order, and mathematical
libraries round differently. A process that computes chunks first integrates a sample of the motions
over a few steps; the digest of its results must be that of the process that began the sweep.
"""

import hashlib
import os
import platform
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from solvers.integration.loops import compiled_loop
from solvers.integration.problem import validation
from solvers.integration.problem.problem import Options
from solvers.integration.problem.status import StopFlag
from solvers.sweeps.definition.axes import Array
from solvers.sweeps.definition.sweep import Sweep
from solvers.sweeps.execution.worker import computed, mean_evaluations, run_chunk

#: Number of steps that are compared.
STEPS = 50
#: Arguments of the elementary functions that are compared. Libraries for processors with and
#: without fused products differ in one result of 2000.
ARGUMENTS = np.linspace(-3.2, 3.2, 2**15 + 1)
DIGEST = "digest"

#: Digests of samples that this process has reproduced.
_reproduced: set[str] = set()


class OtherArithmeticError(ValueError):
    """The results of this process would differ in their last bits from those of a sweep."""


def first_motions(sweep: Sweep, sample: Mapping[str, Array]) -> tuple[float, dict[str, str]]:
    """Mean number of evaluations of a sample of motions, and the arithmetic of this process."""
    return mean_evaluations(sweep, sample), arithmetic(sweep, sample)


def run_equal_chunk(
    sweep: Sweep,
    columns: Mapping[str, Array],
    sample: Mapping[str, Array],
    expected: Mapping[str, str],
    stop: StopFlag | None = None,
) -> NDArray[np.void]:
    """Compute a chunk as `run_chunk`; `OtherArithmeticError` if its last bits would differ."""
    if expected[DIGEST] not in _reproduced:
        own = arithmetic(sweep, sample)
        if own[DIGEST] != expected[DIGEST]:
            raise OtherArithmeticError(
                f"the sweep was begun with other arithmetic than that of {platform.node()} "
                f"({_difference(expected, own)}), and results would differ in their last digits: "
                "resume it with the former, or give another --output"
            )
        _reproduced.add(expected[DIGEST])
    return run_chunk(sweep, columns, stop)


def arithmetic(sweep: Sweep, sample: Mapping[str, Array]) -> dict[str, str]:
    """The digest of the results of a sample of motions, and causes of differences, for messages."""
    short = sweep.unchecked(max_steps=min(sweep.max_steps, STEPS))
    chunk, ensembles = computed(short, sample)
    results = [chunk, *_elementary(sweep)]
    for motions in ensembles:
        results += [motions.y, motions.t, motions.t_events]
    digest = hashlib.sha256(b"".join(np.ascontiguousarray(one).tobytes() for one in results))
    library = os.confstr("CS_GNU_LIBC_VERSION") if "CS_GNU_LIBC_VERSION" in os.confstr_names else ""
    return {
        "loop": _loop(sweep),
        "processor": platform.machine(),
        "C library": library or platform.system(),
        "NumPy": np.__version__,
        DIGEST: digest.hexdigest(),
    }


def _loop(sweep: Sweep) -> str:
    """The kind of loop that integrates the motions."""
    problem = validation.problem_at_rest(sweep.module, (0.0, 1.0), Options(**sweep.options))
    _, program = compiled_loop.select(problem, lanes=True)
    if program is None:
        return "Python"
    return f"compiled {'with' if program.fuses_products else 'without'} fused products"


def _elementary(sweep: Sweep) -> list[Array]:
    """Values of the functions that the maps take of states."""
    x = ARGUMENTS
    values = [np.sin(x), np.cos(x), np.arctan2(x, x[::-1])]
    return [*values, np.log(np.abs(x) + 1e-9)] if sweep.form == "variational" else values


def _difference(expected: Mapping[str, str], own: Mapping[str, str]) -> str:
    differences = [
        f"{key}: {str(expected.get(key, 'unknown'))[:50]}, here {value}"
        for key, value in own.items()
        if key != DIGEST and expected.get(key) != value
    ]
    return "; ".join(differences) or "the same programs give other bits"
