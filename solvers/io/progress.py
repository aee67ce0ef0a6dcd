"""Progress: one line on a terminal, updated while a command runs."""

import os
import sys
import threading
import time

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
