"""Functions of the C code one by one, against NumPy, fractions and the reference in Python."""

import ctypes
import math
from collections.abc import Callable

import numpy as np
import pytest

from solvers.integration.compiled.compiler import build
from solvers.integration.compiled.memory_layout import source
from solvers.runge_kutta.step_control import OrderChoice

Array = np.ndarray
#: Functions of one number, of two, and their conditions, of which a mask has all bits.
ONE = ("lane_fabs", "lane_round", "lane_log2", "lane_exp2")
TWO = ("lane_copysign", "lane_fmax", "lane_fmin")
LANES = """
#define TWO(name) \\
    void test_##name(const double *, const double *, double *, int64_t); \\
    void test_##name(const double *x, const double *y, double *result, int64_t n) \\
    { \\
        for (int64_t k = 0; k < n; k += LANES) { \\
            real a, b; \\
            memcpy(&a, x + k, sizeof a); \\
            memcpy(&b, y + k, sizeof b); \\
            const real value = name(a, b); \\
            memcpy(result + k, &value, sizeof value); \\
        } \\
    }
#define FIRST(name) static inline real first_##name(real a, real b) { (void)b; return name(a); } \\
    TWO(first_##name)
static inline real smaller(real a, real b) { return select(less_than(a, b), a, b); }
static inline real is_any(real a, real b) { return splat(any(less_than(a, b))); }
static inline real root(real a, real b) { return lane_sqrt(a, less_than(b, a)); }
static inline real shifted(real a, real b) { (void)b; return as_real(shift_left(as_mask(a), 1)); }
TWO(smaller) TWO(is_any) TWO(root) TWO(shifted)
"""
LINEAR = """
#include <math.h>
int test_factorise(int, double *, int *);
int test_factorise(int n, double *matrix, int *pivots) { return factorise(n, matrix, pivots); }
void test_solve(int, const double *, const int *, double *);
void test_solve(int n, const double *factors, const int *pivots, double *x)
{
    solve(n, factors, pivots, x);
}
"""
ORDER = """
typedef struct { int stages; } Method;
enum { VARIES_ORDER = 1, METHOD_COUNT = 3 };
static const Method METHODS[METHOD_COUNT];
typedef struct { double order[1], last_order[1], contraction[1]; } State;
static inline double lane_fmin(double x, double y) { return x < y ? x : y; }
static inline double lane_fmax(double x, double y) { return x > y ? x : y; }
"""
CHOOSE = """
void test_choose(const State *, double, double, State *);
void test_choose(const State *start, double contraction, double factor, State *end)
{
    choose_order(start, contraction, factor, end);
}
void test_lower(State *);
void test_lower(State *start) { lower_order(start); }
int64_t test_methods(const State *);
int64_t test_methods(const State *start)
{
    return 10*(method_of_step(start) - METHODS) + (method_of_last_step(start) - METHODS);
}
"""


def address(array: Array) -> ctypes.c_void_p:
    return ctypes.c_void_p(array.ctypes.data)


@pytest.fixture(scope="module", params=["ONE_LANE", "SEVERAL"])
def lanes(request: pytest.FixtureRequest) -> Callable[..., Array]:
    """Functions of numbers in lanes, at two arrays of a length that is a multiple of 16."""
    extra = [f"TWO({name})" for name in TWO] + [f"FIRST({name})" for name in ONE]
    parts = [f"#define {request.param}", "#include <string.h>", source("lanes.h"), LANES, *extra]
    functions = build("\n".join(parts)).functions

    def values(name: str, x: Array, y: Array | None = None) -> Array:
        x, other = np.array(x, float), np.zeros(len(x)) if y is None else np.array(y, float)
        result = np.empty_like(x)
        call = getattr(functions, f"test_{name}")
        call(address(x), address(other), address(result), ctypes.c_int64(len(x)))
        return result

    return values


def test_lanes_compute_what_numpy_computes(lanes: Callable[..., Array]) -> None:
    random = np.random.default_rng(1)
    x, y = random.normal(size=(2, 64)) * 10.0 ** random.integers(-3, 4, (2, 64))
    x[:6] = [0.0, -0.0, 1.5, 2.5, -2.5, 7.0]
    y[:6] = [-0.0, 3.0, -1.0, 2.5, -2.5, -7.0]
    assert np.array_equal(lanes("first_lane_fabs", x), np.abs(x))
    assert not np.signbit(lanes("first_lane_fabs", x)).any()
    assert np.array_equal(lanes("first_lane_round", x), np.rint(x))
    assert np.array_equal(lanes("lane_copysign", x, y), np.copysign(x, y))
    assert np.array_equal(lanes("lane_fmax", x, y), np.maximum(x, y))
    assert np.array_equal(lanes("lane_fmin", x, y), np.minimum(x, y))
    assert np.array_equal(lanes("smaller", x, y), np.minimum(x, y))
    with np.errstate(invalid="ignore"):
        assert np.array_equal(lanes("root", x, 0 * y), np.where(x > 0, np.sqrt(x), x))
    bits = x.view(np.uint64) << np.uint64(1)
    assert np.array_equal(lanes("shifted", x).view(np.uint64), bits)
    for place in range(16):  # a condition in a single lane, or in none
        one = np.where(np.arange(16) == place, -1.0, 1.0)
        assert lanes("is_any", one, 0 * one)[place] == 1.0
    assert not lanes("is_any", np.ones(16), np.ones(16)).any()
    # y < x ? x : y, so that a second argument that is NaN remains, but not a first one
    for name in ("lane_fmax", "lane_fmin"):
        assert np.isnan(lanes(name, np.ones(16), np.full(16, np.nan))).all()
        assert (lanes(name, np.full(16, np.nan), np.ones(16)) == 1).all()


def test_logarithms_and_powers_have_the_stated_errors(lanes: Callable[..., Array]) -> None:
    random = np.random.default_rng(2)
    x = 2.0 ** np.concatenate([random.uniform(-1000, 1000, 64), np.linspace(-1, 1, 64)])
    x[:4] = [1.0, 2.0, math.sqrt(0.5), math.sqrt(2.0)]
    assert np.abs(lanes("first_lane_log2", x) - np.log2(x)).max() < 1e-7
    y = np.concatenate([random.uniform(-1000, 1000, 64), np.linspace(-1, 1, 64)])
    y[:4] = [0.0, 1.0, -1.0, 0.5]
    assert np.abs(lanes("first_lane_exp2", y) / np.exp2(y) - 1).max() < 1e-8


@pytest.mark.parametrize("n", [1, 2, 3, 5])
def test_linear_equations_are_solved_to_rounding_with_any_pivots(n: int) -> None:
    functions = build("\n".join([LINEAR.partition("\n")[0], source("linear.h"), LINEAR])).functions
    random = np.random.default_rng(n)
    for case in range(60):
        matrix, x = random.normal(size=(n, n)), random.normal(size=n)
        matrix += np.diag(np.sign(np.diag(matrix)))
        if n > 1 and case % 2:  # rows in any order, and pivots that are nearly or exactly 0
            matrix = matrix[random.permutation(n)]
            matrix[random.integers(n), random.integers(n)] = case % 4 // 2 * 1e-18
        if np.linalg.cond(matrix) > 1e4:
            continue
        pivots, right, factors = np.zeros(n, np.int32), matrix @ x, matrix.copy()
        assert functions.test_factorise(n, address(factors), address(pivots)) == 1
        functions.test_solve(n, address(factors), address(pivots), address(right))
        assert right == pytest.approx(x, abs=1e-11)
        # each pivot is the largest of its column: no factor exceeds 1
        assert np.abs(np.tril(factors, -1)).max(initial=0.0) <= 1.0
    singular = np.outer(np.arange(1.0, n + 1), np.ones(n)) * (n > 1)
    pivots = np.zeros(n, np.int32)
    assert functions.test_factorise(n, address(singular), address(pivots)) == 0


def test_orders_are_chosen_as_by_the_reference() -> None:
    parts = ("#include <stdint.h>", ORDER, source("order_choice.h"), CHOOSE)
    functions, random = build("\n".join(parts)).functions, np.random.default_rng(3)
    reference, state, changes = OrderChoice(3), np.zeros(3), set()
    for _ in range(2000):
        contraction = float(random.choice([1e-4, 1.9e-3, 2.1e-3, 0.1, 0.79, 0.81]))
        factor = float(random.choice([1.0, 0.79, 0.81, 1.19, 1.21], p=[0.6, *[0.1] * 4]))
        calm = random.random() < 0.8
        contraction = 1e-4 if calm else contraction
        end, before = np.empty(3), reference.index
        functions.test_choose(
            address(state), ctypes.c_double(contraction), ctypes.c_double(factor), address(end)
        )
        reference.advance(contraction, factor)
        assert (end[0], end[1]) == (reference.index, reference.last)
        assert functions.test_methods(address(end)) == 10 * reference.index + reference.last
        changes.add((before, reference.index))
        state = end
    for order, last in ((0.0, 2.0), (1.0, 0.0), (2.0, 1.0)):
        rejected = np.array([order, last, 0.3])
        functions.test_lower(address(rejected))
        assert rejected.tolist() == [min(order + 1, 2), last, 0.3]
    assert changes == {(a, b) for a in range(3) for b in range(3) if abs(a - b) <= 1}
