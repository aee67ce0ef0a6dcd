"""Names of systems, coordinates and parameters beside those of C: refused, or without effect."""

import inspect
import re
import shutil
import subprocess
from dataclasses import replace
from importlib.resources import files
from pathlib import Path

import pytest

import generated.single_pendulum as sp
from derive.system.naming import IDENTIFIER, check_name
from derive.system.parts import SystemDefinitionError
from solvers.integration.compiled import equations_source, kernel
from solvers.integration.compiled.kernel import PROGRAM, program
from solvers.integration.compiled.memory_layout import SOURCES
from solvers.integration.compiled.native import equations
from solvers.runge_kutta.method_catalogue import load

pytestmark = pytest.mark.skipif(shutil.which("cc") is None, reason="needs a C compiler")

#: The C that surrounds a generated header.
TEMPLATES = "".join(
    path.read_text(encoding="utf-8")
    for folder in (SOURCES, files("benchmarks"))
    for path in folder.iterdir()
    if path.name.endswith((".c", ".h"))
)
HEADERS = ("math", "float")


def is_allowed(name: str, system: str = "plain") -> bool:
    try:
        check_name(name, system)
    except SystemDefinitionError:
        return False
    return True


@pytest.mark.parametrize("standard", ["c99", "gnu99", "gnu17"])
def test_macros_of_the_standard_headers_are_refused_as_names(standard: str, tmp_path: Path) -> None:
    source = tmp_path / "source.c"
    own = re.findall("#include <(.*)>", PROGRAM + TEMPLATES) if standard == "c99" else []
    source.write_text("".join(f"#include <{name}>\n" for name in ("math.h", "float.h", *own)))
    command = ["cc", f"-std={standard}", "-D_GNU_SOURCE", "-dM", "-E", source]
    if standard == "c99":
        command.remove("-D_GNU_SOURCE")
    output = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    macros = set(re.findall(r"^#define (\w+)(?!\()\b", output, re.MULTILINE))
    assert {"FP_NAN", "DBL_MAX", "INFINITY"} <= macros
    assert [name for name in sorted(macros) if IDENTIFIER.match(name) and is_allowed(name)] == []


def test_macros_of_the_templates_are_refused_as_names() -> None:
    python = inspect.getsource(kernel) + inspect.getsource(equations_source)
    macros = set(re.findall(r"#define (\w+)", python + TEMPLATES))
    assert {"ONE_LANE", "RHS"} <= macros
    assert [name for name in sorted(macros) if is_allowed(name)] == []


def test_names_that_resemble_macros_are_allowed() -> None:
    for name in ("M_1", "FP", "M_P", "INT", "SIZE", "TIME", "I", "E", "MAX", "FLT", "lane_1"):
        check_name(name, "plain")


def test_all_other_words_of_the_templates_can_be_names(tmp_path: Path) -> None:
    words = sorted({word for word in re.findall(r"\w+", TEMPLATES) if is_allowed(word)})
    assert {"DIM", "real", "mask", "step", "run"} <= {*words}
    # inputs as generated functions declare them
    real = f"{sp.SYSTEM}_real"
    inputs = "\n".join(f"    const {real} {word} = params[{k}];" for k, word in enumerate(words))
    terms = " + ".join(words)
    function = f"static inline {real} words(const {real} *params)\n{{\n{inputs}\n"
    function += f"    return {terms};\n}}\n"
    source = equations(sp, "rational")
    source = replace(source, header=source.header + function)
    for lanes in (False, True):
        text = program(source, load("rk4"), lanes=lanes, compensated=False)
        (tmp_path / "program.c").write_text(text)
        command = ["cc", "-std=c99", "-Wno-psabi", "-fsyntax-only", tmp_path / "program.c"]
        subprocess.run(command, check=True)
    (tmp_path / "program.cpp").write_text(source.header)
    subprocess.run(["c++", "-fsyntax-only", tmp_path / "program.cpp"], check=True)


@pytest.mark.parametrize("system", ["lane", "holonomic"])
def test_systems_whose_headers_would_define_words_of_the_templates_are_refused(system: str) -> None:
    with pytest.raises(SystemDefinitionError, match=f"'{system}' cannot be a name in system"):
        check_name(system, system)


@pytest.mark.parametrize("name", "FP_NAN ONE_LANE DBL_MAX xor plain_clear PLAIN_BLOCK".split())
def test_the_message_names_the_word_and_the_rule(name: str) -> None:
    rule = "use a letter .* no word reserved by Python, C or generated code"
    with pytest.raises(
        SystemDefinitionError, match=f"'{name}' cannot be a name in system 'plain': {rule}"
    ):
        check_name(name, "plain")
