"""Tables as plain text."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import zip_longest


def text_table(columns: Mapping[str, str], rows: Iterable[Sequence[object]]) -> Iterator[str]:
    r"""Lines of a table whose columns are as wide as their cells: the heads, then the rows.

    `columns` maps each head to the format specification of its numbers, empty for text, which is
    aligned to the left. Text is shown as it is, None and NaN as a dash.

    >>> print(*text_table({"method": "", "error": ".1e"}, [("rk4", 0.01)]), sep="\n")
    method    error
    rk4     1.0e-02
    """
    specs = list(columns.values())
    lines = [list(columns)]
    lines += [[_cell(*pair) for pair in zip(row, specs, strict=True)] for row in rows]
    widths = [max(map(len, cells)) for cells in zip_longest(*lines, fillvalue="")]
    formats = [f"{'>' if spec else '<'}{width}" for spec, width in zip(specs, widths, strict=True)]
    for line in lines:
        yield "  ".join(map(format, line, formats)).rstrip()


def _cell(value: object, spec: str) -> str:
    if value is None or value != value:
        return "-"
    return value if isinstance(value, str) else f"{value:{spec}}"
