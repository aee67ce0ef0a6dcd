"""Motions of an ensemble may have their own ends and sample times, and skip occurrences."""

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

import generated.double_pendulum as dp
import generated.single_pendulum as sp
from solvers import Event, Extremum, ensemble, integrate

N = 11
Y0 = {"theta": np.linspace(0.2, 2.5, N)}
ENDS = np.linspace(3.0, 8.0, N)
TIMES = ENDS[:, np.newaxis] * np.linspace(0.0, 1.0, 7)


@pytest.mark.parametrize("backend", ["compiled", "python"])
def test_each_motion_has_its_own_end_and_times(backend: str) -> None:
    motions = ensemble(sp, (0, ENDS), Y0, sp.DEFAULTS, t_eval=TIMES, backend=backend)
    assert motions.success.all()
    assert motions.t.tolist() == ENDS.tolist()
    assert motions.t_eval.shape == (N, 7)
    for k in range(N):
        start = (Y0["theta"][k], 0.0)
        one = integrate(sp, (0, ENDS[k]), start, sp.DEFAULTS, t_eval=TIMES[k], rtol=1e-12)
        assert_allclose(motions.samples[:, k], one.y, atol=1e-6)
        assert_allclose(motions.y[:, k], one.y[:, -1], atol=1e-6)
    assert motions.samples[0, :, 0].tolist() == Y0["theta"].tolist()


def test_own_times_equal_to_common_ones_give_the_same_bits() -> None:
    times = np.linspace(0.5, 6.0, 9)
    own = (0, np.full(N, 6.0)), np.tile(times, (N, 1))
    for backend in ("compiled", "python"):
        one, other = (
            ensemble(sp, span, Y0, sp.DEFAULTS, t_eval=t_eval, backend=backend)
            for span, t_eval in (((0, 6.0), times), own)
        )
        assert one.samples.tobytes() == other.samples.tobytes()
        assert one.y.tobytes() == other.y.tobytes()


def test_results_with_own_times_do_not_depend_on_other_motions() -> None:
    some, ends = slice(3, 8), ENDS.copy()
    ends[-1] = 300.0  # events are located to a resolution that depends on the end
    options: dict[str, Any] = {"events": Event(sp, "theta", 0.1), "occurrences": 3}
    all_of_them = ensemble(sp, (0, ends), Y0, sp.DEFAULTS, t_eval=TIMES, **options)
    fewer = ensemble(sp, (0, ENDS[some]), {"theta": Y0["theta"][some]}, sp.DEFAULTS,
                     t_eval=TIMES[some], workers=1, **options)  # fmt: skip
    assert all_of_them.samples[:, some].tobytes() == fewer.samples.tobytes()
    assert all_of_them.t_events[some].tobytes() == fewer.t_events.tobytes()


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize("backend", ["compiled", "python"])
def test_skipped_occurrences_are_not_stored(backend: str) -> None:
    y0 = {"theta1": [0.5, 1.0, 1.5], "theta2": 0.2}
    events = [Event(dp, "theta1", 0.0), Event(dp, "theta2", 0.0, 1)]
    options: dict[str, Any] = {"events": events, "backend": backend}
    whole = ensemble(dp, (0, 20), y0, dp.DEFAULTS, occurrences=12, **options)
    part = ensemble(dp, (0, 20), y0, dp.DEFAULTS, occurrences=4, skip=[2, 3], **options)
    assert (part.occurred == whole.occurred).all()
    assert part.occurred.min() > 4
    for k, skip in enumerate((2, 3)):
        assert_allclose(part.t_events[:, k], whole.t_events[:, k, skip : skip + 4], rtol=0)
        assert_allclose(part.y_events[:, :, k], whole.y_events[:, :, k, skip : skip + 4], rtol=0)


@pytest.mark.parametrize("backend", ["compiled", "python"])
def test_extremes_are_those_of_the_occurrences_that_are_not_skipped(backend: str) -> None:
    # motion of the second rod: not every extreme is as large as the first
    y0 = {"theta1": [0.5, 1.0], "theta2": 0.9}
    event = Extremum(dp, "theta2_dot")
    one = ensemble(dp, (0, 10), y0, dp.DEFAULTS, events=event, occurrences=2, skip=3,
                   backend=backend)  # fmt: skip
    for k in range(2):
        start = [y0["theta1"][k], 0.9, 0.0, 0.0]  # type: ignore[index]
        every = integrate(dp, (0, 10), start, dp.DEFAULTS, events=event).y_events[0][3:, 1]
        assert_allclose(one.y_events[1, k, 0], [every.min(), every.max()], atol=1e-7)


@pytest.mark.parametrize("backend", ["compiled", "python"])
def test_extremes_of_an_angle_count_whole_turns(backend: str) -> None:
    start, event = [2.5, -3.0, 0.0, 0.0], Extremum(dp, "theta2_dot")
    y0 = np.array(start)[:, np.newaxis]
    one = ensemble(dp, (0, 4), y0, dp.DEFAULTS, events=event, occurrences=2, backend=backend)
    every = integrate(dp, (0, 4), start, dp.DEFAULTS, events=event).y_events[0][:, 1]
    assert every.max() - every.min() > 2 * np.pi
    assert_allclose(one.y_events[1, 0, 0], [every.min(), every.max()], atol=1e-6)


@pytest.mark.parametrize(("options", "words"), [
    ({"t_span": (0, ENDS[:5])}, r"t_span\[1\] has 5 rows, but y0 has 11 motions"),
    ({"t_span": (0, ENDS), "t_eval": TIMES[:4]}, "t_eval has 4 rows, but y0 has 11"),
    ({"t_span": (0, ENDS), "t_eval": [4.0]}, r"t_eval has 4.0, outside of t_span = \(0.0, 3.0\)"),
    ({"t_span": (0, ENDS), "t_eval": TIMES[:, ::-1]}, "ordered from the start"),
    ({"t_span": (5, ENDS)}, "ends before and after its start"),
    ({"t_span": (0, ENDS * np.nan)}, r"t_span\[1\]\[0\] = nan must be a finite"),
    ({"t_eval": np.zeros((1, 1, 1))}, r"t_eval has shape \(1, 1, 1\)"),
    ({"skip": [1, 2]}, "skip has 2 numbers for 1 events"),
    ({"skip": -1}, "skip = -1 must be from 0"),
    ({"skip": 1, "events": Event(sp, "theta", 0.0, terminal=True)}, "the event is terminal"),
])  # fmt: skip
def test_invalid_times_and_numbers_are_refused(options: dict[str, Any], words: str) -> None:
    valid = {"t_span": (0, 5), "events": Event(sp, "theta", 0.0)}
    with pytest.raises(ValueError, match=words):
        ensemble(sp, y0=Y0, params=sp.DEFAULTS, **(valid | options))
