"""README's snippets run, and its numbers are those of the code."""

import re
from pathlib import Path

import pytest

from derive import names
from derive.assignments import assignments
from derive.functions import contents

README = (Path(__file__).parent.parent / "README.md").read_text(encoding="utf-8")
SNIPPETS = re.findall(r"```python\n(.*?)```", README, re.DOTALL)


@pytest.mark.parametrize("snippet", SNIPPETS, ids=range(len(SNIPPETS)))
def test_snippets_run(snippet: str) -> None:
    exec(compile(snippet, "README.md", "exec"), {})


def test_the_table_of_operations_is_true(double) -> None:  # type: ignore[no-untyped-def]
    counted = {f.name: assignments(f.lowering, ()).operations for f in contents(double).functions}
    for row in re.findall(r"^\| (`.*?) \| (.*?) \|$", README, re.MULTILINE):
        called = re.findall(r"`(\w+)", row[0])
        stated = [int(number) for number in re.findall(r"\d+", row[1])]
        if "to" in row[1]:
            actual = [counted[name] for name in called]
            assert [min(actual), max(actual)] == stated
        else:
            assert [counted[name] for name in called] == stated


def test_every_command_that_is_shown_exists() -> None:
    from solvers.cli import COMMANDS

    assert set(re.findall(r"holonomic (\w+)", README)) <= {*COMMANDS}
    assert "double_pendulum" in names()
