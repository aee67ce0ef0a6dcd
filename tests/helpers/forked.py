"""Calls in a child process with limits of time and memory."""

import os
import pickle
import resource
import signal
import sys
import time
import traceback
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout, suppress
from dataclasses import dataclass
from io import StringIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

#: Time of the processor in s, memory in bytes beyond that of this process, time by the clock in s.
SECONDS, MEMORY, PATIENCE = 5, 2 << 30, 120


@dataclass(frozen=True)
class Ended:
    """The end of a call: its value or traceback, and its output."""

    value: Any = None
    out: str = ""
    err: str = ""
    traceback: str = ""


def forked(call: Callable[[], Any]) -> Ended:
    """Call a function in a copy of this process, which has everything imported already.

    A child that exceeds a limit is killed, and its `traceback` says so.
    """
    with TemporaryDirectory() as folder:
        path = Path(folder) / "ended"
        if not (child := os.fork()):
            _run(call, path)
        until = time.monotonic() + PATIENCE
        while not (ended := os.waitpid(child, os.WNOHANG))[0]:
            if time.monotonic() > until:
                os.kill(child, signal.SIGKILL)
            time.sleep(1e-3)
        if path.exists():
            return Ended(*pickle.loads(path.read_bytes()))
        status = ended[1]
        name = signal.Signals(os.WTERMSIG(status)).name if os.WIFSIGNALED(status) else status
        return Ended(traceback=f"the process ended with {name}")


def _run(call: Callable[[], Any], path: Path) -> None:
    """Call the function, write its end to a file and leave the process."""
    value, failure, out, err = None, "", StringIO(), StringIO()
    with suppress(BaseException):
        resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS + 1))
        size = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_AS, (size + MEMORY, size + MEMORY))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        with redirect_stdout(out), redirect_stderr(err):
            try:
                value = call()
            except SystemExit as leave:
                value = leave.code
            except BaseException:
                failure = traceback.format_exc()
        ended = pickle.dumps((value, out.getvalue(), err.getvalue(), failure))
        path.with_suffix(".part").write_bytes(ended)
        path.with_suffix(".part").rename(path)
    sys.stdout = sys.stderr = None
    os._exit(0)
