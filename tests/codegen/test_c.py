"""C headers: they compile without a warning and give the Python functions' bits."""

import ctypes
import inspect
import random
import re
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
import sympy as sp
from folders import ROOT
from mpmath import mpf, workdps

from derive import Coordinate, Derivation, Parameter, PointMass, System, load, names, write
from derive.codegen.module_files import texts
from derive.codegen.module_functions import Function, contents
from solvers.equations.forms import Form
from solvers.equations.module import parameter_names

GENERATED = ROOT / "generated"
STRICT = ["-O2", "-Wall", "-Wextra", "-Wconversion", "-Werror", "-pedantic", "-ffp-contract=off"]
IN_FLOAT = ["-Wdouble-promotion", "-Wfloat-conversion"]

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
        params = [generator.uniform(0.2, 3) for _ in parameter_names(module, form)]
        if form != "parameters":
            equations = Form(module, form, params)
            y = equations.from_ordinary(0.0, np.array(y[: len(equations.ordinary)])).tolist()
        found.append((y, params))
    return found


def in_python(function: Callable[..., object], y: list[float], params: list[float]) -> object:
    values = {"t": 0.0, "y": y, "params": params}
    return function(*(values[name] for name in inspect.signature(function).parameters))


@pytest.mark.long("more cases of the same kind", keep=3)
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


LANES = """
    typedef {real} lanes __attribute__((vector_size(32)));
    #define HOLONOMIC_REAL lanes
    #define HOLONOMIC_VECTOR
    #include "double_pendulum.h"
    #if __cplusplus
    extern "C"
    #endif
    void rates(const lanes *y, lanes *r, const lanes *p);
    void rates(const lanes *y, lanes *r, const lanes *p)
    {{ lanes t = {{0}}; double_pendulum_rhs_rational(t, y, p, r); }}
"""


@pytest.mark.parametrize("compiler", ["cc", "c++"])
@pytest.mark.parametrize("real", ["double", "float"])
def test_vectors_compute_each_lane_as_a_scalar_does(
    real: str, compiler: str, tmp_path: Path
) -> None:
    import generated.double_pendulum as dp

    if shutil.which(compiler) is None:
        pytest.skip(f"needs {compiler}")
    source = LANES.format(real=real)
    library = ctypes.CDLL(str(compiled(source, tmp_path, "-mavx2", *IN_FLOAT, compiler=compiler)))
    dtype = np.dtype("f8" if real == "double" else "f4")
    count = 32 // dtype.itemsize
    together = cases(dp, "rational")[:count]
    y, params = (aligned(np.array(columns, dtype).T) for columns in zip(*together, strict=True))
    result = aligned(np.empty((6, count), dtype))
    library.rates(*(ctypes.c_void_p(a.ctypes.data) for a in (y, result, params)))
    for lane, (state, values) in enumerate(together):
        rates = dp.rhs_rational(0.0, state, values)
        if real == "double":
            assert tuple(result[:, lane]) == rates
        else:
            np.testing.assert_allclose(result[:, lane], rates, rtol=1e-3)


def aligned(array: np.ndarray) -> np.ndarray:
    """A copy that begins at a multiple of 32 bytes, as vectors of this size must."""
    space = np.empty(array.size + 8, array.dtype)
    start = (-space.ctypes.data % 32) // array.itemsize
    copy = space[start : start + array.size].reshape(array.shape)
    copy[:] = array
    return copy


#: Literals and functions of a type that is not in C99.
QUADRUPLE = """
    #define HOLONOMIC_LITERAL(x) x##Q
    #define HOLONOMIC_CALL(name) name##f128
    __float128 cosf128(__float128), sinf128(__float128), sqrtf128(__float128);
"""
OTHER_TYPE = """
    #define HOLONOMIC_REAL {real}
    {more}
    #include "rod.h"
    void energy(const double *y, const double *p, double *r);
    void energy(const double *y, const double *p, double *r)
    {{
        {real} state[2], params[3], result;
        for (int i = 0; i < 2; ++i) state[i] = ({real})y[i];
        for (int i = 0; i < 3; ++i) params[i] = ({real})p[i];
        rod_energy(({real})0, state, params, &result);
        r[0] = (double)result;
        r[1] = (double)(result - ({real})r[0]);
        r[2] = (double)(result - ({real})r[0] - ({real})r[1]);
    }}
"""


@pytest.mark.parametrize("real", ["float", "double", "long double", "__float128"])
def test_another_number_type_is_used_throughout(real: str, tmp_path: Path) -> None:
    # literals with fractions and pi, and functions: in double they would have errors of 1e-17
    theta, g = sp.symbols("theta g", real=True)
    m, length = sp.symbols("m l", positive=True)
    rod = System(
        name="rod",
        title="",
        coordinates=[Coordinate(theta, "rad", "")],
        parameters=[Parameter(s, "1", 1.0, "") for s in (m, length, g)],
        masses=[PointMass(m, (length * sp.sin(theta), -length * sp.cos(theta)))],
        potential=-m * g * length * sp.cos(theta) + sp.sqrt(2 + theta) * sp.pi / 7 + theta / 3,
    )
    write(rod, tmp_path)
    source = OTHER_TYPE.format(real=real, more=QUADRUPLE if real == "__float128" else "")
    options = [f"-I{tmp_path}", *(["-Wno-pedantic"] if real == "__float128" else [])]
    library = ctypes.CDLL(str(compiled(source, tmp_path, *options)))
    # exact in every type
    y, params, result = np.array([0.625, 0.75]), np.array([1.5, 1.25, 9.75]), np.empty(3)
    library.energy(*(ctypes.c_void_p(a.ctypes.data) for a in (y, params, result)))
    with workdps(50):
        symbols = (*rod.q, *rod.qdot, *rod.params)
        exact = sp.lambdify(symbols, Derivation(rod).energy, "mpmath")(*map(mpf, [*y, *params]))
        eps = {"float": 2**-23, "double": 2**-52, "long double": np.finfo(np.longdouble).eps}
        eps["__float128"] = 2**-112
        error = abs(sum(map(mpf, result)) - exact)
        assert 0 < error < 4 * float(eps[real]) * abs(exact)


SINGLE = """
    #define HOLONOMIC_REAL float
    #include "{name}.h"
    #if __cplusplus
    extern "C"
    #endif
    void rate(const float *y, const float *p, float *r);
    void rate(const float *y, const float *p, float *r)
    {{ {name}_rhs(0.0f, y, p, r); {name}_energy(0.0f, y, p, r); }}
"""


@pytest.mark.long("more cases of the same kind", keep=2, daily=24)
@pytest.mark.parametrize("compiler", ["cc", "c++"])
@pytest.mark.parametrize("name", [*names(), "chain_16"])
def test_float_computes_in_float_alone(name: str, compiler: str, tmp_path: Path) -> None:
    if shutil.which(compiler) is None:
        pytest.skip(f"needs {compiler}")
    if name == "chain_16":  # whose functions have loops
        for file, text in texts(Derivation(load(name)), ["rhs", "energy"]).items():
            (tmp_path / file).write_text(text)
    options = [*IN_FLOAT, f"-I{tmp_path}", *(["-std=c99"] if compiler == "cc" else [])]
    library = compiled(SINGLE.format(name=name), tmp_path, *options, compiler=compiler)
    called = subprocess.run(["nm", "-D", "-u", library], capture_output=True, text=True).stdout
    functions = re.findall(r"\b(?:sin|cos|sincos|sqrt)[fl]?\b", called)
    assert all(function.endswith("f") for function in functions)


def test_indices_of_parameters_and_states_have_names(module: ModuleType, tmp_path: Path) -> None:
    guard = module.SYSTEM.upper()
    arrays = {"PARAMETER": module.PARAMETERS}
    arrays |= {form.upper(): state for form, state in module.STATES.items()}
    checks = "\n".join(
        f"typedef char check_{array}_{name}[{guard}_{array}_{name} == {k} ? 1 : -1];"
        for array, components in arrays.items()
        for k, name in enumerate(components)
    )
    for compiler in filter(shutil.which, ("cc", "c++")):
        compiled(f'#include "{module.SYSTEM}.h"\n{checks}\n', tmp_path, compiler=compiler)


def test_names_that_differ_in_case_alone_have_their_own_indices(tmp_path: Path) -> None:
    source = """
        #include "swinging_atwood.h"
        typedef char first[SWINGING_ATWOOD_PARAMETER_M == 0 ? 1 : -1];
        typedef char second[SWINGING_ATWOOD_PARAMETER_m == 1 ? 1 : -1];
    """
    compiled(source, tmp_path)
