"""Execution of a README's snippets, with comments after ``print`` as the expected output."""

import ast
import re
from contextlib import redirect_stdout
from io import StringIO
from typing import Any


def run_snippet(snippet: str, name: str, namespace: dict[str, Any]) -> None:
    """Execute a snippet; a comment on the line of a ``print`` must be what it prints.

    Numbers agree to the digits of the comment; spaces, commas and brackets do not count.
    """
    lines = snippet.splitlines()
    for statement in ast.parse(snippet).body:
        printed = StringIO()
        with redirect_stdout(printed):
            exec(compile(ast.Module([statement], []), name, "exec"), namespace)
        last = lines[(statement.end_lineno or 0) - 1]
        if ast.unparse(statement).startswith("print(") and "  # " in last:
            assert_is_printed(last.rpartition("  # ")[2], printed.getvalue())


def assert_is_printed(expected: str, printed: str) -> None:
    """Fail unless the words are equal and the numbers agree to the expected digits."""
    found, wanted = words(printed), words(expected)
    assert len(found) == len(wanted), f"{printed!r} instead of {expected!r}"
    for one, other in zip(found, wanted, strict=True):
        assert one == other or rounded(one, other) == other, f"{printed!r} instead of {expected!r}"


def words(text: str) -> list[str]:
    return re.sub(r"[\[\](),]", " ", text).split()


def rounded(number: str, like: str) -> str:
    """A number with as many decimals as another one."""
    decimals = len(like.partition(".")[2])
    return f"{float(number):.{decimals}f}" if is_number(number) and is_number(like) else number


def is_number(text: str) -> bool:
    return re.fullmatch(r"-?\d+\.\d*", text) is not None
