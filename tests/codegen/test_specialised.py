"""Code for one scene: folded parameters, required functions only, the same motion."""

import subprocess
import sys
from fractions import Fraction
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from folders import ROOT
from mpmath import mp, mpf
from sympy import symbols

import generated.double_pendulum as dp
import generated.elastic_pendulum as ep
import generated.four_bar as four_bar
import generated.single_pendulum as sp
from derive import Derivation, load
from derive.codegen.forms.lagrangian_form import LagrangianForm
from derive.codegen.module_files import texts
from derive.codegen.module_functions import contents
from derive.codegen.operations.assignments import LanguageNotation
from derive.mechanics.specialisation import specialised as folded
from derive.system.parts import Coordinate, Parameter, PointMass, SystemDefinitionError
from derive.system.system import System
from solvers.app.modules import generator_text, required_functions, specialiser
from solvers.equations.consistent_start import consistent_start
from solvers.equations.module_cache import specialised_module
from solvers.integration.accuracy.method_choice import MethodChoice
from solvers.integration.checks.predictability import ignore_predictability
from solvers.integration.integrate import integrate
from solvers.io.build_cache import cache_folder

REPORT = (np.pi / 2, np.pi, 0.0, 0.0)


@pytest.fixture(autouse=True)
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))


def operations(name: str, function: str, **values: float) -> int:
    """What a call costs, without terms of the parameters alone."""
    (found,) = contents(Derivation(folded(load(name), values)), [function]).functions
    total, constant = found.lowering.cost
    return total - constant


@pytest.mark.parametrize(
    ("module", "params"),
    [
        (dp, dp.DEFAULTS),
        (dp, (1.3, 0.7, 1.1, 0.9, 9.81)),
        (dp, (1.0, 3.0, 2.0, 0.5, 0.0)),
        (sp, sp.DEFAULTS),
        (ep, ep.DEFAULTS),
        (ep, (0.7, 33.3, 1.21, 0.0)),
    ],
)
@pytest.mark.parametrize("form", ["lagrangian", "hamiltonian", "rational"])
def test_specialised_code_has_the_same_values(
    module: ModuleType, params: tuple[float, ...], form: str
) -> None:
    special = specialiser(module, params, MethodChoice("verner853", form, ""))
    suffix = "" if form == "lagrangian" else f"_{form}"
    states = np.random.default_rng(4).uniform(0.2, 2.0, (20, len(module.STATE)))
    if form == "rational":
        states = np.array([module.rational_state(0.0, y, params) for y in states.tolist()])
    for y in states.tolist():
        general = getattr(module, f"rhs{suffix}")(0.0, y, params)
        found = getattr(special, f"rhs{suffix}")(0.0, y, ())
        assert found == pytest.approx(general, rel=1e-12, abs=1e-13)
    assert special.PARAMETERS == ()


def test_folded_numbers_are_exact_and_rounded_once() -> None:
    y = (1.0, 2.0, 0.5, -0.3)
    with mp.workdps(40):
        exact = [mpf(x) for x in ("1.3", "0.7", "1.1", "0.9", "9.81")]
        # the same equations with numbers of 40 digits: the rational form calls no function
        rational = dp.rational_state(0.0, y, dp.DEFAULTS)
        fine = dp.rhs_rational(0, [mpf(x) for x in rational], exact)
        found = specialiser(
            dp, (1.3, 0.7, 1.1, 0.9, 9.81), MethodChoice("verner853", "rational", "")
        )
        coarse = found.rhs_rational(0, rational, ())
        assert max(abs(a - b) for a, b in zip(fine, coarse, strict=True)) < 4e-15


def test_a_folded_number_is_written_so_that_it_is_rounded_once() -> None:
    literal = LanguageNotation().literal
    assert literal(Fraction(981, 100)) == "(981.0/100.0)"  # as exact as the type that reads it
    long = Fraction(1234567890123457581, 1000000000000010473)
    assert float(literal(long)) == float(long)
    assert float(long.numerator) / float(long.denominator) != float(long)


def test_a_force_that_is_a_number_is_one_even_where_masses_have_a_common_factor() -> None:
    y, m, g = symbols("y m g", real=True)
    falling = System(
        name="falling",
        title="A mass that falls",
        coordinates=[Coordinate(y, "m", "height")],
        parameters=[Parameter(m, "kg", 2.0, "mass"), Parameter(g, "m/s^2", 9.81, "gravity")],
        masses=[PointMass(m, (y * 0, y))],
    )
    special = folded(falling, {"m": 4.0, "g": 9.81})
    (rate, acceleration) = LagrangianForm(Derivation(special)).rhs
    assert acceleration.is_number(Fraction(-981, 100))
    assert not rate.is_number(0)


def test_a_changed_system_is_generated_anew() -> None:
    text = generator_text()
    for name in ("systems/double_pendulum.py", "codegen/expression_graph/graph.py"):
        assert (ROOT / "derive" / name).read_text() in text


def test_the_generator_s_text_is_that_of_all_modules_that_a_generation_imports() -> None:
    code = (
        "import sys\nfrom derive import Derivation, System, load, reduced\n"
        "from derive.codegen.module_functions import Functions\n"
        "from derive.codegen.module_files import texts\n"
        "from derive.mechanics.specialisation import specialised\n"
        "texts(Derivation(specialised(reduced(load('rotating_hoop')), {'g': 1.0})), ('rhs',))\n"
        "print(*(m.__file__ for n, m in sys.modules.items() if n.startswith('derive.')), sep='\\n')"
    )
    printed = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, check=True, text=True
    )
    loaded = [path for path in printed.stdout.splitlines() if path != "None"]
    text = generator_text()
    assert len(loaded) > 30
    assert [path for path in loaded if Path(path).read_text() not in text] == []
    for name in ("verification/documents/pages/verdict_page.py", "reading/latex/grammar/build.py"):
        assert (ROOT / "derive" / name).read_text() not in text


def test_folded_parameters_cost_nothing_and_zeros_vanish() -> None:
    plain = {"m1": 1.0, "m2": 1.0, "l1": 2.0, "l2": 2.0, "g": 9.81}
    general = operations("double_pendulum", "rhs_rational")
    any_values = operations(
        "double_pendulum", "rhs_rational", m1=1.3, m2=0.7, l1=1.1, l2=0.9, g=9.81
    )
    equal = operations("double_pendulum", "rhs_rational", **plain)
    weightless = operations("double_pendulum", "rhs_rational", **{**plain, "g": 0.0})
    costs = [general, any_values, equal, weightless]
    assert costs == [34, 34, 29, 24]
    # a part may stay open
    assert operations("double_pendulum", "rhs", g=0.0) < operations("double_pendulum", "rhs")
    with pytest.raises(SystemDefinitionError, match="no parameter 'm3'; known are m1, m2"):
        folded(load("double_pendulum"), {"m3": 1.0})


def test_only_functions_that_a_scene_needs_exist() -> None:
    assert required_functions("verner853", "rational") == ("rhs_rational",)
    assert required_functions("gauss2", "lagrangian") == ("rhs", "jacobian")
    assert required_functions("radau3", "hamiltonian")[-1] == "jacobian_hamiltonian"
    assert required_functions("LSODA", "lagrangian") == ("rhs",)
    special = specialiser(dp, dp.DEFAULTS, MethodChoice("verner853", "rational", ""))
    functions = {name for name in vars(special) if callable(getattr(special, name))}
    assert {f for f in functions if f.startswith("rhs")} == {"rhs_rational", "rhs_rational_many"}
    assert not any("jacobian" in f or "energy" in f or "positions" in f for f in functions)


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize(
    ("method", "form", "h"),
    [
        ("verner853", "rational", None),
        ("dop853", "hamiltonian", None),
        ("gauss2", "lagrangian", 1e-3),
    ],
)
def test_a_specialised_motion_equals_the_general_one(
    method: str, form: str, h: float | None
) -> None:
    special = specialiser(dp, dp.DEFAULTS, MethodChoice(method, form, ""))
    ends = [
        integrate(
            module, (0, 5), REPORT, params, method=method, form=form, h=h, rtol=1e-12, t_eval=[5]
        ).y[:, -1]
        for module, params in ((special, ()), (dp, dp.DEFAULTS))
    ]
    assert ends[0] == pytest.approx(ends[1], abs=1e-9)


@pytest.mark.long("more cases of the same kind", keep=2)
@pytest.mark.parametrize(
    ("method", "form", "h"), [("verner853", "rational", None), ("gauss2", "lagrangian", 1e-2)]
)
@pytest.mark.parametrize("backend", ["python", "compiled"])
def test_specialised_motions_keep_their_constraints(
    method: str, form: str, h: float | None, backend: str
) -> None:
    special = specialiser(four_bar, four_bar.DEFAULTS, MethodChoice(method, form, ""))
    start = consistent_start(four_bar, {"phi": 1.0}, {}, guess={"psi": 0.5, "chi": 1.5}).y
    options = {"method": method, "form": form, "h": h, "rtol": 1e-6, "backend": backend}
    with ignore_predictability():
        end = integrate(special, (0, 5), start, (), **options).y[:, -1]
    residuals = four_bar.constraints(0.0, end, four_bar.DEFAULTS)
    assert max(map(abs, residuals[:2])) < 1e-15  # positions, in m
    assert max(map(abs, residuals[2:])) < 1e-14


def test_a_module_is_generated_once_and_again_when_damaged() -> None:
    made = []

    def generator(name, values, functions):
        made.append(name)
        return texts(Derivation(folded(load(name), values)), functions)

    def get(version: str = "1") -> ModuleType:
        return specialised_module(dp, dp.DEFAULTS, ("rhs",), generator, version)

    first, second = get(), get()
    assert first.rhs(0.0, REPORT, ()) == second.rhs(0.0, REPORT, ())
    assert len(made) == 1
    get("another version of the generator")
    assert len(made) == 2
    place = Path(first.__file__ or "")
    text = place.read_text()
    place.write_text(text.replace("def rhs(", "import os; os.abort()\ndef rhs("))
    assert get().rhs(0.0, REPORT, ()) == first.rhs(0.0, REPORT, ())
    assert len(made) == 3
    assert place.read_text() == text
    assert not list(place.parent.glob("__pycache__"))
    (place.parent / f"{place.stem}.h").unlink()
    get()
    assert len(made) == 4
    assert {path.name.split("-")[0] for path in (cache_folder()).iterdir()} == {"module"}
