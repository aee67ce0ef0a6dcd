"""Values and messages of functions for input and output, a line of Python each."""

import time
from itertools import count
from pathlib import Path

import pytest
from evaluated import evaluated
from folders import ROOT
from recording import Record

from solvers.io import (
    argument_types,
    exports,
    figure_names,
    figures,
    quantity,
    suggestion,
    terminal,
    toml_input,
)

EXPRESSIONS = """
did_you_mean("lenght", ["length", "mass", "Lengths"])
did_you_mean("LEN", ["mass", "length"])
did_you_mean("le", ["mass", "length"])
did_you_mean("the", ["mass", "theta1_dot"])
did_you_mean("dt", ["h", "rtol"])
did_you_mean("h", ["step", "rtol"])
did_you_mean("q", [])
[counted(n, "step") for n in (0, 1, 2)]
[listed(names) for names in (["a"], ["a", "b"], ["a", "b", "c"])]
shortened("x" * 90)
shortened(10**5000)
dimension("kg m^2/s^2")
dimension("N s/m")
dimension("1/min")
dimension("rpm")
dimension("m^0.5")
dimension("m**2**9")
dimension("lb")
with_unit(0.125, "m")
with_unit(1234567.0, "1", 4)
quantity("90 deg", "rad")
quantity("1/2 turn", "rad")
quantity("300 g", "kg")
quantity("2*pi", "s")
quantity("5 m", "s")
quantity("1,5 m", "m")
quantity("9**9**9", "m")
quantity("2e400", "m")
quantity("-3 km/h", "m/s")
quantity(True, "m")
quantity(float("nan"), "m")
quantity("", "m")
formula("2*x + sqrt(y)", {"x": 3.0, "y": 4.0, "sqrt": abs})
formula("x.real", {"x": 3.0})
formula("z", {"x": 3.0})
[plain_symbol(name) for name in ("theta1", "theta1_dot", "p_phi", "l_max", "x12")]
[symbol(name) for name in ("theta1", "theta1_dot", "p_phi", "l_max", "x12", "E")]
[axis_label("time", unit) for unit in ("s", "1", "", "rad/s", "N m")]
jsonable({"a": [1.5, float("nan"), float("inf")], "b": (True, None)})
colours(3), len(set(colours(9)))
columns([1 + 2j, 3 + 4j], "real", "imag")
[*text_table({"method": "", "error": ".1e", "n": "d"}, [("rk4", 0.01, 7), ("x", None, 1000)])]
[ProgressRate(100, 40)(10), ProgressRate(9, 9)(1)]
check_type("h", "a", float, "a number")
check_texts("names", ["a", 1])
check_direction("direction", 2)
text("title", "a" * 9, most=8)
text("title", "a\\x00b")
text("title", 3, " in [scene]")
texts("names", ["a", ""], 9)
texts("names", "a", 9)
[whole("n", value, 2, 5) for value in (2, 5)]
whole("n", 1, 2, 5)
whole("n", 6, 2, 5)
whole("n", 2.5, 2, 5)
positive("h", "0 s", "s", "; the direction follows")
number("h", "1 ms", "s")
check_keys("a scene", {"tilte": 1}, ["title", "system"])
path("scene", "repot", SCENES)
path("scene", "absent.toml", SCENES)
read_bytes(HERE, 10)
read_bytes(SCENES, 10)
"""


def test_values_of_input_and_output_are_as_recorded(
    record: Record, monkeypatch: pytest.MonkeyPatch
) -> None:
    clock = count(10.0, 2.5)
    monkeypatch.setattr(time, "monotonic", lambda: next(clock))
    rooms = (argument_types, exports, figure_names, figures, quantity, suggestion,
        terminal, toml_input)  # fmt: skip
    names = {name: value for one in rooms for name, value in vars(one).items()}
    names |= {"quantity": quantity.quantity}
    names |= {
        "HERE": Path(toml_input.__file__),
        "SCENES": Path(toml_input.__file__).parents[1] / "scenes" / "files",
    }
    record.check(evaluated(EXPRESSIONS, names).replace(str(ROOT), ""))
