"""One file adds a target language."""

import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import generated.double_pendulum as dp
from derive import load, write
from derive.codegen import backends
from derive.codegen.backend import find_backends

TARGET = '''
"""JavaScript modules."""

from derive.codegen.operations.assignments import ValueAssignment
from derive.codegen.backend import Backend


class JavaScriptBackend(Backend):
    """Functions of arrays, as an ECMAScript module."""

    suffix = ".mjs"

    def call(self, function, argument):
        return f"Math.{function}({argument})"

    def comment(self, text):
        return f"  // {text}"

    def statement(self, statement, function):
        assert isinstance(statement, ValueAssignment), "large systems are not supported"
        yield f"  const {statement.name} = {statement.text};"

    def file(self, contents):
        return "\\n".join(map(self.function, contents.functions))

    def function(self, function):
        assigned = self.assignments(function)
        lines = self.body(function, self.inputs(function), assigned)
        outputs = ", ".join(assigned.outputs)
        arguments = "t, y, params" if function.state else "params"
        return "\\n".join([
            f"export function {function.name}({arguments}) {{",
            *lines,
            f"  return [{outputs}];",
            "}",
        ])

    def inputs(self, function):
        parameters = [symbol.name for symbol in function.system.params]
        for argument, names in (("y", function.state), ("params", parameters)):
            for k, name in enumerate(names):
                if name in function.lowering.inputs:
                    yield f"  const {name} = {argument}[{k}];"


backend = JavaScriptBackend()
'''


@pytest.fixture
def file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    folder = tmp_path / "targets"
    folder.mkdir()
    (folder / "javascript.py").write_text(TARGET.lstrip())
    monkeypatch.setattr(backends, "__path__", [*backends.__path__, str(folder)])
    path = write(load("double_pendulum"), tmp_path / "build")
    yield path.with_suffix(".mjs")
    sys.modules.pop("derive.codegen.backends.javascript", None)


def test_the_targets_that_ship_are_files() -> None:
    assert [backend.suffix for backend in find_backends()] == [".h", ".py"]


def test_its_file_is_written_beside_the_others(file: Path) -> None:
    assert {path.suffix for path in file.parent.iterdir()} == {".h", ".mjs", ".py"}
    functions = re.findall(r"^export function (\w+)", file.read_text(), re.MULTILINE)
    assert functions == [*dp.OPERATIONS]
    assert "Math.sin(" in file.read_text()


@pytest.mark.skipif(shutil.which("node") is None, reason="needs Node.js")
def test_its_functions_have_the_values_of_the_python_functions(file: Path) -> None:
    y, params = [1.0, 2.0, 0.5, -0.3], list(dp.DEFAULTS)
    call = f"console.log(rhs_hamiltonian(0, {y}, {params}).join())"
    script = f"import {{ rhs_hamiltonian }} from '{file}'; {call}"
    command = ["node", "--input-type=module", "-e", script]
    run = subprocess.run(command, capture_output=True, text=True, check=True)
    result = [float(number) for number in run.stdout.split(",")]
    assert result == pytest.approx(dp.rhs_hamiltonian(0.0, y, params), rel=1e-14)
