"""What solvers know about each system that ships, by its module."""

from importlib import import_module

import numpy as np
from evaluated import evaluated
from recording import Record

import generated
from solvers.equations import consistent_start, energy, forms, module, number_checks, singularities
from solvers.equations.linearisation import intervals, linear_system, normal_modes

EXPRESSIONS = """
{m.SYSTEM: title(m) for m in some}
{m.SYSTEM: coupling(m) for m in all_modules}
{m.SYSTEM: conserves_energy(m) for m in all_modules}
{m.SYSTEM: fastest_form(m) for m in all_modules}
{m.SYSTEM: energy_at_rest(m, m.DEFAULTS) for m in all_modules}
{m.SYSTEM: energy_unit(m, m.DEFAULTS, 1.0) for m in all_modules}
{m.SYSTEM: mode_spread(m, m.DEFAULTS) for m in all_modules}
{m.SYSTEM: (position_constraints(m), inputs(m), outputs(m), integrals(m)) for m in all_modules}
{m.SYSTEM: [named("rhs", form) for form in m.FORMS] for m in some}
{m.SYSTEM: [operations_on_state(m, named("rhs", form)) for form in m.FORMS] for m in all_modules}
{m.SYSTEM: equations_of_motion(m) for m in some}
{m.SYSTEM: [depends_on_time(m), has_constraints(m), has_header(m)] for m in all_modules}
[parameter_names(dp, form) for form in dp.FORMS]
[state_names(dp, form) for form in dp.FORMS]
Modes.at_rest(dp, dp.DEFAULTS).frequencies
Modes.at_rest(dp, dp.DEFAULTS).matrix
Modes.at_rest(dp, dp.DEFAULTS).size(np.array([0.1, 0.2, 0.3, 0.4]))
Modes.at_rest(dp, (1.0, 1.0, 2.0, 2.0, 0.0))
Modes.at_rest(driven, driven.DEFAULTS)
np.sort(local_eigenvalues(dp, dp.DEFAULTS, np.array([[0.1, 0.2, 0, 0], [3, 0.1, 0, 0]])).imag)
energy_error(dp, dp.DEFAULTS, [-50.0, -49.0, -51.0])
energy_error(dp, dp.DEFAULTS, [-70.0, -69.0])
quantity(dp, "m2", [1.0, 0.0, -1.0])
quantity(dp, "m2", "1 kg")
quantity(dp, "theta1", [[1.0, "2 rad"]])
real_number("h", [1.0, 2.0])
real_numbers("y0", [1.0, [2.0]], "m")
real_numbers("y0", [1.0, float("inf")], "m")
positive("h", 0.0)
Form(dp, "polar", dp.DEFAULTS)
Form(four_bar, "hamiltonian", four_bar.DEFAULTS)
[Form(dp, "rational", dp.DEFAULTS).locate(name) for name in ("theta1", "theta2_dot")]
Form(dp, "rational", dp.DEFAULTS).from_ordinary(0.0, np.array([0.1, 0.2, 0.3, 0.4]))
Form(dp, "hamiltonian", dp.DEFAULTS).from_ordinary(0.0, np.array([0.1, 0.2, 0.3, 0.4]))
Form(dp, "rational", dp.DEFAULTS).jacobian(0.0, np.array([0.6, 0.1, 0.8, 0.9, 0.3, 0.4]))
linearise(dp, {"theta1": np.pi}, {}).stability
linearise(four_bar, {"phi": 1.0}, {})
linearise(dp, {"theta9": 1.0}, {})
check_condition(dp, [("", (1.0, 1e-13, 1.0, 1.0, 9.81), (0.0, 0.0, 0.0, 0.0))])
check_condition(dp, [("", (1e-13, 1.0, 1.0, 1.0, 9.81), (0.0, 0.0, 0.0, 0.0))])
check_condition(dp, [("of motion 3", (1e-17, 1.0, 1.0, 1.0, 9.81), (0.0, 0.0, 0.0, 0.0))])
default_words(spring, {"theta": 0.1})
default_coordinates(spring, {"theta": 0.1}, spring.DEFAULTS)
"""
SOME = "duffing", "four_bar", "chaplygin_sleigh", "elastic_pendulum", "heavy_top"


def test_what_is_known_about_modules_is_as_recorded(record: Record) -> None:
    rooms = (energy, forms, module, number_checks, singularities, linear_system, normal_modes,
        consistent_start)  # fmt: skip
    names = {name: value for one in rooms for name, value in vars(one).items()}
    names |= {one: import_module(f"generated.{one}") for one in (*SOME, "driven_pendulum")}
    names |= {
        "all_modules": [import_module(f"generated.{one}") for one in generated.__all__],
        "some": [names[one] for one in SOME],
        "dp": import_module("generated.double_pendulum"),
        "driven": names["driven_pendulum"],
        "spring": names["elastic_pendulum"],
    }
    record.check(evaluated(EXPRESSIONS, names))


def test_intervals_enclose_values_tightly() -> None:
    rng, x = np.random.default_rng(8), np.linspace(0, 1, 801)
    for _ in range(8):
        low, other = rng.uniform(-3, 3, 2)
        width, more = rng.uniform(0.01, 4, 2)
        a = intervals.Interval(np.array([low]), np.array([low + width]))
        b = intervals.Interval(np.array([other]), np.array([other + more]))
        s, t = low + width * x, other + more * x
        pairs = [
            (a + b, s[:, None] + t), (a - b, s[:, None] - t), (a * b, s[:, None] * t),
            (1.5 - a, 1.5 - s), (-a, -s), (a / (b * b + 1.0), None),
            (intervals._sin(a), np.sin(s)), (intervals._cos(a), np.cos(s)),
            (intervals._cosh(a), np.cosh(s)),
        ]  # fmt: skip
        for bounded, values in pairs:
            lower, upper = (float(np.ravel(one)[0]) for one in intervals.bounds_of(bounded))
            assert lower <= upper
            if values is not None:
                assert lower <= values.min() <= lower + 0.01
                assert upper - 0.01 <= values.max() <= upper
