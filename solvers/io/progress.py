"""One line on a terminal that says what is going on, from the first second on."""

from __future__ import annotations

import sys
import threading
import time
from types import TracebackType

#: Seconds before the first word, and between two.
FIRST, NEXT = 1.0, 0.2
#: Longest line; longer ones would not be wiped out.
WIDTH = 78


class Progress:
    """Tells on standard error what goes on, if that is a terminal, and wipes it out in the end.

    It is called with what is being done; seconds pass by themselves.
    """

    def __init__(self) -> None:
        self._text, self._since = "", time.monotonic()
        self._stop = threading.Event()
        self._thread: threading.Thread | None = None

    def __call__(self, text: str) -> None:
        """Say what is being done from now on."""
        self._text = text

    def __enter__(self) -> Progress:
        if sys.stderr.isatty():
            self._thread = threading.Thread(target=self._report, daemon=True)
            self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:  # fmt: skip
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
    """How far something is that is done part by part, how fast it goes, and how long it will take.

    Parameters
    ----------
    whole : int
        How many parts there are.
    left : int
        How many of them are left.
    """

    def __init__(self, whole: int, left: int) -> None:
        self._whole, self._left, self._done, self._since = whole, left, 0, time.monotonic()

    def __call__(self, parts: int) -> str:
        """So many more are done; what there is to say."""
        self._done += parts
        elapsed = max(time.monotonic() - self._since, 1e-9)
        rate, left = self._done / elapsed, self._left - self._done
        return (
            f"{self._whole - left:,} of {self._whole:,}, {rate:,.0f} a second, "
            f"{left / rate:.0f} s left"
        )
