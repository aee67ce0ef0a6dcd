"""Outputs of a system: generated with their derivatives, which are C and D of linear systems."""

import subprocess
from pathlib import Path
from shutil import which

import numpy as np
import pytest
import sympy as sp
from cart_pole import F, T, cart_pole, theta, x

from derive import Derivation, System, load, velocity, with_inputs
from derive.codegen.module_files import texts
from derive.system.parts import SystemDefinitionError
from solvers.app.modules import build
from solvers.equations.linearisation.linear_system import linearise

length, M = sp.Symbol("l", positive=True), sp.Symbol("M", positive=True)
OUTPUTS = {"tip": x + length * sp.sin(theta), "push": F - M * velocity(x) ** 2, "angle": theta}


def measured(outputs: object) -> System:
    return System(
        *("measured", "", cart_pole.coordinates, cart_pole.parameters, cart_pole.masses),
        forces=cart_pole.forces,
        inputs=cart_pole.inputs,
        outputs=outputs,  # type: ignore[arg-type]
    )


cart = build(measured(OUTPUTS))
STATE = (0.1, 0.4, 0.5, -0.2)


def test_outputs_and_their_derivatives() -> None:
    params = cart.params(F=2.0, T=1.0)
    assert cart.OUTPUTS == ("tip", "push", "angle")
    values = (0.1 + 0.3 * np.sin(0.4), 2.0 - 0.5 * 0.25, 0.4)
    assert cart.outputs(0.0, STATE, params) == pytest.approx(values, rel=1e-14)
    plant = linearise(cart, STATE, {}, inputs=(2.0, 1.0))
    assert plant.outputs == cart.OUTPUTS
    C = [[1, 0.3 * np.cos(0.4), 0, 0], [0, 0, -0.5, 0], [0, 1, 0, 0]]
    assert pytest.approx(np.array(C), rel=1e-14) == plant.C
    assert plant.D.tolist() == [[0, 0], [1, 0], [0, 0]]
    some = linearise(cart, STATE, {}, outputs=["theta_dot", "push"])
    assert some.C.tolist() == [[0, 0, 0, 1], [0, 0, -0.5, 0]]
    assert some.D.tolist() == [[0, 0], [1, 0]]
    assert plant.to_scipy().D.shape == (3, 2)
    space = Derivation(cart_pole).state_space(
        dict(zip(cart.STATE, map(sp.Rational, map(str, STATE)), strict=True)), [*OUTPUTS.values()]
    )
    assert np.array(space.numbers()[2]) == pytest.approx(plant.C, rel=1e-14)
    many = cart.outputs_many(0.0, np.tile(np.array(STATE)[:, np.newaxis], 3), params)
    assert many == pytest.approx(np.tile(np.array(values)[:, np.newaxis], 3))


@pytest.mark.skipif(which("cc") is None, reason="no C compiler")
def test_outputs_in_c(tmp_path: Path) -> None:
    files = texts(Derivation(measured(OUTPUTS)))
    (tmp_path / "measured.h").write_text(files["measured.h"])
    (tmp_path / "a.c").write_text(
        """#include <stdio.h>
#include "measured.h"
int main(void) {
    const double y[] = {0.1, 0.4, 0.5, -0.2}, p[] = {0.5, 0.2, 0.3, 0.1, 9.81, 2.0, 1.0};
    double z[3], C[12];
    measured_outputs(0, y, p, z);
    measured_outputs_jacobian(0, y, p, C);
    printf("%.17g %.17g %.17g %.17g", z[0], z[1], C[1], C[6]);
}"""
    )
    subprocess.run(["cc", "-std=c99", "a.c", "-lm", "-o", "a"], cwd=tmp_path, check=True)
    printed = subprocess.run([tmp_path / "a"], capture_output=True, text=True, check=True).stdout
    expected = (0.1 + 0.3 * np.sin(0.4), 1.875, 0.3 * np.cos(0.4), -0.5)
    assert [float(one) for one in printed.split()] == pytest.approx(expected, rel=1e-14)


def test_outputs_of_files_and_with_formulas_for_inputs(tmp_path: Path) -> None:
    path = tmp_path / "block.toml"
    path.write_text(
        """
potential = "0"
forces = { x = "u" }
[coordinates]
x = { unit = "m" }
[parameters]
m = { value = 2.0, unit = "kg" }
[inputs]
u = { unit = "N" }
[outputs]
momentum = "m*x_dot"
force = "u"
[[masses]]
mass = "m"
position = ["x", "0"]
""",
        encoding="utf-8",
    )
    block = load(str(path))
    assert [name for name, _ in block.measured] == ["momentum", "force"]
    controlled = build(with_inputs(block, {"u": "-3*x"}))
    assert controlled.outputs(0.0, (0.5, 1.0), controlled.DEFAULTS) == (2.0, -1.5)
    assert linearise(controlled, {"x": 0.0}, {}).C.tolist() == [[0, 2], [-3, 0]]


def test_invalid_outputs_are_refused() -> None:
    with pytest.raises(SystemDefinitionError, match="output far contains unknown symbols: y"):
        measured({"far": sp.Symbol("y", real=True)})
    with pytest.raises(SystemDefinitionError, match="'two words' cannot be a name"):
        measured({"two words": x})
    with pytest.raises(SystemDefinitionError, match="give a mapping of names to formulas"):
        measured(["x"])
    with pytest.raises(SystemDefinitionError, match="uses a name twice: a"):
        measured([("a", x), ("a", T)])
    with pytest.raises(ValueError, match=r"outputs has 'tipp'.*did you mean 'tip'"):
        linearise(cart, STATE, {}, outputs=["tipp"])
