"""Progress: one line on a terminal, updated while a command runs."""

from __future__ import annotations

import sys
import threading
import time

#: Seconds before the first line, and between updates.
FIRST, NEXT = 1.0, 0.2
#: Length of the line.
WIDTH = 78


class Progress:
    """Shows the current activity on standard error if that is a terminal, and erases it at the end.

    Call it with a description of the activity; it adds the elapsed seconds.
    """

    def __init__(self) -> None:
        self._text, self._since = "", time.monotonic()
        self._stop = threading.Event()
        self._thread: threading.Thread | None = None

    def __call__(self, text: str) -> None:
        """Describe the current activity."""
        self._text = text

    def __enter__(self) -> Progress:
        if sys.stderr.isatty():
            self._thread = threading.Thread(target=self._report, daemon=True)
            self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stop.set()
        if self._thread:
            self._thread.join()

    def _report(self) -> None:
        if self._stop.wait(FIRST):
            return
        while True:
            line = f"{self._text}, {time.monotonic() - self._since:.0f} s"[:WIDTH]
            sys.stderr.write(f"\r{line:<{WIDTH}}")
            sys.stderr.flush()
            if self._stop.wait(NEXT):
                sys.stderr.write(f"\r{'':<{WIDTH}}\r")
                sys.stderr.flush()
                return


class Rate:
    """Progress of a number of parts: how many are done, the rate, and the remaining time.

    Parameters
    ----------
    total, left : int
        Number of parts, and of those that are left.
    """

    def __init__(self, total: int, left: int) -> None:
        self._total, self._left, self._done, self._since = total, left, 0, time.monotonic()

    def __call__(self, parts: int) -> str:
        """Count further parts as done; describe the progress."""
        self._done += parts
        elapsed = max(time.monotonic() - self._since, 1e-9)
        rate, left = self._done / elapsed, self._left - self._done
        done = f"{self._total - left:,} of {self._total:,}"
        return f"{done}, {rate:,.0f} a second, {left / rate:.0f} s left"
