"""Hypothesis strategies: documents with invalid values, formulas, and damaged texts."""

import json
from collections.abc import Sequence
from copy import deepcopy
from math import inf, nan
from typing import Any

from hypothesis import strategies as st

#: Values where a number is expected, or a text, or a table.
NUMBERS = (
    *(0, -1, 1, 2, 10**9, 2**63 - 1, 0.5, -0.0, 1e-320, 1e-9, 1e20, 1e308, inf, -inf, nan),
    *("9.81", "20 s", "90 deg", "1 kg", "5 m", "1/0 m", "1,5 m", "3 furlong", "1e999", "sqrt(-1)"),
)
TEXTS = (
    *(
        "",
        " ",
        "None",
        "theta1",
        "m1",
        "lambda",
        "\ufeff",
        "\x00",
        "a\nb",
        "..",
        "/dev/zero",
        "é" * 9,
    ),
    *("__import__('os').abort()", "absent", "double_pendulum", "x" * 3000, "[" * 400, "energy"),
)
CONTAINERS = (True, False, [], {}, [[]], [1, "a"], {"value": 1}, [{}], [[1, 2], [3]], {"": ""})
#: Numbers, names and functions in formulas.
LEAVES = (
    "0 1 2 -1 1/2 0.1 1e400 1e-400 9999999999 pi t x x_dot q m k g l theta sin __class__".split()
)
FUNCTIONS = "sin cos tan exp log sqrt abs f open".split()
OPERATORS = "+ - * / ** // % @ == = , < | and".split()


def _compound(part: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    binary = st.builds(
        "({}){}({})".format, part, st.sampled_from([*OPERATORS[:5] * 4, *OPERATORS]), part
    )
    call = st.builds("{}({})".format, st.sampled_from([*FUNCTIONS[:6] * 2, *FUNCTIONS]), part)
    power = st.builds("({})**{}".format, part, st.sampled_from((2, 3, 30, 100, 10**6, "(1/3)")))
    nested = st.builds(
        lambda name, depth, text: f"{name}(" * depth + text + ")" * depth,
        st.sampled_from(["sin", "exp", "sqrt", ""]),
        st.sampled_from([5, 60, 190, 2000]),
        part,
    )
    repeated = st.builds(lambda text, count: "+".join([text] * count), part, st.integers(2, 40))
    return st.one_of(binary, binary, call, power, nested, repeated, part.map("-{}".format))


def formulas(names: Sequence[str]) -> st.SearchStrategy[str]:
    """Formulas in these names, valid and invalid ones."""
    leaves = st.sampled_from([*LEAVES, *names])
    return st.recursive(leaves, _compound, max_leaves=8)


@st.composite
def documents(draw: st.DrawFn, valid: dict[str, Any], names: Sequence[str]) -> str:
    """A TOML document with one to three changes, or with damage to its text."""
    document = deepcopy(valid)
    scalars = st.sampled_from([*NUMBERS, *NUMBERS, *TEXTS, *CONTAINERS])
    values = st.one_of(scalars, formulas(names))
    for _ in range(draw(st.integers(0, 3))):
        table = draw(st.sampled_from(_tables(document)))
        keys = [*table] if isinstance(table, dict) else [*range(len(table))]
        if not keys:
            continue
        key = draw(st.sampled_from(keys))
        match draw(st.sampled_from(["set", "set", "set", "delete", "add", "rename"])):
            case "delete":
                del table[key]
            case "add" if isinstance(table, dict):
                table[draw(st.sampled_from([*names, *TEXTS]))] = deepcopy(draw(values))
            case "rename" if isinstance(table, dict):
                table[draw(st.sampled_from([*names, *TEXTS, f"{key}_", key.upper()]))] = table.pop(
                    key
                )
            case _:
                table[key] = deepcopy(draw(values))
    text = toml(document)
    return draw(texts(text)) if draw(st.integers(0, 5)) == 0 else text


@st.composite
def texts(draw: st.DrawFn, valid: str) -> str:
    """A text with a part removed, repeated or replaced."""
    begin = draw(st.integers(0, len(valid)))
    end = draw(st.integers(begin, min(len(valid), begin + 40)))
    part = draw(
        st.one_of(
            st.just(""),
            st.just(valid[begin:end] * 2),
            st.text(max_size=5),
            st.sampled_from(
                ["\x00", "\ufeff", '"', "'''", "]", "\r", "\u202e", "\U0001f600", "[" * 9999]
            ),
        )
    )
    return valid[:begin] + part + valid[end:]


@st.composite
def contents(draw: st.DrawFn, valid: bytes) -> bytes:
    """The content of a file, truncated, with other bytes, or empty."""
    position = draw(st.integers(0, max(0, len(valid) - 1)))
    other = draw(st.binary(min_size=1, max_size=8))
    truncated, changed = valid[:position], valid[:position] + other + valid[position + len(other) :]
    return draw(st.sampled_from([b"", truncated, changed, valid + other, other, b"[" * 200_000]))


def toml(document: dict[str, Any]) -> str:
    """A document as text; tables in it are inline."""
    return "".join(f"{_toml(key)} = {_toml(value)}\n" for key, value in document.items())


def _tables(value: Any) -> list[Any]:
    """The tables and lists of a document."""
    if not isinstance(value, dict | list):
        return []
    parts = value.values() if isinstance(value, dict) else value
    return [value, *(table for part in parts for table in _tables(part))]


def _toml(value: Any) -> str:
    match value:
        case dict():
            rows = (f"{_toml(key)} = {_toml(part)}" for key, part in value.items())
            return f"{{{', '.join(rows)}}}"
        case list():
            return f"[{', '.join(map(_toml, value))}]"
        case float():
            return repr(value)  # as TOML spells nan and inf, too
        case _:
            return json.dumps(value, ensure_ascii=False)
