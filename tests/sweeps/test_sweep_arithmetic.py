"""A sweep has the bits of the arithmetic that began it, or is refused; the difference is named."""

import os
import platform
import subprocess
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from sweep_file import write_sweep

import generated.double_pendulum as dp
from solvers.app.cli import main
from solvers.integration.compiled import compiler
from solvers.integration.compiled.compiler import NoCompilerError
from solvers.integration.compiled.kernel import Kernel
from solvers.integration.loops import compiled_loop
from solvers.sweeps.definition.axes import Grid
from solvers.sweeps.definition.sweep import Sweep
from solvers.sweeps.execution import process_arithmetic, worker
from solvers.sweeps.execution.pool import Pool
from solvers.sweeps.execution.process_arithmetic import OtherArithmeticError
from solvers.sweeps.execution.sweep_run import sweep
from solvers.sweeps.maps.final import Final
from solvers.sweeps.maps.first import First

# kinds of arithmetic differ in fused products, which a compiler forms where it optimises
pytestmark = pytest.mark.usefixtures("fused")

ANGLES = np.linspace(-3, 3, 5)
MAPS = {"flip": First({"theta1": (-np.pi, np.pi)}), "end": Final(("theta1",))}
DEFINITION = Sweep(dp, Grid({"theta1": ANGLES, "theta2": ANGLES}), MAPS, 0.5)
#: Changes the arithmetic of this process to that of another one.
Change = Callable[[pytest.MonkeyPatch], None]


@pytest.fixture(autouse=True)
def some_chunks(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setattr(worker, "COST", 1e-7)
    another_process(monkeypatch)
    yield
    process_arithmetic._reproduced.clear()


def another_process(patch: pytest.MonkeyPatch) -> None:
    """Forget kernels and samples, as if this were another process."""
    patch.setattr(compiled_loop, "kernel", cache(Kernel))
    process_arithmetic._reproduced.clear()


def in_python(patch: pytest.MonkeyPatch) -> None:
    def no_loop(*_: Any, **__: Any) -> None:
        raise NoCompilerError("no C compiler")

    patch.setattr(compiled_loop, "loop", no_loop)
    process_arithmetic._reproduced.clear()


def for_processor(name: str) -> Change:
    def change(patch: pytest.MonkeyPatch) -> None:
        flags = [f"-march={name}" if f.startswith("-march=") else f for f in compiler.FLAGS]
        patch.setattr(compiler, "FLAGS", tuple(flags))
        another_process(patch)

    return change


CHANGES = [
    pytest.param(in_python, "loop: compiled with.* products, here Python", id="Python"),
    pytest.param(
        for_processor("x86-64"),
        "loop: compiled with fused products, here compiled without fused products",
        id="without fused products",
        marks=pytest.mark.skipif(platform.machine() != "x86_64", reason="needs an x86 processor"),
    ),
]


def contents(folder: Path) -> dict[str, bytes]:
    return {str(path): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.long("more cases of the same kind")
@pytest.mark.filterwarnings("ignore:integrating in Python")
@pytest.mark.parametrize(("change", "words"), CHANGES)
def test_a_sweep_that_other_arithmetic_began_is_refused(
    change: Change, words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    sweep(DEFINITION, tmp_path)
    before, maps = contents(tmp_path), (tmp_path / "end.npy").read_bytes()
    chunks = sorted((tmp_path / "chunks").glob("*.npy"))
    assert len(chunks) > 3
    chunks[2].unlink()
    change(monkeypatch)
    with pytest.raises(OtherArithmeticError, match=words) as error:
        sweep(DEFINITION, tmp_path)
    assert platform.node() in str(error.value)
    assert "give another --output" in str(error.value)
    assert contents(tmp_path) == {k: v for k, v in before.items() if k != str(chunks[2])}
    other = tmp_path / "other"
    sweep(DEFINITION, other)  # the way out, and the reason for the refusal
    assert (other / "end.npy").read_bytes() != maps
    assert np.allclose(np.load(other / "end.npy"), np.load(tmp_path / "end.npy"), atol=1e-6)


class Mixed(Executor):
    """Two workers in turn, of which the second has other arithmetic."""

    def __init__(self, change: Change) -> None:
        self.change, self.turn = change, 0

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Any:
        future: Future[Any] = Future()
        self.turn += 1
        with pytest.MonkeyPatch.context() as patch:
            another_process(patch)
            if self.turn == 4:
                self.change(patch)
            try:
                future.set_result(fn(*args, **kwargs))
            except ValueError as error:
                future.set_exception(error)
        return future


@pytest.mark.filterwarnings("ignore:integrating in Python")
@pytest.mark.parametrize(("change", "words"), CHANGES)
def test_a_worker_with_other_arithmetic_is_refused(
    change: Change, words: str, tmp_path: Path
) -> None:
    with pytest.raises(OtherArithmeticError, match=words):
        sweep(DEFINITION, tmp_path, pool=Pool(Mixed(change), 1))
    assert not (tmp_path / "end.npy").exists()
    # the others' chunks are kept: the sweep resumes without that worker
    results = sweep(DEFINITION, tmp_path)
    undisturbed = sweep(DEFINITION, tmp_path / "undisturbed")
    assert results.maps["end"].tobytes() == undisturbed.maps["end"].tobytes()


@pytest.mark.long("other tests reach its code")
@pytest.mark.skipif(platform.machine() != "x86_64", reason="needs an x86 processor")
def test_the_width_of_vectors_changes_no_bit(monkeypatch: pytest.MonkeyPatch) -> None:
    sample = DEFINITION.axes.columns(0, DEFINITION.motions)
    own = process_arithmetic.arithmetic(DEFINITION, sample)
    if own["loop"] != "compiled with fused products":
        pytest.skip("needs a processor with fused products")
    for_processor("haswell")(monkeypatch)  # 256 bits; processors with AVX-512 have 512
    assert process_arithmetic.arithmetic(DEFINITION, sample) == own
    for_processor("x86-64")(monkeypatch)  # 128 bits, and no fused products
    assert process_arithmetic.arithmetic(DEFINITION, sample)["digest"] != own["digest"]


@pytest.mark.long("other tests reach its code")
def test_a_library_that_rounds_a_sine_differently_has_other_arithmetic() -> None:
    code = """if True:
        import hashlib, numpy as np
        import generated.henon_heiles as hh  # its motions need no sine
        from solvers.sweeps.execution import process_arithmetic
        from solvers.sweeps.definition.axes import Grid
        from solvers.sweeps.maps.final import Final
        from solvers.sweeps.definition.sweep import Sweep
        axes = Grid({"x": [0.1], "y": [0.1]})
        one = Sweep(hh, axes, {"end": Final(("x",))}, 0.1)
        print(hashlib.sha256(np.sin(process_arithmetic.ARGUMENTS).tobytes()).hexdigest())
        print(process_arithmetic.arithmetic(one, axes.columns(0, 1))["digest"])"""
    without_fma = "glibc.cpu.hwcaps=-AVX2_Usable,-FMA_Usable,-AVX2,-FMA,-FMA4"
    (sine, own), (other_sine, other) = (
        subprocess.run(
            [sys.executable, "-c", code],
            env=os.environ | tunables,
            capture_output=True,
            text=True,
            check=True,
        ).stdout.split()
        for tunables in ({}, {"GLIBC_TUNABLES": without_fma})
    )
    if sine == other_sine:
        pytest.skip("this mathematical library has one sine for all processors")
    assert own != other


def test_the_command_names_the_difference(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    text = 'system = "double_pendulum"\nduration = 1\n[axes]\n' + "".join(
        f"theta{k} = {{ from = 0, to = 1, count = 8 }}\n" for k in (1, 2)
    )
    path = write_sweep(tmp_path, f'{text}[maps.end]\nkind = "final"\nof = ["theta1"]\n')
    argv = ["sweep", str(path), "--output", str(tmp_path / "out")]
    assert main(argv) == 0
    out = tmp_path / "out"
    files = f"files: {out / 'mine.png'} and {out}/*.npy"
    assert capsys.readouterr().out.splitlines()[-1] == files
    next((tmp_path / "out" / "chunks").glob("*.npy")).unlink()
    in_python(monkeypatch)
    capsys.readouterr()
    assert main(argv) == 2
    assert "products, here Python), and results would differ" in capsys.readouterr().err
