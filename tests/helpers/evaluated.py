"""Values and messages of lines of Python, as text."""

import re
import warnings
from collections.abc import Mapping
from typing import Any

NUMBER = re.compile(r"-?\d+\.\d*(?:e[+-]\d+)?|-?\d+e[+-]\d+")


def shown(value: object) -> str:
    """A value as text, with numbers of six digits; those that are rounding errors are zero."""
    text = re.sub(r"compiled by (/.*/)?\S+", "compiled", repr(value))  # a path may have spaces

    def rounded(match: re.Match[str]) -> str:
        number = float(match[0])
        return f"{0.0 if abs(number) < 1e-9 else number:.6g}"

    return NUMBER.sub(rounded, re.sub(r"defect=\S+", "defect", text))


def evaluated(expressions: str, names: Mapping[str, Any]) -> str:
    """Each line with its value or its error, and the warnings."""
    lines = []
    for text in expressions.strip().splitlines():
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            try:
                value = shown(eval(text, {**names}))
            except (ArithmeticError, LookupError, OSError, TypeError, ValueError) as error:
                value = f"{type(error).__name__}: {error}"
        lines += [f">>> {text}", value, *(f"warning: {one.message}" for one in caught)]
    return "\n".join(lines)
