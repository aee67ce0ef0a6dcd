"""C headers: they compile without a warning and give the Python functions' bits."""

import ctypes
import inspect
import random
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from derive import Derivation
from derive.codegen.functions import Function, contents
from solvers.equations.forms import Form

GENERATED = Path(__file__).parent.parent / "generated"
STRICT = ["-O2", "-Wall", "-Wextra", "-Wconversion", "-Werror", "-pedantic", "-ffp-contract=off"]

pytestmark = pytest.mark.skipif(shutil.which("cc") is None, reason="needs a C compiler")


def compiled(source: str, folder: Path, *options: str, compiler: str = "cc") -> Path:
    """A shared library made from `source`, which may include the generated headers."""
    suffix = ".cpp" if compiler == "c++" else ".c"
    (folder / f"source{suffix}").write_text(source)
    library = folder / "library.so"
    subprocess.run(
        [
            compiler,
            *STRICT,
            *options,
            "-fPIC",
            "-shared",
            f"-I{GENERATED}",
            "-o",
            library,
            folder / f"source{suffix}",
            "-lm",
        ],
        check=True,
        capture_output=True,
        text=True,
    )
    return library


def wrapper(name: str, functions: tuple[Function, ...]) -> str:
    """Every inline function of a header, exported under its own name."""
    lines = [f'#include "{name}.h"']
    for f in functions:
        given = [*(["0.0", "y"] if f.state else []), "p", "r"]
        lines += [
            f"void call_{f.name}(const double *y, double *r, const double *p);",
            f"void call_{f.name}(const double *y, double *r, const double *p)",
            f"{{ (void)y; {name}_{f.name}({', '.join(given)}); }}",
        ]
    return "\n".join(lines) + "\n"


def cases(module: ModuleType, form: str) -> list[tuple[list[float], list[float]]]:
    generator = random.Random(5)
    n = 2 * len(module.STATE)
    found = []
    for _ in range(50):
        y = [generator.uniform(-7, 7) for _ in range(n)]
        params = [generator.uniform(0.2, 3) for _ in module.PARAMETERS]
        if form != "parameters":
            equations = Form(module, form, params)
            y = equations.from_ordinary(0.0, np.array(y[: len(equations.ordinary)])).tolist()
        found.append((y, params))
    return found


def in_python(function: Callable[..., object], y: list[float], params: list[float]) -> object:
    values = {"t": 0.0, "y": y, "params": params}
    return function(*(values[name] for name in inspect.signature(function).parameters))


@pytest.mark.parametrize("standard", ["-std=c99", "-std=c17"])
def test_c_functions_give_the_bits_of_the_python_functions(
    derivation: Derivation, module: ModuleType, standard: str, tmp_path: Path
) -> None:
    functions, name = contents(derivation).functions, derivation.system.name
    library = ctypes.CDLL(str(compiled(wrapper(name, functions), tmp_path, standard)))
    for f in functions:
        for y, params in cases(module, f.form):
            result = np.empty(f.shape)
            arrays = (np.array(y), result, np.array(params))
            getattr(library, f"call_{f.name}")(*(ctypes.c_void_p(a.ctypes.data) for a in arrays))
            np.testing.assert_array_equal(result, in_python(getattr(module, f.name), y, params))


@pytest.mark.skipif(shutil.which("c++") is None, reason="needs a C++ compiler")
def test_headers_are_valid_cpp_and_two_of_them_fit_into_one_program(tmp_path: Path) -> None:
    source = """
        #include "double_pendulum.h"
        #include "single_pendulum.h"
        extern "C" double energy(const double *y, const double *p);
        extern "C" double energy(const double *y, const double *p)
        { double e; single_pendulum_energy(0.0, y, p, &e); return e; }
    """
    library = ctypes.CDLL(str(compiled(source, tmp_path, compiler="c++")))
    library.energy.restype = ctypes.c_double
    y, params = np.array([0.0, 1.0]), np.array([2.0, 3.0, 9.81])
    value = library.energy(*(ctypes.c_void_p(a.ctypes.data) for a in (y, params)))
    assert value == 0.5 * 2.0 * 9.0 - 2.0 * 9.81 * 3.0


def test_vectors_of_doubles_compute_each_lane_as_a_scalar_does(tmp_path: Path) -> None:
    import generated.double_pendulum as dp

    source = """
        typedef double lanes __attribute__((vector_size(32)));
        #define HOLONOMIC_REAL lanes
        #define HOLONOMIC_VECTOR
        #include "double_pendulum.h"
        void rates(const lanes *y, lanes *r, const lanes *p);
        void rates(const lanes *y, lanes *r, const lanes *p)
        { lanes t = {0.0}; double_pendulum_rhs_rational(t, y, p, r); }
    """
    library = ctypes.CDLL(str(compiled(source, tmp_path, "-mavx2")))
    together = cases(dp, "rational")[:4]
    y, params = (aligned(np.array(columns).T) for columns in zip(*together, strict=True))
    result = aligned(np.empty((6, 4)))
    library.rates(*(ctypes.c_void_p(a.ctypes.data) for a in (y, result, params)))
    for lane, (state, values) in enumerate(together):
        assert tuple(result[:, lane]) == dp.rhs_rational(0.0, state, values)


def aligned(array: np.ndarray) -> np.ndarray:
    """A copy that begins at a multiple of 32 bytes, as vectors of four doubles must."""
    space = np.empty(array.size + 4)
    start = (-space.ctypes.data % 32) // 8
    copy = space[start : start + array.size].reshape(array.shape)
    copy[:] = array
    return copy


def test_another_number_type_is_used_throughout(tmp_path: Path) -> None:
    source = """
        #include <tgmath.h>
        #define HOLONOMIC_REAL long double
        #include "double_pendulum.h"
        double difference(const double *y, const double *p);
        double difference(const double *y, const double *p)
        {
            long double state[4], params[5], energy;
            for (int i = 0; i < 4; ++i) state[i] = y[i];
            for (int i = 0; i < 5; ++i) params[i] = p[i];
            double_pendulum_energy(0.0L, state, params, &energy);
            return (double)(energy - (long double)(double)energy);
        }
    """
    library = ctypes.CDLL(str(compiled(source, tmp_path)))
    library.difference.restype = ctypes.c_double
    y, params = np.array([0.3, 0.4, 0.5, 0.6]), np.array([1.1, 1.2, 1.3, 1.4, 9.81])
    rest = library.difference(*(ctypes.c_void_p(a.ctypes.data) for a in (y, params)))
    assert 0 < abs(rest) < 1e-14
