"""C code to shared libraries, by the first compiler whose library works, built once."""

import ctypes
import hashlib
import os
import platform
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, nullcontext, suppress
from contextvars import ContextVar
from dataclasses import dataclass, field
from functools import cache, partial
from importlib.util import find_spec
from pathlib import Path
from selectors import EVENT_READ, DefaultSelector
from tempfile import TemporaryDirectory

from solvers.io.build_cache import BUILD_PREFIX, NoPlaceError, built_folder, leave_note, note
from solvers.io.suggestion import warn_caller

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


#: The file that a compiler writes, and its longest time in s.
LIBRARY, TIME_LIMIT = "library.so", 120.0
#: After this time in s a compiler must prove that it works, by a small program in the other time:
#: ziglang builds its libraries first, which takes some 5 s of processor time.
PATIENCE, TRIAL_LIMIT = 5.0, 15.0
#: Longest time in s of the call of a new library.
PROBE_LIMIT = 15.0
TRIAL = "int trial(void);\nint trial(void) { return 0; }\n"
#: Bytes that must be free: compilers report a full disk as an error of their own.
ROOM = 4_000_000
#: The end of every program: a library in the place of another is recognised by its key.
KEY = '\nconst char LIBRARY_KEY[] = "{key}";\n'
#: Loads a library and calls its function ``probe``, in a process that may crash.
PROBE = """
import ctypes, sys
try:
    library = ctypes.CDLL(sys.argv[1])
    key = ctypes.c_char.in_dll(library, "LIBRARY_KEY")
except (OSError, ValueError) as error:
    sys.exit(str(error))
if ctypes.string_at(ctypes.addressof(key)) != sys.argv[2].encode():
    sys.exit("it is another one")
getattr(library, "probe", int)()
"""


#: Whether this thread compiles a library that another one will need.
is_ahead = ContextVar("compiling ahead", default=False)


class TimeLimitError(CommandError):
    """A compiler did not end in time."""


def identity(command: Sequence[str]) -> tuple[str, ...]:
    """A command with time and size of its file: those of another compiler are others."""
    try:
        status = Path(command[0]).stat()
    except OSError as error:
        raise CommandError(f"cannot be run: {error.strerror}") from error
    return *command, str(status.st_mtime_ns), str(status.st_size)


@dataclass(frozen=True)
class Compilation:
    """A program, the command that compiles it, and the key of the library."""

    source: str
    command: tuple[str, ...]  # the compiler
    flags: tuple[str, ...]
    key: str

    def run(self, ready: Path, *, is_trial: bool = False) -> None:
        """Build the library in `ready`; the folder above it is for temporary files.

        `CommandError` if the compiler fails, and `OSError` if the disk is full.
        """
        folder = ready.parent
        (folder / "room").write_bytes(bytes(ROOM))
        (folder / "room").unlink()
        text = self.source + KEY.format(key=self.key)
        (folder / "source.c").write_text(text, encoding="utf-8")
        output = folder / LIBRARY
        command = *self.command, *self.flags, "-shared", "-o", output.name, "source.c", "-lm"
        with running(command, folder) as compiler:
            limit = TRIAL_LIMIT if is_trial else PATIENCE
            if not compiler.ends_within(limit):
                if is_trial or not self.compiler_works(folder.parent):
                    raise TimeLimitError(f"did not end within {PATIENCE + TRIAL_LIMIT:g} s")
                if not compiler.ends_within(TIME_LIMIT):
                    raise TimeLimitError(f"did not end within {TIME_LIMIT:g} s")
        if not output.is_file() or not output.stat().st_size:
            raise CommandError("wrote no library")
        self._probe(output)
        os.replace(output, ready / LIBRARY)

    def _probe(self, library: Path) -> None:
        command = sys.executable or "python3", "-I", "-S", "-c", PROBE, str(library), self.key
        try:
            with running(command, library.parent) as process:
                if not process.ends_within(PROBE_LIMIT):
                    raise CommandError(f"it did not return within {PROBE_LIMIT:g} s")
        except CommandError as error:
            raise CommandError(f"wrote a library that does not work: {error}") from error

    def compiler_works(self, place: Path) -> bool:
        """Whether the compiler builds a library of a program of two lines, in a new folder."""
        trial = Compilation(TRIAL, self.command, self.flags, "trial")
        with TemporaryDirectory(prefix=BUILD_PREFIX, dir=place) as folder:
            try:
                (ready := Path(folder, "ready")).mkdir()
                trial.run(ready, is_trial=True)
            except CommandError:
                return False
        return True


class FailedCompilations:
    """The failed compilations of this process and its forks, none of which is repeated.

    A compiler that hangs is noted for other processes.
    """

    def __init__(self) -> None:
        self._errors: dict[tuple[str, ...] | str, str] = {}
        self._working: set[tuple[str, ...]] = set()
        self.renew_lock()
        os.register_at_fork(after_in_child=self.renew_lock)

    def renew_lock(self) -> None:
        """Forget the threads that wait: a fork has none of them."""
        self._lock = threading.Lock()

    def run(self, compilation: Compilation, ready: Path) -> None:
        """Run a compilation, unless it has failed before, or its compiler.

        Until a compiler has worked, it runs one compilation at a time. A thread that compiles ahead
        does not wait: it tries the compiler with a small program.
        """
        key, command, place = compilation.key, compilation.command, ready.parent.parent
        digest = hashlib.sha256("\0".join(identity(command)).encode()).hexdigest()[:32]
        name = f"hanging-{digest}"
        if command not in self._working and is_ahead.get() and compilation.compiler_works(place):
            self._working.add(command)
        with nullcontext() if command in self._working else self._lock:
            if error := self._errors.get(command) or self._errors.get(key):
                raise CommandError(error)
            if error := note(place, name):
                raise CommandError(f"{error} in another process (remove {place / name} to retry)")
            try:
                compilation.run(ready)
                self._working.add(command)
            except CommandError as error:
                is_slow = isinstance(error, TimeLimitError)
                if is_slow:
                    leave_note(place, name, str(error))
                works = not is_slow and compilation.compiler_works(place)
                self._errors[key if works else command] = str(error)
                raise


#: ``-ffast-math`` would switch the whole process to flushing small numbers to zero.
#: Vectors are explicit in the source: loops over a small state are slower when vectorised.
FLAGS = (
    *("-std=c99", "-O3", "-march=native", "-fno-math-errno", "-fno-trapping-math", "-fPIC"),
    *("-fno-tree-vectorize", "-Wno-psabi"),
)
_attempts = FailedCompilations()


class NoCompilerError(OSError):
    """No compiler built the library; the message lists those tried and their errors."""


@dataclass(frozen=True)
class Library:
    """A shared library that was loaded; its digest and its key have been checked."""

    path: Path
    compiler: str  # the command that built it
    functions: ctypes.CDLL = field(compare=False, repr=False)


def build(source: str, *, reproducible: bool = False) -> Library:
    """The library of a complete C99 program, from the cache or by the first of `compilers`.

    If the program has a function ``void probe(void)``, it is called once, in another process,
    before a new library is used.

    Parameters
    ----------
    source : str
        The program.
    reproducible : bool, optional
        Whether no products and sums are fused: every compiler gives the same bits then, at some
        cost of speed.

    Raises
    ------
    NoCompilerError
        When no compiler builds a library that works.
    """
    contraction = "-ffp-contract=off" if reproducible else "-ffp-contract=fast"
    errors: list[str] = []
    for compiler in compilers():
        flags = (*FLAGS, *_tuning(compiler), contraction)
        try:
            library = _library(Compilation(source, compiler, flags, _key(source, compiler, flags)))
        except CommandError as error:
            errors.append(f"{compiler[0]}: {error}")
        except NoPlaceError as error:
            raise NoCompilerError(str(error)) from error
        else:
            if errors:
                warn_caller(f"compiling with {library.compiler}: {'; '.join(errors)}")
            return library
    tried = "; ".join(errors) or "none was found"
    raise NoCompilerError(
        f"no C compiler built the library ({tried}): install one as `cc`, or the package ziglang"
    )


def _library(compilation: Compilation) -> Library:
    """A library from the cache or built, and loaded."""
    key, fill = compilation.key, partial(_attempts.run, compilation)
    path = built_folder(key, fill, mark=key.encode(), is_loaded=True) / LIBRARY
    try:
        return Library(path, " ".join(compilation.command), ctypes.CDLL(str(path)))
    except OSError as error:
        raise CommandError(f"its library cannot be loaded: {error}") from error


def compilers() -> Iterator[tuple[str, ...]]:
    """Commands that compile C: the system's compiler, then that of the package ziglang."""
    path = shutil.which("cc")
    if path:
        yield (os.path.abspath(path),)
    package = find_spec("ziglang")
    if package and package.origin:
        yield (str(Path(package.origin).with_name("zig")), "cc")


def _key(source: str, compiler: Sequence[str], flags: Sequence[str]) -> str:
    """A digest of the source, the compiler, the flags and the processor."""
    parts = (source, *identity(compiler), *flags, _processor())
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()[:32]


def _tuning(compiler: Sequence[str]) -> tuple[str, ...]:
    """A flag with which GCC copies vectors of 32 bytes as a whole; Zig refuses it."""
    features = _processor().split()
    is_needed = "avx" in features and "avx512f" not in features and len(compiler) == 1
    return ("-mtune=skylake-avx512",) if is_needed else ()


@cache
def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    features = next((line for line in lines if line.startswith(("flags", "Features"))), "")
    return f"{platform.system()} {platform.machine()} {platform.processor()} {features}"
