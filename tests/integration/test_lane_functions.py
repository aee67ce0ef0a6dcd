"""Functions in vector lanes: sine and cosine within an ulp, the others as the library has them."""

import ctypes
import math
from pathlib import Path

import mpmath
import numpy as np
import pytest
from numpy.testing import assert_allclose

from solvers import ensemble
from solvers.app.modules import load as load_module
from solvers.integration.compiled.compiler import build
from solvers.integration.compiled.memory_layout import source

MANY = """
void many(const double *x, double *sines, double *cosines, int64_t n);
void many(const double *x, double *sines, double *cosines, int64_t n)
{
    for (int64_t k = 0; k < n; k += LANES) {
        real angles, sine, cosine;
        memcpy(&angles, x + k, sizeof angles);
        sine = vector_sin(angles), cosine = vector_cos(angles);
        memcpy(sines + k, &sine, sizeof sine);
        memcpy(cosines + k, &cosine, sizeof cosine);
    }
}

void probe(void);
void probe(void) {}
"""
FORCE = (
    "-tan(x/3) - atan(x_dot/9) - atan2(x, 2)**3 - (1 + x**2)**p/9 + sin(3*x)*cos(x_dot)/5"
    " - tanh(3*x) - cosh(x/3) + sinh(x_dot/9) - exp(-x**2)/7 + log(2 + x**2) - sqrt(3 + x**2) - x"
)
SYSTEM = """
potential = 0
forces = {{ x = "{0}" }}
[coordinates]
x = {{ unit = "m" }}
[parameters]
p = {{ value = 0.7 }}
[[masses]]
mass = 1
position = ["x", "0"]
"""


@pytest.fixture(scope="module")
def many() -> ctypes.CDLL:
    files = map(source, ("lanes.h", "lane_functions.h"))
    text = "\n".join(["#define HOLONOMIC_VECTOR", "#include <string.h>", *files, MANY])
    return build(text).functions


def sines(many: ctypes.CDLL, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Sines and cosines of a multiple of 16 numbers."""
    results = np.empty_like(x), np.empty_like(x)
    pointers = [ctypes.c_void_p(array.ctypes.data) for array in (x, *results)]
    many.many(*pointers, ctypes.c_int64(len(x)))
    return results


@pytest.mark.parametrize("size", [0.7, 3.2, 1e3, 0.99e5, 1e9])
def test_sines_and_cosines_have_an_error_below_an_ulp(many: ctypes.CDLL, size: float) -> None:
    x = np.random.default_rng(1).uniform(-size, size, 1600)
    x[:400] = np.round(x[:400] / (np.pi / 2)) * (np.pi / 2)  # next to zeros and extremes
    with mpmath.workprec(150):
        for results, function in zip(sines(many, x), (mpmath.sin, mpmath.cos), strict=True):
            exact = [function(mpmath.mpf(value)) for value in x]
            errors = [
                abs(mpmath.mpf(result) - value) / math.ulp(float(value))
                for result, value in zip(results, exact, strict=True)
            ]
            assert max(errors) < 0.8


def test_numbers_without_a_sine_have_none(many: ctypes.CDLL) -> None:
    x = np.array([0.0, np.inf, -np.inf, np.nan] * 4)
    sine, cosine = sines(many, x)
    assert np.isnan(sine).tolist() == np.isnan(cosine).tolist() == [False, True, True, True] * 4
    assert (sine[0], cosine[0]) == (0.0, 1.0)


@pytest.mark.long("other tests reach its code")
def test_motions_in_lanes_equal_those_in_python(tmp_path: Path) -> None:
    (tmp_path / "called.toml").write_text(SYSTEM.format(FORCE))
    module = load_module(str(tmp_path / "called.toml"))
    start = np.stack([np.linspace(-1, 1, 21), np.linspace(0, 1, 21)])
    lanes, one = (
        ensemble(module, (0, 3), start, {}, rtol=1e-11, backend=backend)
        for backend in ("compiled", "python")
    )
    assert lanes.success.all()
    assert_allclose(lanes.y, one.y, atol=1e-9)
