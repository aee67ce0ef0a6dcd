"""A sweep that is killed, damaged or distributed has the same results; others are refused."""

import json
import os
import pty
import re
import signal
import subprocess
import sys
import time
import warnings
from collections.abc import Iterator
from concurrent.futures import CancelledError, Executor, Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from shutil import disk_usage
from typing import Any, TypeAlias

import numpy as np
import pytest
from sweep_file import FILE, write_sweep

import generated.double_pendulum as dp
from solvers.app.cli import main
from solvers.app.modules import load as load_module
from solvers.integration.problem.status import StopFlag
from solvers.sweeps.definition.axes import Grid, Random
from solvers.sweeps.definition.sweep import Sweep
from solvers.sweeps.definition.sweep_reading import find
from solvers.sweeps.execution import pool, worker
from solvers.sweeps.execution.folder import Folder, FolderError, _difference
from solvers.sweeps.execution.pool import LostWorkersError, Pool
from solvers.sweeps.execution.sweep_run import partial_results, sweep
from solvers.sweeps.execution.worker import run_chunk
from solvers.sweeps.maps.final import Final
from solvers.sweeps.maps.first import First

HOLONOMIC = str(Path(sys.executable).parent / "holonomic")
ANGLES = np.linspace(-3, 3, 40)
MAPS = {"flip": First({"theta1": (-np.pi, np.pi)}), "end": Final(("theta1",))}
DEFINITION = Sweep(dp, Grid({"theta1": ANGLES, "theta2": ANGLES}), MAPS, 3.0)
LONG = FILE.replace("duration = 30", "duration = 3000")
#: The address of a scheduler, and the processes of its workers.
Cluster: TypeAlias = tuple[str, list["subprocess.Popen[bytes]"]]


@pytest.fixture(autouse=True, scope="module")
def many_chunks() -> Iterator[None]:
    """A small sweep has many chunks only if their overhead is small."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(worker, "COST", 1e-5)
        yield


def files(folder: Path) -> dict[str, bytes]:
    """All files but the picture and the lock, by name."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.suffix != ".png" and path.name != "lock"
    }


@pytest.fixture(scope="module")
def expected(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    folder = tmp_path_factory.mktemp("undisturbed")
    sweep(DEFINITION, folder)
    results = files(folder)
    assert {"sweep.json", "flip.npy", "end.npy", "status.npy", "theta1.npy"} <= {*results}
    assert sum(name.startswith("chunks") for name in results) >= 16
    return results


@pytest.mark.parametrize("workers", [1, 3])
def test_the_number_of_threads_changes_nothing(
    workers: int, tmp_path: Path, expected: dict[str, bytes]
) -> None:
    sweep(DEFINITION, tmp_path, pool=Pool(workers=workers))
    assert files(tmp_path) == expected


#: Modules that a worker has loaded; it does not have this file.
modules: Any = eval("lambda: list(__import__('sys').modules)")


def loaded() -> list[str]:
    return [name for name in ("sympy", "derive", "matplotlib") if name in sys.modules]


def test_processes_have_the_same_results_and_never_load_sympy(
    tmp_path: Path, expected: dict[str, bytes]
) -> None:
    with ProcessPoolExecutor(2, get_context("spawn")) as executor:
        sweep(DEFINITION, tmp_path, pool=Pool(executor, 2))
        assert {tuple(executor.submit(loaded).result()) for _ in range(8)} == {()}
    assert files(tmp_path) == expected


@pytest.fixture
def cluster() -> Iterator[Cluster]:
    """A Dask scheduler and two workers, each a process of its own, on the loopback."""
    distributed = pytest.importorskip("distributed")
    run = partial(subprocess.Popen, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    with distributed.LocalCluster(
        n_workers=0, host="127.0.0.1", dashboard_address=None, protocol="tcp://"
    ) as scheduler:
        address = scheduler.scheduler_address
        command = [sys.executable, "-m", "distributed.cli.dask_worker", address]
        arguments = "--nthreads 1 --no-nanny --no-dashboard --host 127.0.0.1 --death-timeout 60"
        workers = [run([*command, *arguments.split()]) for _ in range(2)]
        try:
            scheduler.wait_for_workers(2, timeout=60)
            yield address, workers
        finally:
            for worker in workers:
                worker.kill()
                worker.wait()


@pytest.mark.long("processes of a cluster")
@pytest.mark.filterwarnings("default")  # of Dask's own
def test_a_cluster_that_loses_a_worker_has_the_same_results(
    cluster: Cluster, tmp_path: Path, expected: dict[str, bytes]
) -> None:
    address, workers = cluster
    from distributed import Client

    done = 0

    def report(_: str) -> None:
        nonlocal done
        done += 1
        if done == 4:
            workers[0].kill()

    with Client(address) as client:
        sweep(DEFINITION, tmp_path, pool=Pool(client.get_executor(), 2), report=report)
        (left,) = client.run(modules).values()  # the other worker is gone
        assert "solvers.sweeps.execution.worker" in left
        assert not {"sympy", "derive", "matplotlib"} & {*left}
    assert files(tmp_path) == expected


@pytest.mark.long("processes of a cluster")
@pytest.mark.filterwarnings("default")
def test_the_command_finds_a_cluster_by_its_address(
    cluster: Cluster, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = write_sweep(tmp_path)
    argv = ["sweep", str(path), "--json", "--output"]
    assert main([*argv, str(tmp_path / "here")]) == 0
    here = json.loads(capsys.readouterr().out)
    assert main([*argv, str(tmp_path / "there"), "--scheduler", cluster[0]]) == 0
    there = json.loads(capsys.readouterr().out)
    assert files(tmp_path / "here") == files(tmp_path / "there")
    assert here["status"] == there["status"] == {"finished": 14400}


def test_a_missing_scheduler_is_reported(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("solvers.app.commands.sweep.PATIENCE", 0.5)
    argv = ["sweep", str(write_sweep(tmp_path)), "--output", str(tmp_path / "out"), "--scheduler"]
    assert main([*argv, "tcp://127.0.0.1:9"]) == 4
    assert "no scheduler answers at tcp://127.0.0.1:9" in capsys.readouterr().err
    monkeypatch.setitem(sys.modules, "distributed", None)
    assert main([*argv, "tcp://127.0.0.1:9"]) == 4
    assert "pip install 'holonomic[cluster]'" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


@pytest.mark.long("several sweeps in other processes")
def test_a_killed_sweep_resumes_to_the_same_bytes(tmp_path: Path) -> None:
    # some seconds of work for one thread
    path = write_sweep(tmp_path, FILE.replace("duration = 30", "duration = 120"))
    command = [HOLONOMIC, "sweep", str(path), "--output"]
    subprocess.run([*command, str(tmp_path / "whole")], check=True, stdout=subprocess.DEVNULL)
    expected, interrupted = files(tmp_path / "whole"), tmp_path / "interrupted"
    random, unfinished = np.random.default_rng(1), 0
    for _ in range(6):
        argv = [*command, str(interrupted), "--workers", "1"]
        run = subprocess.Popen(argv, stdout=subprocess.DEVNULL)
        # at a random moment from the first file on
        while run.poll() is None and not (interrupted / "sweep.json").exists():
            time.sleep(0.001)
        time.sleep(random.uniform(0, 0.3))
        run.kill()
        run.wait()
        unfinished += not (interrupted / "end.npy").exists()
    subprocess.run([*command, str(interrupted)], check=True, stdout=subprocess.DEVNULL)
    assert files(interrupted) == expected
    assert len(expected) > 10
    assert unfinished > 1


@pytest.mark.parametrize("damage", ["truncated", "flipped", "empty", "missing"])
def test_a_damaged_chunk_is_repeated(
    damage: str, tmp_path: Path, expected: dict[str, bytes], monkeypatch: pytest.MonkeyPatch
) -> None:
    sweep(DEFINITION, tmp_path)
    chunk = sorted((tmp_path / "chunks").glob("*.npy"))[5]
    whole = chunk.read_bytes()
    chunk.unlink()
    if damage != "missing":
        flipped = whole[:200] + bytes([whole[200] ^ 1]) + whole[201:]
        chunk.write_bytes({"truncated": whole[:-9], "flipped": flipped, "empty": b""}[damage])
    done = []
    real = pool.run_equal_chunk
    monkeypatch.setattr(pool, "run_equal_chunk", lambda *given: done.append(1) or real(*given))
    sweep(DEFINITION, tmp_path)
    assert files(tmp_path) == expected
    assert len(done) == 1


def test_the_progress_counts_motions_that_are_stored_already(tmp_path: Path) -> None:
    reports: list[str] = []
    sweep(DEFINITION, tmp_path, report=reports.append)
    sorted((tmp_path / "chunks").glob("*.npy"))[5].unlink()
    again: list[str] = []
    sweep(DEFINITION, tmp_path, report=again.append)
    for report in (reports[-1], *again):
        assert report.startswith("1,600 of 1,600, ")
        assert report.endswith(" a second, 0 s left")
    assert len(again) == 1


@pytest.mark.parametrize(("change", "words"), [
    ({"duration": 4.0}, "duration 3.0, not 4.0"),
    ({"rtol": 1e-8}, "rtol 5e-08, not "),
    ({"axes": Grid({"theta1": ANGLES, "theta2": ANGLES + 1})}, "axes.axes.1.first -3.0, not "),
    ({"axes": Grid({"theta2": ANGLES, "theta1": ANGLES})}, "0.name 'theta1', not 'theta2'"),
    ({"axes": Random({"theta1": (0, 1), "theta2": (0, 1)}, 1600, 1)}, "kind 'grid', not 'random'"),
    ({"axes": Grid({"theta1": ANGLES, "theta2": ANGLES[1:]})}, "motions 1600, not 1560"),
    ({"maps": {"end": Final(("theta1",))}}, "maps.flip is in the folder only"),
    ({"values": {"l1": 2.0}}, "values.l1 is in the definition only"),
])  # fmt: skip
def test_a_folder_of_another_sweep_is_refused(
    change: dict[str, Any], words: str, tmp_path: Path, expected: dict[str, bytes]
) -> None:
    for name, content in expected.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes(content)
    definition: dict[str, Any] = {
        "axes": DEFINITION.axes,
        "maps": DEFINITION.maps,
        "duration": 3.0,
    } | change
    with pytest.raises(FolderError, match=words):
        sweep(Sweep(dp, **definition), tmp_path)
    assert files(tmp_path) == expected


@pytest.mark.parametrize(("other", "own", "words"), [
    ({"a": {"b": [1, {"c": 2.0}]}}, {"a": {"b": [1, {"c": 2.5}]}}, "a.b.1.c 2.0, not 2.5"),
    ({"a": [1, 2]}, {"a": [1, 2, 3]}, "a [1, 2], not [1, 2, 3]"),
    ({"a": {"b": 1}}, {"a": {}}, "a.b is in the folder only"),
    ({"a": {}}, {"a": {"b": 1}}, "a.b is in the definition only"),
    ({"a": {"b": 1}}, {"a": 1}, "a {'b': 1}, not 1"),
    ({"a": 1}, {"a": {"b": 1}}, "a 1, not {'b': 1}"),
    ({"a": [1], "b": 2}, {"b": 2, "a": [1]}, ""),
])  # fmt: skip
def test_the_first_difference_of_two_definitions_is_named(other: Any, own: Any, words: str) -> None:
    assert _difference(other, own) == words


@pytest.mark.long("more cases of the same kind", keep=4)
@pytest.mark.parametrize(
    "change",
    [
        "{}",
        "[]",
        "\0",
        '"chunk": 7.5',
        '"chunk": true',
        '"chunk": 0',
        '"chunk": 1e400',
        '"format": 1',
        '"motions": 5',
    ],
)
def test_a_changed_manifest_is_refused(
    change: str, tmp_path: Path, expected: dict[str, bytes]
) -> None:
    sweep(DEFINITION, tmp_path)
    manifest = (tmp_path / "sweep.json").read_text()
    key = change.partition(":")[0]
    changed = re.sub(rf"{key}: \d+", change, manifest, count=1) if ":" in change else change
    (tmp_path / "sweep.json").write_text(changed)
    with pytest.raises(
        FolderError,
        match=r"is no manifest of a sweep|contains another sweep|in format 1, .* reads format 5",
    ):
        sweep(DEFINITION, tmp_path)
    assert files(tmp_path) == expected | {"sweep.json": changed.encode()}
    # chunks of another length are not confused with these
    (tmp_path / "sweep.json").write_text(re.sub(r'"chunk": \d+', '"chunk": 90', manifest))
    sweep(DEFINITION, tmp_path)
    assert files(tmp_path)["flip.npy"] == expected["flip.npy"]


def test_a_folder_with_other_files_is_refused_and_they_are_kept(tmp_path: Path) -> None:
    (tmp_path / ".profile").write_text("mine")
    with pytest.raises(FolderError, match=r"holds .profile and no sweep"):
        sweep(DEFINITION, tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == [".profile"]
    out = tmp_path / "out"
    sweep(DEFINITION, out)
    mine = [out / ".hidden", out / "chunks" / "notes.npy", out / "chunks" / ".git"]
    for path in mine:
        path.write_text("mine")
    killed = subprocess.Popen(["true"])
    killed.wait()
    name = f".07-0123456789abcdef.npy.{killed.pid}"
    left = [out / f".flip.npy.{killed.pid}", out / "chunks" / name]
    for path in left:
        path.write_text("left by a killed process")
    sweep(DEFINITION, out)
    assert all(path.read_text() == "mine" for path in mine)
    assert not any(path.exists() for path in left)


def test_maps_that_do_not_fit_the_disk_are_refused_at_the_start(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    small = disk_usage(tmp_path)._replace(free=1000)
    monkeypatch.setattr("solvers.sweeps.execution.folder.disk_usage", lambda _: small)
    with pytest.raises(OSError, match=r"the maps need .* GB, and 1e-06 GB are free"):
        sweep(DEFINITION, tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_two_processes_in_one_folder_are_refused(tmp_path: Path) -> None:
    with Folder(tmp_path, DEFINITION).locked():
        with pytest.raises(FolderError, match="another process works in"):
            sweep(DEFINITION, tmp_path)
        with (
            pytest.raises(FolderError, match="another process works in"),
            Folder(tmp_path, DEFINITION).locked(),
        ):
            pass


class Failing(Executor):
    """An executor that breaks after a few chunks."""

    def __init__(self, after: int, error: BaseException) -> None:
        self.left, self.error = after, error

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Any:
        from concurrent.futures import Future

        future: Future[Any] = Future()
        self.left -= 1
        if self.left < 0:
            future.set_exception(self.error)
        else:
            future.set_result(fn(*args, **kwargs))
        return future


def test_chunks_completed_before_a_failure_are_kept(
    tmp_path: Path, expected: dict[str, bytes], monkeypatch: pytest.MonkeyPatch
) -> None:
    for after, error in ((5, RuntimeError("lost")), (4, KeyboardInterrupt())):
        with pytest.raises(type(error)):
            sweep(DEFINITION, tmp_path, pool=Pool(Failing(after, error), 1))
    chunks = [name for name in files(tmp_path) if name.startswith("chunks")]
    assert 6 <= len(chunks) <= 9
    so_far = partial_results(DEFINITION, tmp_path)
    assert 0 < so_far.count["not done yet"] < DEFINITION.motions
    assert np.isnan(so_far.maps["end"][so_far.status == 0]).all()
    assert np.isfinite(so_far.maps["end"][so_far.status != 0]).all()
    sweep(DEFINITION, tmp_path)
    assert files(tmp_path) == expected


@pytest.mark.parametrize("error", [CancelledError(), BrokenProcessPool("a process ended")])
def test_an_executor_that_fails_is_reported_and_the_sweep_resumes(
    error: Exception, tmp_path: Path, expected: dict[str, bytes]
) -> None:
    for after in (0, 5):  # at the first motions, and later
        with pytest.raises(LostWorkersError, match="the same call resumes the sweep"):
            sweep(DEFINITION, tmp_path, pool=Pool(Failing(after, error), 1))
    sweep(DEFINITION, tmp_path)
    assert files(tmp_path) == expected


@pytest.mark.parametrize("error", [ConnectionError("closed"), RuntimeError("closed")])
def test_a_connection_that_breaks_between_chunks_is_reported(
    error: Exception, tmp_path: Path
) -> None:
    calls = 0

    def threads() -> int:
        nonlocal calls
        calls += 1
        if calls > 3:
            raise error
        return 1

    executor = Failing(1000, error)
    with pytest.raises(LostWorkersError, match="the same call resumes the sweep"):
        sweep(DEFINITION, tmp_path, pool=Pool(executor, threads=threads))
    assert len(list(tmp_path.glob("chunks/*.npy"))) > 1


class Delayed(Executor):
    """An executor that computes nothing until it is time."""

    def __init__(self) -> None:
        self.jobs: list[tuple[Future[Any], Any]] = []

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Any:
        self.jobs.append((Future(), partial(fn, *args, **kwargs)))
        return self.jobs[-1][0]

    def work(self) -> None:
        while self.jobs:
            future, job = self.jobs.pop()
            future.set_result(job())


@pytest.mark.parametrize("count", [0, 1])
def test_a_sweep_that_waits_without_workers_warns(
    count: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    executor = Delayed()

    def threads() -> int:
        executor.work()
        return count

    monkeypatch.setattr(pool, "PATIENCE", 0.01)
    definition = Sweep(
        dp, Grid({"theta1": [0.1, 0.2], "theta2": [0.1]}), {"end": Final(("theta1",))}, 1.0
    )
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        results = sweep(definition, tmp_path, pool=Pool(executor, 1, threads))
    assert np.isfinite(results.maps["end"]).all()
    texts = [str(one.message) for one in caught]
    assert len(texts) == (2 if count == 0 else 0)
    assert all(text.startswith("there are no workers: the sweep waits") for text in texts)


def test_as_many_chunks_are_computed_at_once_as_there_are_threads() -> None:
    """Of an executor whose threads change, at least one: it may get them later."""
    counts = iter([3, 1, 0, 5])
    pool = Pool(threads=lambda: next(counts))
    assert [pool.size for _ in range(4)] == [3, 1, 1, 5]
    assert Pool(workers=4, threads=lambda: 2).size == 4
    assert Pool().size == len(os.sched_getaffinity(0))


@pytest.mark.long("processes of a cluster")
def test_a_cluster_without_workers_and_one_that_dies_are_reported(tmp_path: Path) -> None:
    pytest.importorskip("distributed")
    path, out, file = write_sweep(tmp_path, LONG), tmp_path / "out", tmp_path / "scheduler.json"
    quiet: Any = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    dask = [sys.executable, "-m", "distributed.cli.dask_"]

    def start(kind: str, *arguments: str) -> "subprocess.Popen[bytes]":
        command = [*dask[:-1], f"{dask[-1]}{kind}", *arguments, "--no-dashboard"]
        return subprocess.Popen([*command, "--host", "127.0.0.1"], **quiet)

    processes = [start("scheduler", "--port", "0", "--scheduler-file", str(file))]
    try:
        while not file.exists():
            time.sleep(0.05)
        address = json.loads(file.read_text())["address"]
        argv = [HOLONOMIC, "sweep", str(path), "--output", str(out), "--scheduler", address]
        run = subprocess.Popen(argv, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        assert run.stderr is not None
        assert run.stderr.readline().startswith(b"holonomic sweep: there are no workers: ")
        processes.append(start("worker", address, "--nthreads", "1", "--no-nanny"))
        while not list(out.glob("chunks/*.npy")):
            time.sleep(0.05)
        processes[0].kill()
        _, errors = run.communicate(timeout=60)
    finally:
        for process in processes:
            process.kill()
            process.wait()
    assert run.returncode == 4
    (line,) = errors.decode().splitlines()
    assert line.startswith(f"holonomic sweep: the cluster at {address} is gone")
    assert line.endswith("the same command resumes the sweep")


@pytest.mark.long("several sweeps in other processes")
def test_a_full_disk_leaves_no_incomplete_file(tmp_path: Path) -> None:
    path = write_sweep(tmp_path)
    command = [HOLONOMIC, "sweep", str(path), "--output"]
    subprocess.run([*command, str(tmp_path / "whole")], check=True, stdout=subprocess.DEVNULL)
    # files may not grow beyond a few chunks' size: the maps do not fit
    limited = f"import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (40000, 40000)); \
import sys; from solvers.app.cli import main; sys.exit(main(['sweep', {str(path)!r}, '--output', \
{str(tmp_path / 'full')!r}]))"
    run = subprocess.run(
        [sys.executable, "-c", limited], capture_output=True, text=True, check=False
    )
    assert run.returncode == 4
    assert f"File too large: '{tmp_path / 'full'}" in run.stderr
    assert "Traceback" not in run.stderr
    assert not (tmp_path / "full" / "end.npy").exists()
    subprocess.run([*command, str(tmp_path / "full")], check=True, stdout=subprocess.DEVNULL)
    assert files(tmp_path / "full") == files(tmp_path / "whole")


@pytest.mark.long("a sweep of several seconds in another process")
def test_an_interrupted_sweep_stops_at_once_and_resumes(tmp_path: Path) -> None:
    path = write_sweep(tmp_path, LONG)
    command = [
        sys.executable,
        "-c",
        "import signal, sys; from solvers.app.cli import main; "
        "signal.signal(signal.SIGINT, signal.default_int_handler); "
        f"sys.exit(main(['sweep', {str(path)!r}, '--output', {str(tmp_path / 'out')!r}]))",
    ]
    run = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    while not list((tmp_path / "out" / "chunks").glob("*.npy")):
        time.sleep(0.02)
    run.send_signal(signal.SIGINT)
    before = len(list((tmp_path / "out" / "chunks").glob("*.npy")))
    _, errors = run.communicate(timeout=60)
    assert run.returncode == 130
    assert b"Traceback" not in errors
    assert b"the same command resumes" in errors
    assert not [*(tmp_path / "out").rglob(".*")]
    after = len(list((tmp_path / "out" / "chunks").glob("*.npy")))
    assert after <= before + (os.cpu_count() or 1) + 1  # chunks that were nearly finished


def test_a_stop_flag_stops_only_its_own_motions() -> None:
    columns, flag = DEFINITION.axes.columns(0, 50), StopFlag()
    flag.set()
    with pytest.raises(InterruptedError, match="the sweep was stopped"):
        run_chunk(DEFINITION, columns, flag)
    chunk = run_chunk(DEFINITION, columns, StopFlag())
    assert chunk.tobytes() == run_chunk(DEFINITION, columns).tobytes()


def test_partial_results_can_be_plotted(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, out = write_sweep(tmp_path), tmp_path / "out"
    definition = find(str(path), load_module)
    with pytest.raises(RuntimeError):
        sweep(definition, out, pool=Pool(Failing(5, RuntimeError()), 1))
    before = files(out)
    assert main(["sweep", str(path), "--output", str(out), "--draw"]) == 0
    printed = capsys.readouterr().out
    assert "not done yet" in printed
    assert printed.endswith(f"files: {out / 'mine.png'}\n")  # the others existed before
    assert (out / "mine.png").read_bytes().startswith(b"\x89PNG")
    assert files(out) == before
    assert main(["sweep", str(path), "--output", str(tmp_path / "none"), "--draw"]) == 2
    assert "sweep.json does not exist" in capsys.readouterr().err


@pytest.mark.long("a sweep of several seconds")
def test_a_terminal_shows_progress_and_the_time_left(tmp_path: Path) -> None:
    path = write_sweep(tmp_path, LONG)
    master, slave = pty.openpty()
    argv = [HOLONOMIC, "sweep", str(path), "--output", str(tmp_path / "o")]
    run = subprocess.Popen(argv, stdout=subprocess.PIPE, stderr=slave)
    os.close(slave)
    printed = b""
    while b"s left" not in printed and run.poll() is None:
        printed += os.read(master, 1000)
    run.kill()
    run.communicate()
    os.close(master)
    assert b"of 14,400, " in printed
    assert b" a second, " in printed
