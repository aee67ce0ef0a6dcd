"""Coefficients of every method, read back from its running compiled loop."""

import ctypes
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from handwritten import handwritten

from solvers.integration.compiled import compiler, method_source
from solvers.integration.compiled.kernel import Kernel
from solvers.integration.ensemble import ensemble
from solvers.integration.integrate import integrate
from solvers.runge_kutta.method_catalogue import load, names
from solvers.runge_kutta.parallel_stages import symplectic_ratios

EXPLICIT = [name for name in names() if load(name).is_explicit and not load(name).is_splitting]
PARALLEL = [name for name in names() if load(name).is_parallel]
IMPLICIT = [name for name in names() if load(name).needs_jacobian]

#: A right-hand side that records its arguments and returns unit vectors.
PROBE = """
double probe_states[64][64], probe_times[64];
int probe_calls;

static inline void probe_rhs(
    {real} t, const {real} *state, const {real} *params, {real} *result)
{{
    for (int n = 0; n < {stages}; n++) {{
        result[n] = ({real}){{0}} + (double)(n == probe_calls);
        if (probe_calls >= 0) {{
            probe_states[probe_calls][n] = *(const double *)&state[n];
        }}
    }}
    if (probe_calls >= 0) {{
        probe_times[probe_calls] = *(const double *)&t;
    }}
    probe_calls++;
    (void)params;
}}
"""


def probe(folder: Path, stages: int) -> ModuleType:
    """A module with one number of state a stage, and the header for it."""
    (folder / "probe.h").write_text(PROBE.format(real="HOLONOMIC_REAL", stages=stages))
    state = tuple(f"s{k}" for k in range(stages))
    return handwritten("probe", state, __file__=str(folder / "probe.py"))


@pytest.mark.long("more cases of the same kind", keep=2, daily=13)
@pytest.mark.parametrize("lanes", [False, True])
@pytest.mark.parametrize("name", EXPLICIT)
def test_coefficients_are_read_back_from_the_running_loop(
    name: str, lanes: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # a state as long as the method takes long to optimise in lanes
    flags = [flag.replace("-O3", "-O1") for flag in compiler.FLAGS]
    monkeypatch.setattr(compiler, "FLAGS", flags)
    # derivative k is the unit vector k: then the state of stage i is row i of A, and the end is b
    method = load(name)
    module, rest = probe(tmp_path, method.stages), [0.0] * method.stages
    kernel = Kernel(module, "lagrangian", name, lanes=lanes, compensated=False, reproducible=False)
    library = ctypes.CDLL(str(kernel.library.path))
    # the loop makes one call before the first step, which is the first stage of an FSAL method
    ctypes.c_int.in_dll(library, "probe_calls").value = 0 if method.is_fsal else -1
    options = {"method": name, "h": 1.0, "backend": "compiled"}
    if lanes:
        end = ensemble(module, (0, 1), np.transpose([rest]), (1.0,), workers=1, **options).y[:, 0]
    else:
        end = integrate(module, (0, 1), rest, (1.0,), **options).y[:, -1]
    states = np.array((ctypes.c_double * 64 * 64).in_dll(library, "probe_states"))
    times = np.array((ctypes.c_double * 64).in_dll(library, "probe_times"))
    stages = slice(0, method.stages)
    assert np.array_equal(states[stages, stages], np.array(method.A, float))
    assert np.array_equal(times[stages], np.array(method.c, float))
    assert np.array_equal(end, np.array(method.b, float))


IMPLICIT_PROBE = """
double probe_states[64][64];

static inline void probe_rhs(double t, const double *state, const double *params, double *result)
{{
    static const double nodes[] = {{{nodes}}};
    for (int i = 0; i < {stages}; i++) {{
        result[i] = t == nodes[i];
        for (int n = 0; n < {stages} && t == nodes[i]; n++) {{
            probe_states[i][n] = state[n];
        }}
    }}
    (void)params;
}}

static inline void probe_jacobian(
    double t, const double *state, const double *params, double *result)
{{
    for (int n = 0; n < {stages}*{stages}; n++) {{
        result[n] = 0;
    }}
    (void)t; (void)state; (void)params;
}}
"""

PARALLEL_PROBE = """
double probe_states[64][64], probe_times[64];

static inline void probe_rhs(
    stage_vector t, const stage_vector *state, const stage_vector *params, stage_vector *result)
{{
    for (int n = 0; n < {stages}; n++) {{
        for (int i = 0; i < {stages}; i++) {{
            result[n][i] = n == i;
            probe_states[i][n] = state[n][i];
            probe_times[i] = t[i];
        }}
    }}
    (void)params;
}}
"""


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize("name", PARALLEL)
def test_coefficients_of_parallel_stages_are_read_back_from_the_running_loop(
    name: str, tmp_path: Path
) -> None:
    # as above, in lanes: the ratios to the weights are rounded, such that the method is symplectic
    method = load(name)
    module, rest = probe(tmp_path, method.stages), [0.0] * method.stages
    (tmp_path / "probe.h").write_text(PARALLEL_PROBE.format(stages=method.stages))
    kernel = Kernel(module, "lagrangian", name, lanes=False, compensated=False, reproducible=False)
    library = ctypes.CDLL(str(kernel.library.path))
    solution = integrate(module, (0, 1), rest, (1.0,), method=name, h=1.0, backend="compiled")
    states = np.array((ctypes.c_double * 64 * 64).in_dll(library, "probe_states"))
    times = np.array((ctypes.c_double * 64).in_dll(library, "probe_times"))
    stages, weights = slice(0, method.stages), np.array(method.b, float)
    assert np.array_equal(states[stages, stages], symplectic_ratios(method) * weights)
    assert np.abs(states[stages, stages] - np.array(method.A, float)).max() < 1e-16
    assert np.array_equal(times[stages], np.array(method.c, float))
    assert np.array_equal(solution.y[:, -1], weights)


@pytest.mark.long("more cases of the same kind", keep=2)
@pytest.mark.parametrize("name", IMPLICIT)
def test_coefficients_of_implicit_methods_are_read_back_from_the_running_loop(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # as above; the time identifies the stage, and the values of the last iteration are read, when
    # the derivatives no longer change: the first ones are rounded on the way to the blocks and back
    source = method_source.source
    exact = ("CLOSE = 1e-14", "CLOSE = 0.0")
    assert exact[0] in source("simplified_newton.h")
    monkeypatch.setattr(method_source, "source", lambda file: source(file).replace(*exact))
    method = load(name)
    module, rest = probe(tmp_path, method.stages), [0.0] * method.stages
    module.OPERATIONS["jacobian"] = (0, 0)
    module.jacobian = lambda t, y, params: np.zeros((method.stages, method.stages))
    nodes = ", ".join(repr(float(c)) for c in method.c)
    text = IMPLICIT_PROBE.format(nodes=nodes, stages=method.stages)
    (tmp_path / "probe.h").write_text(text)
    kernel = Kernel(module, "lagrangian", name, lanes=False, compensated=False, reproducible=False)
    library = ctypes.CDLL(str(kernel.library.path))
    solution = integrate(module, (0, 1), rest, (1.0,), method=name, h=1.0, backend="compiled")
    states = np.array((ctypes.c_double * 64 * 64).in_dll(library, "probe_states"))
    stages = slice(0, method.stages)
    assert np.array_equal(states[stages, stages], np.array(method.A, float))
    assert np.array_equal(solution.y[:, -1], np.array(method.b, float))
    assert solution.success
