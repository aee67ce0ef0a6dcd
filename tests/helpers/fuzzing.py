"""Random cases, each in a child process with limits; the same ones in every run."""

from collections.abc import Callable
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest
from forked import Ended, forked
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from solvers.app.cli import main

#: Names of the two sizes, and cases of each test.
SIZES = pytest.mark.parametrize(
    "cases", [6, pytest.param(340, marks=[pytest.mark.campaign, pytest.mark.timeout(3600)])]
)


def examine(cases: int, strategy: st.SearchStrategy[Any], check: Callable[[Any], None]) -> None:
    """Check random cases, the same ones in every run."""
    given(strategy)(
        settings(
            max_examples=cases,
            derandomize=True,
            database=None,
            deadline=None,
            phases=(Phase.generate,),  # a case that hangs is expensive to shrink
            suppress_health_check=[*HealthCheck],
        )(check)
    )()


def command(*arguments: str | Path) -> Ended:
    """Run a command in a child process; it ends by itself, with one of the exit codes."""
    ended = forked(partial(main, [str(argument) for argument in arguments]))
    assert not ended.traceback, ended.traceback
    assert "Traceback" not in ended.err, ended.err
    assert ended.value in (0, 1, 2, 3, 4), ended
    assert ended.value in (0, 1) or ended.err.strip() or ended.out.strip(), "no message"
    return ended


def in_folder(check: Callable[[Any, Path], None]) -> Callable[[Any], None]:
    """The check with a new folder for each case, in which nothing temporary stays."""

    def checked(case: Any) -> None:
        with TemporaryDirectory() as folder:
            check(case, Path(folder))
            assert not [path for path in Path(folder).rglob("*") if path.suffix == ".tmp"]

    return checked
