"""Standard streams of commands: closed, full, in any encoding, or an unread pipe."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from io import FileIO, TextIOWrapper
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
