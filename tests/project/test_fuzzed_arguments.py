"""Random arguments are refused by name, or give finite numbers.

The ordinary tests run a sample; `make campaign` runs thousands of cases.
"""

import warnings
from collections.abc import Callable
from math import inf, nan
from typing import Any

import numpy as np
import pytest
from forked import forked
from fuzzing import SIZES, examine
from hypothesis import strategies as st

import generated.double_pendulum as dp
from solvers import Event, Status, ensemble, integrate, prepare

START = (1.0, 0.5, 0.0, 0.0)
STRANGE = st.sampled_from(
    [
        *(None, True, False, nan, inf, -inf, 0, -1, 1, 0.5, 1e308, 1e-320, 10**400, 1j, "1", b"1"),
        *((), [], {}, object(), print, "theta1", "rk4", "gauss3", "lagrangian", "rational", START),
        *(np.zeros(4), np.zeros((4, 2)), np.zeros((2, 4)), np.full(4, nan), np.array("a")),
        *([0, 1], (1, 0), (0, inf), (0, nan), (0, 0), [[0, 1], [1]], np.float32(1), np.bool_(True)),
        *(dp.DEFAULTS, {"m2": 0.0}, {"m2": nan}, {"m3": 1}, lambda t, y: nan),
        Event(dp, "theta1", 0.5),
    ]
)
COMMON = ("params", "method", "form", "rtol", "atol", "h", "max_steps", "compensated")
MOTION = (*COMMON, "t_span", "y0", "t_eval", "events", "backend")
ARGUMENTS = {
    integrate: (*MOTION, "energy"),
    ensemble: (*MOTION, "occurrences", "workers"),
    prepare: COMMON,
}
#: Errors that a call may raise.
REFUSALS = (ValueError, TypeError, LookupError, MemoryError, OSError, ArithmeticError)


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize("function", ARGUMENTS, ids=lambda function: function.__name__)
@SIZES
def test_arguments_in_python(function: Callable[..., Any], cases: int) -> None:
    motion = {"t_span": (0, 1), "y0": START}
    valid: dict[str, Any] = {"params": dp.DEFAULTS, "max_steps": 10**5}
    if function is integrate:
        valid |= motion
    elif function is ensemble:
        valid |= motion | {"y0": np.outer(START, [1, 0.5])}

    def check(changes: dict[str, Any]) -> None:
        def call() -> str | bool:
            warnings.simplefilter("ignore")
            try:
                result = function(dp, **(valid | changes))
                y = np.array(result(**motion) if function is prepare else result.y)
            except REFUSALS as error:
                return str(error)
            if function is ensemble:
                y = y[..., [status == Status.FINISHED for status in result.status]]
            elif function is integrate and result.status != Status.FINISHED:
                return True
            return bool(np.isfinite(y).all())

        ended = forked(call)
        named = (*changes, *dp.PARAMETERS, *dp.STATE)
        assert not ended.traceback, (changes, ended.traceback)
        is_named = isinstance(ended.value, str) and any(name in ended.value for name in named)
        assert ended.value is True or is_named, (changes, ended.value)

    names = st.sampled_from(ARGUMENTS[function])
    values = st.one_of(STRANGE, st.floats(), st.lists(st.floats(), min_size=2, max_size=4))
    examine(cases, st.dictionaries(names, values, min_size=1, max_size=2), check)
