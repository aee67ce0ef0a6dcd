"""Commands that end in time, in an environment of which little is passed on."""

import os
import signal
import subprocess
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from selectors import EVENT_READ, DefaultSelector

#: Variables that are passed on. Others, such as CPATH or GCC_EXEC_PREFIX, change the files that a
#: compiler includes and links, and the key of a library does not contain them.
PASSED_ON = ("PATH", "HOME", "LD_LIBRARY_PATH", "SDKROOT", "DEVELOPER_DIR")
#: Bytes of an error message.
LONGEST = 300


class CommandError(Exception):
    """A command failed; the message is its last output, in one line."""


class Command:
    """A command that runs."""

    def __init__(self, process: subprocess.Popen[bytes]) -> None:
        self._process, self._output = process, b""

    def ends_within(self, seconds: float) -> bool:
        """Whether it ends in this time; `CommandError` if it fails."""
        until, stderr = time.monotonic() + seconds, self._process.stderr
        assert stderr is not None
        with DefaultSelector() as selector:
            selector.register(stderr, EVENT_READ)
            while (left := until - time.monotonic()) > 0 and selector.select(left):
                block = os.read(stderr.fileno(), 1 << 16)
                self._output = (self._output + block)[-LONGEST:]  # of output without end
                if not block:
                    break
        with suppress(subprocess.TimeoutExpired):
            code = self._process.wait(max(until - time.monotonic(), 0))
            if not code:
                return True
            message = " ".join(self._output.decode(errors="replace").split())
            end = f"signal {-code}, {signal.strsignal(-code)}" if code < 0 else f"exit {code}"
            raise CommandError(message or f"it ended with {end}")
        return False


@contextmanager
def running(command: Sequence[str], folder: Path) -> Iterator[Command]:
    """Run a command in a folder; at the end of the context all its processes are ended."""
    environment = {name: os.environ[name] for name in PASSED_ON if name in os.environ}
    environment |= {"LC_ALL": "C", "TMPDIR": str(folder), "ZIG_LOCAL_CACHE_DIR": str(folder)}
    # ziglang needs no home folder, and not the headers of the system's compiler, which may hang
    environment |= {"ZIG_GLOBAL_CACHE_DIR": str(folder.parent / "zig"), "CC": "false"}
    nowhere, pipe = subprocess.DEVNULL, subprocess.PIPE
    try:
        process = subprocess.Popen(
            command,
            cwd=folder,
            env=environment,
            stdin=nowhere,
            stdout=nowhere,
            stderr=pipe,
            start_new_session=True,
        )
    except OSError as error:
        raise CommandError(f"cannot be run: {error.strerror}") from error
    try:
        yield Command(process)
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
        assert process.stderr is not None
        process.stderr.close()
