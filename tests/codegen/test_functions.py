"""Functions of formulas have their values and derivatives in every generated language."""

import ctypes
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from mpmath import mp, mpf

from derive.verification.documents.letters.hints import hints
from derive.verification.hand_derivation_files import judge
from derive.verification.source_files import judge_file
from solvers.app.modules import load
from solvers.equations.module import GeneratedModule
from solvers.integration.compiled.extended import integrate_extended
from solvers.integration.compiled.native import NativeRhs, equations, native_rhs
from solvers.integration.ensemble import ensemble
from solvers.integration.integrate import integrate
from solvers.integration.problem.status import Status
from solvers.references.taylor import SeriesError, taylor
from solvers.runge_kutta.order_conditions import order

SYSTEM = """
potential = "0"
[coordinates]
x = {{ unit = "m" }}
[parameters]
a = {{ value = 0.7 }}
p = {{ value = 2.3, positive = true }}
[forces]
x = "{}"
[[masses]]
mass = "1"
position = ["x", "0"]
"""

Real = Callable[[mpf, mpf, mpf, mpf], mpf]
#: Forces of (x, v, a, p), as text of a file and in the arithmetic of mpmath.
FORCES: dict[str, Real] = {
    "tanh(3*x) - sinh(v)": lambda x, v, a, p: mp.tanh(3 * x) - mp.sinh(v),
    "cosh(x*v)": lambda x, v, a, p: mp.cosh(x * v),
    "atan(x/a)": lambda x, v, a, p: mp.atan(x / a),
    "atan2(v, x)": lambda x, v, a, p: mp.atan2(v, x),
    "sqrt(x**2 + a)": lambda x, v, a, p: mp.sqrt(x**2 + a),
    "(1 + x**2)**(5/3)": lambda x, v, a, p: mp.cbrt(1 + x**2) ** 5,
    "(1 + x**2)**p": lambda x, v, a, p: (1 + x**2) ** p,
    "(1 + v**2)**x": lambda x, v, a, p: (1 + v**2) ** x,
    "-abs(x)**p*sign(x)": lambda x, v, a, p: -mp.sign(x) * abs(x) ** p,
    "abs(x*v - a)": lambda x, v, a, p: abs(x * v - a),
    "-a*sign(v) - x": lambda x, v, a, p: -a * mp.sign(v) - x,
    "-max(0, x - a)": lambda x, v, a, p: -max(mpf(0), x - a),
    "max(x, v, a*x)*x": lambda x, v, a, p: max(x, v, a * x) * x,
    "min(max(-3*x, -a), a)": lambda x, v, a, p: min(max(-3 * x, -a), a),
    "-max(0, x)**1.5": lambda x, v, a, p: -(max(mpf(0), x) ** mpf("1.5")),
    "Piecewise((log(x), x > a), (sqrt(a - x)/(x - a), x < a), (1, True))": lambda x, v, a, p: (
        mp.log(x) if x > a else mp.sqrt(a - x) / (x - a) if x < a else mpf(1)
    ),
    "Piecewise((-v, x <= v), (exp(x**3), x*v < 0), (x, True))": lambda x, v, a, p: (
        -v if x <= v else mp.exp(x**3) if x * v < 0 else x
    ),
}
STATES = np.random.default_rng(3).uniform(-2, 2, (40, 2))
DEFAULTS = (0.7, 2.3)


def module_of(force: str, folder: Path) -> GeneratedModule:
    path = folder / "probe.toml"
    path.write_text(SYSTEM.format(force.replace("v", "x_dot")))
    return load(str(path))


def in_c(rhs: NativeRhs, module: GeneratedModule, y: np.ndarray) -> float:
    rates = np.empty(2)
    arrays = (y, rates, np.array(module.DEFAULTS))
    rhs.function(0.0, *(ctypes.c_void_p(array.ctypes.data) for array in arrays))
    return float(rates[1])


@pytest.mark.long("more cases of the same kind", keep=8)
@pytest.mark.parametrize("force", FORCES)
def test_values_and_derivatives_are_those_of_fifty_digits(force: str, tmp_path: Path) -> None:
    module, exact = module_of(force, tmp_path), FORCES[force]
    many = module.rhs_many(0.0, STATES.T, DEFAULTS)[1]
    compiled = native_rhs(module, reproducible=True)
    jacobians = module.jacobian_many(0.0, STATES.T, DEFAULTS)[1]
    for k, y in enumerate(STATES):
        with mp.workdps(50):
            x, v, *parameters = (mpf(float(number)) for number in (*y, *DEFAULTS))
            value = float(exact(x, v, *parameters))
            h, state = mpf("1e-20"), np.array([x, v])
            steps = h * np.eye(2, dtype=object)
            slopes = [
                float(
                    (exact(*(state + s), *parameters) - exact(*(state - s), *parameters)) / (2 * h)
                )
                for s in steps
            ]
        rate = module.rhs(0.0, y, DEFAULTS)[1]
        assert rate == pytest.approx(value, rel=2e-14, abs=1e-300)
        assert many[k] == pytest.approx(value, rel=2e-14, abs=1e-300)
        assert in_c(compiled, module, y) == rate
        assert module.jacobian(0.0, y, DEFAULTS)[1] == pytest.approx(slopes, rel=1e-13, abs=1e-13)
        assert jacobians[:, k] == pytest.approx(slopes, rel=1e-13, abs=1e-13)


SPRING = "-max(0, x - a)*20 - sin(x)"  # a bumper behind a
SMOOTH = "-tanh(3*x) - atan2(x, 2)**3 - (1 + x**2)**p/9 - cosh(x/3) + sinh(x_dot/9)"


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize("force", ["-max(0, x - a)*20 - x", SPRING, SMOOTH])
@pytest.mark.filterwarnings("ignore::solvers.integration.checks.predictability.UnfinishedWarning")
def test_all_loops_agree(force: str, tmp_path: Path) -> None:
    module = module_of(force.replace("x_dot", "v"), tmp_path)
    calls_library = force != "-max(0, x - a)*20 - x"
    assert equations(module, "lagrangian").vectorises != calls_library
    starts = np.stack([np.linspace(-1, 1, 21), np.linspace(0, 1, 21)])
    motions = ensemble(module, (0, 3), starts, DEFAULTS, rtol=1e-11)
    assert "compiled" in motions.run
    for method, form in (("verner98", "hamiltonian"), ("gauss8", None), ("radau5", None)):
        options = {"method": method, "form": form, "rtol": 1e-11, "atol": 1e-13}
        one = integrate(module, (0, 3), starts[:, 7], DEFAULTS, **options)
        assert one.backend == ("python" if method == "gauss8" and "max" in force else "compiled")
        assert one.y[:, -1] == pytest.approx(motions.y[:, 7], abs=1e-8)
    python = integrate(module, (0, 3), starts[:, 7], DEFAULTS, backend="python", rtol=1e-11)
    assert python.y[:, -1] == pytest.approx(motions.y[:, 7], abs=1e-8)


def test_series_and_long_numbers_have_more_digits(tmp_path: Path) -> None:
    module = module_of(SMOOTH, tmp_path)
    exact = taylor(module, DEFAULTS, (0.3, 0.2), [0, 1, 2], digits=32)
    for name in ("long double", "quadruple"):
        end = integrate_extended(module, DEFAULTS, (0.3, 0.2), [0, 1, 2], name, 1e-17)
        assert abs(end - exact).max() < 4e-16
    double = integrate(module, (0, 2), (0.3, 0.2), DEFAULTS, rtol=1e-13, atol=1e-14)
    assert abs(double.y[:, -1] - exact[-1]).max() < 1e-12


def test_series_end_at_a_kink(tmp_path: Path) -> None:
    module = module_of("-abs(x)", tmp_path)
    assert taylor(module, DEFAULTS, (1.0, 0.0), [0, 1])[1, 0] == pytest.approx(np.cos(1), rel=1e-15)
    with pytest.raises(SeriesError, match="a kink or a jump in the next step"):
        taylor(module, DEFAULTS, (1.0, 0.0), [0, 2])


@pytest.mark.long("more cases of the same kind", keep=2, daily=12)
@pytest.mark.parametrize("backend", ["python", "compiled"])
@pytest.mark.parametrize("method", ["verner98", "gauss8", "radau3"])
@pytest.mark.parametrize(
    ("force", "x"),
    [("sqrt(x)", -1.0), ("x**1.3", -1.0), ("max(sqrt(x), 1)", -1.0), ("x**(-p)", 0.0)],
)
@pytest.mark.filterwarnings("ignore::solvers.integration.checks.predictability.UnfinishedWarning")
def test_states_outside_of_the_domain_have_a_status(
    force: str, x: float, method: str, backend: str, tmp_path: Path
) -> None:
    backend = "python" if "max" in force and method == "gauss8" else backend
    module, options = module_of(force, tmp_path), {"method": method, "backend": backend}
    motion = integrate(module, (0, 1), (x, 0.0), DEFAULTS, **options)
    assert motion.status is Status.NOT_FINITE
    assert np.isfinite(motion.y).all()


def test_energy_is_kept_in_potentials_with_roots_and_powers(tmp_path: Path) -> None:
    text = SYSTEM.format("0").replace('"0"', '"sqrt(1 + x**2) + cosh(x) + (x**2 + a)**p"', 1)
    (tmp_path / "kept.toml").write_text(text)
    module = load(str(tmp_path / "kept.toml"))
    motion = integrate(module, (0, 50), (3.0, 0.0), DEFAULTS, rtol=1e-12, atol=1e-13, energy=True)
    assert abs(motion.energy / motion.energy[0] - 1).max() < 1e-10


def test_a_hand_derivation_with_kinks_is_judged(tmp_path: Path) -> None:
    file = tmp_path / "stop.toml"
    text = SYSTEM.format("-a*sign(x_dot)")
    file.write_text(text.replace('"0"', '"max(0, x - 9*a)**2 + a*abs(x)**p"', 1))
    slope = "2*max(0, x - 9*a)"
    right = f"x_ddot + a*sign(x_dot) + {slope} + a*p*abs(x)**(p - 1)*sign(x) = 0"
    wrong = {
        right: "verified",
        right.replace("2*max", "max"): "wrong",
        right.replace("max", "min"): "wrong",
        right.replace("sign(x_dot)", "abs(x_dot)"): "wrong",
        right.replace(slope, "0"): "wrong",
    }
    for equation, verdict in wrong.items():
        hand = tmp_path / "hand.toml"
        hand.write_text(f'system = "{file}"\neuler_lagrange = ["{equation}"]\n')
        (one,) = judge(hand).equations
        assert one.verdict == verdict, (equation, one)


def test_names_of_functions_are_reserved(tmp_path: Path) -> None:
    for name in ("max", "abs", "select", "pow", "tanh"):
        text = SYSTEM.format("0").replace("a = ", f"{name} = ")
        (tmp_path / "named.toml").write_text(text)
        with pytest.raises(ValueError, match=f"{name!r} cannot be a name"):
            load(str(tmp_path / "named.toml"))


@pytest.mark.long("other tests reach its code")
def test_documents_with_kinks_are_judged(tmp_path: Path) -> None:
    file, document = tmp_path / "stop.toml", tmp_path / "stop.md"
    stop = SYSTEM.replace("a = {{ value = 0.7 }}", "F = {{ value = 1.0, unit = 'N' }}")
    stop = stop.replace(
        "p = {{ value = 2.3, positive", "k = {{ value = 2.0, unit = 'N/m', positive"
    )
    file.write_text(stop.format("-F*sign(x_dot) - k*max(0, x - 1)"))
    equation = r"\ddot x + F\operatorname{{sgn}}(\dot x) + k{}(0, x - 1) = 0"
    wrong = {
        equation.format(r"\max"): "verified",
        equation.format(r"\operatorname{Max}"): "verified",
        equation.format(r"\min"): "wrong",
        equation.format(r"\max").replace("sgn", "sign"): "verified",
        equation.format(r"\max").replace("- 1", "+ 1"): "wrong",
    }
    for formula, verdict in wrong.items():
        document.write_text(f"$${formula}$$\n")
        (judged,) = judge_file(str(document), order, hints(str(file), None))[0].formulas
        assert judged.verdict == verdict, (formula, judged)
    # without the system, the forces are those of a document with terms that have no meaning
    document.write_text("A point mass $m$.\n\n$$m\\ddot x = -(k x + F\\max(0, x))$$\n")
    assert judge_file(str(document), order)[0].formulas
