"""Measurements from tables: columns of numbers with units in their heads."""

import csv
import math
import re
from collections.abc import Mapping, Sequence
from io import StringIO
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from solvers.io.quantity import UnitError, dimension
from solvers.io.suggestion import did_you_mean, shortened
from solvers.io.toml_input import InputError, read_bytes
from solvers.scenes.fitting.measurement import Measurement

#: Bytes of the largest table.
MAX_BYTES = 200_000_000
#: Heads of the column of times, and cells without a value.
TIMES, GAPS = ("t", "time"), ("", "nan", "na", "n/a", "null", "none", "-")
#: A name or formula, then its unit in square brackets, or in round ones behind a name.
HEAD = re.compile(
    r"\s*(?:(?P<name>.*?)\s*\[(?P<unit>[^\[\]]*)\]|(?P<word>\w+)\s+\((?P<own>[^()]*)\))\s*"
)


def read(path: Path, units: Mapping[str, str], ignored: Sequence[str] = ()) -> Measurement:
    """The measurement in a file with comma-separated values; `InputError` where it is not valid.

    `units` are those of the known quantities; other columns are formulas, or `ignored`. Columns
    may also be separated by semicolons or tabs, and lines that start with # are comments.
    """
    try:
        content = read_bytes(path, MAX_BYTES)
    except FileNotFoundError as error:
        raise InputError(f"{path}: there is no such file") from error
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"{path} is no text in UTF-8: {error}") from error
    lines = [(k, line) for k, line in enumerate(text.splitlines(), 1) if line.strip()]
    lines = [(k, line) for k, line in lines if not line.lstrip().startswith("#")]
    if len(lines) < 2:
        raise InputError(
            f"{path} holds no data: give a line of column names, then lines of numbers"
        )
    separator = next((mark for mark in ";\t" if mark in lines[0][1]), ",")
    try:
        rows = [*csv.reader(StringIO("\n".join(line for _, line in lines)), delimiter=separator)]
    except csv.Error as error:
        raise InputError(f"{path}: {error}") from error
    heads, numbers = [head.strip() for head in rows[0]], [k for k, _ in lines]
    if len(set(heads)) < len(heads):
        twice = next(head for head in heads if heads.count(head) > 1)
        raise InputError(f"{path}: two columns are named {shortened(twice)}: name them differently")
    columns: dict[str, list[float]] = {head: [] for head in heads}
    for number, row in zip(numbers[1:], rows[1:], strict=False):
        if len(row) != len(heads):
            raise InputError(
                f"{path}, line {number} has {len(row)} cells, but there are {len(heads)} columns"
            )
        for head, cell in zip(heads, row, strict=True):
            if quantity(head)[0] not in ignored:
                columns[head].append(_number(cell, f"{path}, line {number}, column {head}"))
    return measurement(columns, units, path.stem, ignored, str(path))


def _number(cell: str, place: str) -> float:
    if cell.strip().lower() in GAPS:
        return math.nan
    try:
        return float(cell)
    except ValueError as error:
        hint = " (a decimal point is a point)" if "," in cell else ""
        raise InputError(
            f"{place}: {shortened(cell)} is no number{hint}; leave a cell without a value empty"
        ) from error


def measurement(
    columns: Mapping[str, ArrayLike],
    units: Mapping[str, str],
    name: str = "measurement",
    ignored: Sequence[str] = (),
    where: str = "",
) -> Measurement:
    """The measurement in columns whose heads may contain units, such as ``theta1 [deg]``."""
    where, times, values = where or name, None, dict[str, ArrayLike]()
    for number, (head, column) in enumerate(columns.items(), 1):
        what, unit = quantity(head)
        if what in ignored:
            continue
        if not what:
            raise InputError(
                f"{where}: column {number}, {shortened(head)}, has no name: name the quantity that "
                "it measures, or remove the column"
            )
        array = np.array(column, float)
        if what in TIMES and what not in units:
            times = array * _factor(unit or "s", "s", f"{where}, column {head}")
            if (gaps := np.flatnonzero(~np.isfinite(times))).size:
                raise InputError(
                    f"{where}: the time in row {gaps[0] + 1} is missing: every row needs its time"
                )
            continue
        if what.isidentifier() and what not in units:
            known = ", ".join(units)
            raise InputError(
                f"{where}: column {shortened(head)} names no quantity of the system"
                f"{did_you_mean(what, units)}; known are t, {known}, and formulas of these; leave "
                f"it out with --ignore {what}"
            )
        own = units.get(what)
        factor = 1.0 if unit is None else _factor(unit, own or unit, f"{where}, column {head}")
        if unit is not None and own is None:
            factor = dimension(unit)[0]  # of a formula, in SI units
        values[what] = factor * array
    if times is None:
        heads = ", ".join(map(shortened, columns))
        raise InputError(f"{where} has no column of times, named t: its columns are {heads}")
    try:
        return Measurement(times, values, name)
    except ValueError as error:
        raise InputError(f"{where}: {error}") from error


def quantity(head: str) -> tuple[str, str | None]:
    """Name or formula, and unit, of a column."""
    if match := HEAD.fullmatch(head.strip()):
        if match["word"]:
            return match["word"], match["own"].strip()
        return match["name"].strip(), match["unit"].strip()
    return head.strip(), None


def _factor(unit: str, expected: str, place: str) -> float:
    try:
        (scale, own), (size, required) = dimension(unit), dimension(expected)
    except UnitError as error:
        raise InputError(f"{place}: {error}") from error
    if own != required:
        raise InputError(f"{place}: the unit {unit} is not one of {expected}")
    return scale / size
