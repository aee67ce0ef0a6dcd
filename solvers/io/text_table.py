"""Tables as plain text."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import zip_longest


def text_table(columns: Mapping[str, str], rows: Iterable[Sequence[object]]) -> Iterator[str]:
    r"""Lines of a table whose columns are as wide as their cells.

    Parameters
    ----------
    columns : mapping of str to str
        The head of each column and the format specification of its numbers, such as ``".3g"``.
        A column with an empty specification holds text and is aligned to the left.
    rows : iterable of sequence
        A cell for each column. Text is shown as it is, None and NaN as a dash.

    Yields
    ------
    str
        The heads, then the rows.

    Examples
    --------
    >>> print(*text_table({"method": "", "error": ".1e"}, [("rk4", 0.01)]), sep="\n")
    method    error
    rk4     1.0e-02
    """
    specs = list(columns.values())
    lines = [list(columns)]
    lines += [[_cell(*pair) for pair in zip(row, specs, strict=True)] for row in rows]
    widths = [max(map(len, cells)) for cells in zip_longest(*lines, fillvalue="")]
    for line in lines:
        padded = (
            f"{cell:{'>' if spec else '<'}{width}}"
            for cell, spec, width in zip(line, specs, widths, strict=True)
        )
        yield "  ".join(padded).rstrip()


def _cell(value: object, spec: str) -> str:
    if value is None or value != value:
        return "-"
    return value if isinstance(value, str) else f"{value:{spec}}"
