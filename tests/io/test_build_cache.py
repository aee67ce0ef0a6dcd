"""The cache of built folders: what is not intact is built anew, elsewhere if need be."""

import errno
import os
import subprocess
import sys
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import nullcontext
from importlib.util import cache_from_source
from pathlib import Path
from py_compile import compile as write_bytecode
from stat import S_IFDIR

import pytest
from folders import ROOT

import generated.single_pendulum as sp
from derive import Derivation, load
from derive.codegen.module_files import files
from derive.codegen.module_functions import Functions
from solvers.app.cli import VARIABLE, main, provide_matplotlib_folder
from solvers.equations.module import header
from solvers.equations.module_cache import cached_module
from solvers.integration.compiled.compiler import build
from solvers.integration.compiled.kernel import kernel
from solvers.integration.integrate import integrate
from solvers.io import atomic_write, build_cache
from solvers.io.atomic_write import write_text
from solvers.io.build_cache import ABANDONED, DIGESTS, NoPlaceError, built_folder, cache_folder

TEXT = "some text\n"


@pytest.fixture(autouse=True)
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return tmp_path / "holonomic"


def write(folder: Path) -> None:
    (folder / "file").write_text(TEXT)


def unexpected(folder: Path) -> None:
    raise AssertionError("it is built again")


def test_a_folder_is_built_once_and_holds_nothing_else(own_cache: Path) -> None:
    folder = built_folder("one", write)
    assert built_folder("one", unexpected) == folder == own_cache / "one"
    assert {path.name for path in folder.iterdir()} == {"file", DIGESTS}
    assert [path.name for path in own_cache.iterdir()] == ["one"]
    assert folder.stat().st_mode & 0o777 == 0o700  # no other user may enter it


def replace_by_pipe(path: Path) -> None:
    path.unlink()
    os.mkfifo(path)


def replace_by_link(path: Path) -> None:
    path.unlink()
    path.symlink_to("/dev/zero")


def replace_by_folder(path: Path) -> None:
    path.unlink()
    path.mkdir()


def enlarge(path: Path) -> None:
    os.truncate(path, 10**13)


def cut(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:-1])


def empty(path: Path) -> None:
    path.write_bytes(b"")


def open_to_all(path: Path) -> None:
    path.parent.chmod(0o777)


def extend(path: Path) -> None:
    path.write_bytes(path.read_bytes() + b"\n")


DAMAGE = (
    extend,
    replace_by_pipe,
    replace_by_link,
    replace_by_folder,
    enlarge,
    cut,
    empty,
    open_to_all,
)


@pytest.mark.parametrize("name", ["file", DIGESTS])
@pytest.mark.parametrize("damage", [*DAMAGE, open_to_all, Path.unlink])
def test_a_damaged_folder_is_built_again(damage: Callable[[Path], None], name: str) -> None:
    damage(built_folder("one", write) / name)
    folder = built_folder("one", write)
    assert (folder / "file").read_text() == TEXT
    assert built_folder("one", unexpected) == folder


@pytest.mark.parametrize(
    "line",
    ["", "x", "a  b  c", "0  -5  file", f"0  {'9' * 30}  file", "0  0  .", "0  1  /dev/zero", "é"],
)
@pytest.mark.parametrize("number", [0, 1, 2])
def test_a_seal_with_another_line_is_damage(number: int, line: str) -> None:
    seal = built_folder("one", write) / DIGESTS
    lines = seal.read_text().splitlines()
    seal.write_text("\n".join([*lines[:number], line, *lines[number + 1 :], ""]))
    assert (built_folder("one", write) / "file").read_text() == TEXT
    assert built_folder("one", unexpected) == seal.parent


def test_a_folder_under_the_name_of_another_is_built_again() -> None:
    other = built_folder("other", lambda folder: (folder / "file").write_text("other"))
    other.rename(other.with_name("one"))
    assert (built_folder("one", write) / "file").read_text() == TEXT


def test_a_folder_of_another_user_is_not_intact(monkeypatch: pytest.MonkeyPatch) -> None:
    folder, user = built_folder("one", write), os.getuid()
    assert build_cache.is_intact(folder)
    monkeypatch.setattr(os, "getuid", lambda: user + 1)
    assert not build_cache.is_intact(folder)


def test_a_folder_without_its_mark_is_built_again() -> None:
    built_folder("one", lambda folder: (folder / "file").write_text("other"))
    assert (built_folder("one", write, mark=b"text") / "file").read_text() == TEXT


def test_remains_of_killed_builds_are_removed_and_running_builds_are_not(own_cache: Path) -> None:
    built_folder("one", write)
    for name, age in {"running": 0.9 * ABANDONED, "killed": 1.1 * ABANDONED}.items():
        (own_cache / f"build-{name}").mkdir()
        os.utime(own_cache / f"build-{name}", (time.time() - age,) * 2)
    built_folder("two", write)
    assert [path.name for path in own_cache.glob("build-*")] == ["build-running"]


def unusable(cache: Path, kind: str) -> None:
    elsewhere = cache.parent / "elsewhere"
    elsewhere.mkdir()
    match kind:
        case "others can write to it":
            cache.mkdir()
            cache.chmod(0o777)
        case "not a folder":
            cache.symlink_to(elsewhere)
        case "File exists":
            cache.write_text("")


@pytest.mark.parametrize("kind", ["others can write to it", "not a folder", "File exists"])
def test_a_cache_that_others_could_write_to_is_not_used(kind: str, own_cache: Path) -> None:
    unusable(own_cache, kind)
    with pytest.warns(UserWarning, match=f"building in .*{own_cache}: {kind}.*XDG_CACHE_HOME"):
        folder = built_folder("one", write)
    assert not folder.is_relative_to(own_cache.parent)


@pytest.mark.parametrize("mode", [0o777, 0o770, 0o1777])
def test_a_cache_that_others_could_replace_is_not_used(
    mode: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    parent = tmp_path / "parent"
    parent.mkdir()
    parent.chmod(mode)
    monkeypatch.setenv("XDG_CACHE_HOME", str(parent / "cache"))
    if mode & 0o1000:  # as /tmp, where only owners rename their files
        assert built_folder("one", write).is_relative_to(parent)
        return
    with pytest.warns(UserWarning, match=f"{parent}: others can write to it"):
        assert not built_folder("one", write).is_relative_to(parent)


def test_a_cache_of_another_user_is_not_used(
    own_cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert cache_folder() == own_cache
    user = os.getuid()
    monkeypatch.setattr(os, "getuid", lambda: user + 1)
    with pytest.raises(OSError, match="belongs to another user"):
        cache_folder()


@pytest.mark.parametrize(("own", "above", "reason"), [
    ((1000, 0o700), (1000, 0o755), None),
    ((1000, 0o755), (0, 0o755), None),
    ((1000, 0o700), (0, 0o1777), None),  # as /tmp
    ((1000, 0o700), (65534, 0o755), None),  # as root in a container, which owns "/"
    ((0, 0o700), (0, 0o755), "another user"),  # even of root, which is above it
    ((7, 0o700), (0, 0o755), "another user"),
    ((1000, 0o700), (7, 0o755), "another user"),
    ((1000, 0o700), (7, 0o1777), "another user"),
    ((1000, 0o720), (0, 0o755), "others can write"),
    ((1000, 0o1702), (0, 0o755), "others can write"),  # the sticky bit admits new files
    ((1000, 0o700), (0, 0o775), "others can write"),
    ((1000, 0o700), (1000, 0o757), "others can write"),
])  # fmt: skip
def test_a_cache_is_private_by_owners_and_modes(
    own: tuple[int, int], above: tuple[int, int], reason: str | None,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    """Against the rule for a user 1000: who else could write to it, or put another in its place."""
    states = {"cache": own, "above": above, "": (65534, 0o755)}

    def state(path: str | Path) -> os.stat_result:
        user, mode = states[Path(path).name]
        return os.stat_result((S_IFDIR | mode, 0, 0, 2, user, 0, 0, 0, 0, 0))

    with monkeypatch.context() as patched:
        patched.setattr(os, "getuid", lambda: 1000)
        patched.setattr(os, "stat", state)
        patched.setattr(Path, "lstat", state)
        with nullcontext() if reason is None else pytest.raises(PermissionError, match=reason):
            build_cache._check_private(Path("/above/cache"))


@pytest.mark.parametrize(("age", "is_valid"), [
    (0.0, True), (0.9, True), (1.1, False), (-0.9, True), (-1.1, False),
])  # fmt: skip
def test_a_note_is_valid_for_a_time_and_not_from_the_future(
    age: float, tmp_path: Path, *, is_valid: bool
) -> None:
    build_cache.leave_note(tmp_path, "note", "text")
    os.utime(tmp_path / "note", (time.time() - age * build_cache.VALID,) * 2)
    assert build_cache.note(tmp_path, "note") == ("text" if is_valid else None)
    assert (tmp_path / "note").exists() == is_valid


def test_folders_above_the_cache_are_private_under_any_umask(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "one" / "two"))
    before = os.umask(0)
    try:
        assert built_folder("one", write).is_relative_to(tmp_path)
    finally:
        os.umask(before)


@pytest.mark.parametrize("home", [None, "relative", "/proc/no-such-folder"])
def test_without_a_home_it_is_built_elsewhere(
    home: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("XDG_CACHE_HOME")
    if home is None:
        monkeypatch.setattr(os.path, "expanduser", lambda path: path)  # of an unknown user
    else:
        monkeypatch.setenv("HOME", home)
    with pytest.warns(UserWarning, match="building in "):
        assert built_folder("one", write).is_dir()


def full(place: Path) -> Callable[[Path], None]:
    def build(folder: Path) -> None:
        if folder.is_relative_to(place):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        write(folder)

    return build


def test_with_a_full_disk_it_is_built_elsewhere(own_cache: Path) -> None:
    with pytest.warns(UserWarning, match=f"building in .*{own_cache}: No space left on device"):
        folder = built_folder("one", full(own_cache))
    assert not folder.is_relative_to(own_cache)
    assert [*own_cache.iterdir()] == []
    with pytest.raises(NoPlaceError, match=rf"{own_cache}: No space.*; /dev/shm/\S+: No space"):
        built_folder("two", full(Path("/")))


def test_a_library_on_a_full_or_noexec_disk_is_built_elsewhere(
    own_cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    source, write_bytes, status = "int x;\n", Path.write_bytes, os.statvfs

    def full_disk(path: Path, data: bytes) -> int:
        if path.is_relative_to(own_cache):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return write_bytes(path, data)

    with monkeypatch.context() as patch:
        patch.setattr(Path, "write_bytes", full_disk)
        with pytest.warns(UserWarning, match="No space left"):
            assert not build(source).path.is_relative_to(own_cache)
    library = build(source)
    assert library.path.is_relative_to(own_cache)

    class NoExec:
        f_flag = os.ST_NOEXEC

    monkeypatch.setattr(os, "statvfs", lambda p: NoExec if p == own_cache else status(p))
    with pytest.warns(UserWarning, match=f"{own_cache}: mounted noexec"):
        assert not build(source).path.is_relative_to(own_cache)


def read_only(*_: object, **__: object) -> str:
    name = f"/a/random/name/{time.perf_counter_ns()}"
    raise OSError(errno.EROFS, os.strerror(errno.EROFS), name)


def test_where_nothing_can_be_written_it_runs_in_python_with_one_notice(
    own_cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    build_cache._temporary_folder.cache_clear()
    monkeypatch.setattr(build_cache.tempfile, "mkdtemp", read_only)
    kernel.cache_clear()
    text = f"^integrating in Python: nothing can be built .{own_cache}: Read-only file system; "
    with pytest.warns(UserWarning, match=text) as notices:
        solutions = [integrate(sp, (0, 0.1), (1.0, 0.0), sp.DEFAULTS) for _ in range(2)]
    assert [(s.backend, s.success) for s in solutions] == [("python", True)] * 2
    assert len(notices) == 2
    assert len({str(notice.message) for notice in notices}) == 1  # which is shown once
    kernel.cache_clear()
    functions = Functions(Derivation(load("single_pendulum")))
    texts = files(functions.part(functions.names))
    with pytest.warns(UserWarning, match=text):
        module = cached_module("single_pendulum", "key", lambda: texts)
    assert header(module) is None
    assert integrate(module, (0, 0.1), (1.0, 0.0), sp.DEFAULTS).backend == "python"


def without_home(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", "/proc/no/home")
    for name in ("XDG_CONFIG_HOME", "XDG_CACHE_HOME", VARIABLE):
        monkeypatch.setenv(name, "")


def test_matplotlib_gets_a_temporary_folder_where_there_is_no_home(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    without_home(monkeypatch)
    provide_matplotlib_folder()
    assert os.access(os.environ[VARIABLE], os.W_OK)
    monkeypatch.setenv(VARIABLE, str(tmp_path))
    provide_matplotlib_folder()
    assert os.environ[VARIABLE] == str(tmp_path)
    monkeypatch.delenv(VARIABLE)
    monkeypatch.setenv("HOME", str(tmp_path))
    for _ in range(2):  # Matplotlib's own folders do not exist at first
        provide_matplotlib_folder()
        assert VARIABLE not in os.environ


def test_a_command_with_plots_names_all_folders_where_nothing_can_be_written(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    without_home(monkeypatch)
    build_cache._temporary_folder.cache_clear()
    monkeypatch.setattr(build_cache.tempfile, "mkdtemp", read_only)
    assert main(["run", "rest"]) == 4
    message = capsys.readouterr().err
    assert "/proc/no/home/.config/matplotlib: " in message
    assert "/var/tmp: Read-only file system" in message
    assert message.endswith("set MPLCONFIGDIR to a folder that can be written to\n")


def test_finished_folders_in_a_read_only_cache_are_used(monkeypatch: pytest.MonkeyPatch) -> None:
    folder = built_folder("one", write)
    monkeypatch.setattr(build_cache.tempfile, "mkdtemp", read_only)
    assert built_folder("one", unexpected) == folder


def test_a_fork_leaves_the_temporary_folder_to_its_parent(own_cache: Path) -> None:
    own_cache.write_text("")
    program = (
        "import os, sys, warnings; warnings.simplefilter('ignore')\n"
        "from solvers.io.build_cache import built_folder\n"
        "folder = built_folder('one', lambda folder: (folder / 'file').write_text('text'))\n"
        "if os.fork() == 0: sys.exit()\n"
        "os.wait(); print(folder, (folder / 'file').read_text())\n"
    )
    command = [sys.executable, "-c", program]
    root = ROOT
    output = subprocess.run(command, capture_output=True, text=True, check=True, cwd=root).stdout
    folder, text = output.split()
    assert text == "text"
    assert not Path(folder).exists()


def test_a_temporary_folder_that_is_gone_before_the_end_is_no_error(own_cache: Path) -> None:
    own_cache.write_text("")
    program = (
        "import shutil, warnings; warnings.simplefilter('ignore')\n"
        "from solvers.io.build_cache import built_folder\n"
        "folder = built_folder('one', lambda folder: (folder / 'file').write_text('text'))\n"
        "shutil.rmtree(folder.parent)\n"
    )
    command = [sys.executable, "-c", program]
    assert subprocess.run(command, capture_output=True, check=True, cwd=ROOT).stderr == b""


def test_bytecode_beside_a_cached_module_is_not_loaded() -> None:
    def plain() -> object:
        return cached_module("plain", "key", lambda: {"plain.py": "VALUE = 1\n"})

    path = Path(str(plain().__file__))
    other = path.with_name("other.py")
    other.write_text("VALUE = 2\n")
    os.utime(other, (path.stat().st_mtime,) * 2)
    write_bytecode(str(other), cache_from_source(str(path)))
    assert plain().VALUE == 1


def test_a_folder_where_a_file_belongs_is_named(tmp_path: Path) -> None:
    (path := tmp_path / "table.csv").mkdir()
    with pytest.raises(IsADirectoryError) as caught:
        write_text(path, "text")
    assert str(caught.value) == f"[Errno 21] Is a directory: '{path}'"
    assert [*tmp_path.iterdir()] == [path]


def test_threads_that_write_one_file_all_succeed(tmp_path: Path) -> None:
    path, texts = tmp_path / "file.png", [str(k) * 100_000 for k in range(8)]
    with ThreadPoolExecutor(8) as threads:
        assert [*threads.map(lambda text: write_text(path, text), texts)] == [path] * 8
    assert path.read_text() in texts
    assert [*tmp_path.iterdir()] == [path]


def test_files_of_ended_processes_are_removed_even_if_others_do_so_first(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ended = subprocess.Popen(["true"])
    ended.wait()
    kept = [tmp_path / "a.txt", tmp_path / f".a.txt.{os.getpid()}"]
    names = [f".{name}.{ended.pid}" for name in "ab"]
    for path in (*kept, *(tmp_path / name for name in names)):
        path.write_text("")
    assert [atomic_write.is_temporary(path) for path in kept] == [False, True]
    atomic_write.remove_abandoned(tmp_path)
    assert sorted(tmp_path.iterdir()) == sorted(kept)
    # another process removes a file between the question and the removal
    monkeypatch.setattr(atomic_write, "is_abandoned", lambda path: path.unlink() is None)
    atomic_write.remove_abandoned(tmp_path)
    assert not [*tmp_path.iterdir()]


def test_files_of_processes_of_other_users_are_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    def forbidden(process: int, signal: int) -> None:
        raise PermissionError(errno.EPERM, "Operation not permitted")

    monkeypatch.setattr(os, "kill", forbidden)
    assert not atomic_write.is_abandoned(Path(".a.txt.1"))
