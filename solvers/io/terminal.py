"""Terminals of commands: standard streams in any condition, a line of progress, tables."""

import os
import sys
import threading
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from io import FileIO, TextIOWrapper
from itertools import zip_longest
from typing import Any


class _BestEffort(FileIO):
    """A file that discards what it cannot write: errors about messages have no other place."""

    def write(self, data: Any) -> int:
        try:
            return super().write(data) or 0
        except OSError:
            return len(data)


@contextmanager
def standard_streams() -> Iterator[None]:
    """Let a command write to the standard streams of its process, whatever they are.

    Characters that an encoding lacks are written as escape sequences. Messages that standard error
    does not take are lost. Standard output is written completely at the end. Streams that the
    caller has replaced are left as they are.

    Raises
    ------
    OSError
        When standard output is closed, or does not take what was written; `BrokenPipeError` when
        its reader has closed it. Nothing more is written to it then.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:  # closed: the next file would have this number, and receive messages
            os.set_inheritable(os.open(os.devnull, os.O_RDWR), True)
    if sys.stderr is sys.__stderr__:
        encoding = sys.stderr.encoding if sys.stderr else "utf-8"
        file: Any = _BestEffort(2, "w", closefd=False)
        sys.stderr = TextIOWrapper(file, encoding, "backslashreplace", write_through=True)
    if sys.stdout is None:
        raise OSError("standard output is closed: to discard the output, redirect it to /dev/null")
    if sys.stdout is sys.__stdout__ and isinstance(sys.stdout, TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")
    try:
        yield
    finally:
        _flush_output()


def _flush_output() -> None:
    try:
        sys.stdout.flush()
    except OSError as error:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # for the flush at exit
        error.filename = "standard output"
        raise


#: Seconds before the first line, and between updates.
FIRST, NEXT = 1.0, 0.2
#: Largest length of the line, and number of columns of a terminal that does not report it.
WIDTH, COLUMNS = 78, 80


class Progress:
    """Shows the activity that it is called with on standard error if that is a terminal.

    It adds the elapsed seconds, and erases its line at the end.
    """

    def __init__(self) -> None:
        self._text, self._since = "", time.monotonic()
        self._stop = threading.Event()
        self._thread: threading.Thread | None = None

    def __call__(self, text: str) -> None:
        """Describe the current activity."""
        self._text = text

    def __enter__(self) -> "Progress":
        if sys.stderr.isatty():
            self._thread = threading.Thread(target=self._report, daemon=True)
            self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stop.set()
        if self._thread:
            self._thread.join()

    def _report(self) -> None:
        wait = FIRST
        while not self._stop.wait(wait):
            text, width = f"{self._text}, {time.monotonic() - self._since:.0f} s", _width()
            print(f"\r{text[:width]:<{width}}", end="", file=sys.stderr, flush=True)
            wait = NEXT
        if wait == NEXT:
            print(f"\r{'':<{_width()}}\r", end="", file=sys.stderr, flush=True)


def _width() -> int:
    """Length of a line that fits the terminal, which the user may resize."""
    columns = os.get_terminal_size(sys.stderr.fileno()).columns or COLUMNS
    return min(columns - 1, WIDTH)  # a full line would move some terminals to the next


class ProgressRate:
    """Progress of `total` parts, of which `left` are left: the rate, and the remaining time."""

    def __init__(self, total: int, left: int) -> None:
        self._total, self._left, self._done, self._since = total, left, 0, time.monotonic()

    def __call__(self, parts: int) -> str:
        """Count further parts as done; describe the progress."""
        self._done += parts
        elapsed = max(time.monotonic() - self._since, 1e-9)
        rate, left = self._done / elapsed, self._left - self._done
        done = f"{self._total - left:,} of {self._total:,}"
        return f"{done}, {rate:,.0f} a second, {left / rate:.0f} s left"


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
