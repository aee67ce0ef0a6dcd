"""The cheapest integration whose error is below an accuracy: doubles, longer numbers, series."""

from collections.abc import Callable

from solvers.integration.accuracy.checked_motion import Array, Motion
from solvers.integration.accuracy.checked_run import CheckedRun, checked_run
from solvers.integration.accuracy.integration_run import NotAccurateError
from solvers.integration.accuracy.longer_numbers import by_longer_numbers
from solvers.integration.accuracy.method_choice import SERIES, MethodChoice, usual_form
from solvers.integration.accuracy.taylor_motion import by_series
from solvers.integration.compiled.extended import PRECISIONS
from solvers.references.taylor import SeriesError


def sufficient_run(
    motion: Motion,
    choice: MethodChoice,
    accuracy: float,
    times: Array,
    report: Callable[[str], None] = lambda _: None,
    specialised: Motion | None = None,
) -> tuple[CheckedRun, dict[str, str]]:
    """The run, and the reason against each cheaper kind of numbers by its name.

    Longer numbers and series return the states at `times` only. Runs in doubles integrate
    `specialised`, the same motion with other code, if it is given. A method that is named is the
    only one. `report` receives the progress. `NotAccurateError` where nothing is sufficient,
    `TooLongError` above the limit of steps, `EndsEarlyError` where the motion cannot be continued.
    """
    report(f"full equations by {choice.method}")
    declined: dict[str, str] = {}
    try:
        return checked_run(specialised or motion, choice, accuracy, motion), declined
    except NotAccurateError as error:
        if choice.is_named:
            raise
        declined["double precision"] = str(error)
    if motion.inputs is not None:
        raise NotAccurateError(
            f"{declined['double precision']}; longer numbers have no inputs that vary: request "
            "less accuracy"
        )
    if longer := by_longer_numbers(motion, accuracy, times, declined, report):
        return longer, declined
    report("full equations by Taylor series")
    why = "the motion loses more digits than double precision has, and than compiled numbers have"
    choice = MethodChoice(SERIES, usual_form(motion.module, SERIES), why)
    try:
        return by_series(motion, choice, accuracy, times, report), declined
    except SeriesError as error:
        reasons = [declined[name] for name in ("double precision", *PRECISIONS) if name in declined]
        raise NotAccurateError(f"{'; '.join(reasons)}; by Taylor series {error}") from error
