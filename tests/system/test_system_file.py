"""Systems as TOML files: their content, and refusals of invalid ones without executing them."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import sympy as sp
from counting import counted_calls
from valid_files import BEAD

from derive import Constraint, Coordinate, Derivation, Parameter, PointMass, RigidBody, System, load
from derive.codegen.expression_graph.sympy_translation import NAMES
from derive.commands.regenerate import main
from derive.system.files.system_file import read_system
from derive.system.parts import SystemDefinitionError
from solvers.app.cli import main as holonomic
from solvers.app.modules import load as load_module
from solvers.app.modules import specialiser
from solvers.player.sampled_motion import energy_errors
from solvers.scenes.scene_output import together
from solvers.scenes.scene_reading import find
from solvers.scenes.scene_run import run_scene

PENDULUM = """
[coordinates]
theta = {}
[parameters]
m = { value = 2, unit = "kg" }
l = { value = 1.5, unit = "m" }
g = { value = "981/100", unit = "m/s^2" }
[[masses]]
mass = "m"
position = ["l*sin(theta)", "-l*cos(theta)"]
"""


def written(folder: Path, text: str, name: str = "mine") -> Path:
    path = folder / f"{name}.toml"
    path.write_text(text)
    return path


def test_a_file_and_python_define_the_same_system(tmp_path: Path) -> None:
    found = read_system(written(tmp_path, PENDULUM, "pendulum"))
    shipped = load("single_pendulum")
    assert found.name == "pendulum"
    assert [p.default for p in found.parameters] == [2.0, 1.5, 9.81]
    assert Derivation(found).euler_lagrange == Derivation(shipped).euler_lagrange


def test_a_file_can_define_all_that_python_can(tmp_path: Path) -> None:
    text = """
    gravity = ["g*sin(alpha)", "-g*cos(alpha)"]
    potential = "k*(s - s0)**2/2"
    reactions = ["R"]
    equilibrium = { s = "s0 + m*g*sin(alpha)/k" }
    [coordinates]
    s = { unit = "m", meaning = "way down the slope" }
    [parameters]
    m = { value = 2, unit = "kg" }
    R = { value = 0.1, unit = "m" }
    k = { value = 50, unit = "N/m", positive = true }
    s0 = { value = 0.5, unit = "m" }
    alpha = { value = "pi/6", unit = "rad" }
    g = { value = 9.81, unit = "m/s^2" }
    [[masses]]
    mass = "m"
    position = ["s", "R"]
    inertia = "m*R**2/2"
    angle = "s/R"
    """
    found = read_system(written(tmp_path, text))
    m, R, k, s0, alpha, g = found.params
    (s,) = found.q
    expected = System(
        name="mine",
        title="mine",
        coordinates=[Coordinate(s, "m", "way down the slope")],
        parameters=[
            Parameter(m, "kg", 2.0, "m"),
            Parameter(R, "m", 0.1, "R"),
            Parameter(k, "N/m", 50.0, "k"),
            Parameter(s0, "m", 0.5, "s0"),
            Parameter(alpha, "rad", float(sp.pi / 6), "alpha"),
            Parameter(g, "m/s^2", 9.81, "g"),
        ],
        masses=[RigidBody(m, (s, R), m * R**2 / 2, s / R)],
        potential=k * (s - s0) ** 2 / 2,
        gravity=(g * sp.sin(alpha), -g * sp.cos(alpha)),
        reactions=[R],
        equilibrium=[s0 + m * g * sp.sin(alpha) / k],
    )
    assert found == expected
    # a rolling cylinder: (3/2) m s̈ = m g sin α - k (s - s₀)
    derivation = Derivation(found)
    assert derivation.mass_matrix[0] == sp.Rational(3, 2) * m
    assert sp.expand(derivation.forcing[0] - m * g * sp.sin(alpha) + k * (s - s0)) == 0


def test_a_file_becomes_a_module_that_is_checked(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = written(tmp_path, BEAD, "bead")
    output = ["--output", str(tmp_path / "out")]
    assert main([str(path)]) == 2
    assert "give a folder for its module, with --output DIR" in capsys.readouterr().err
    assert main([str(path), *output]) == 0
    assert main(["--check", str(path), *output]) == 0
    module = tmp_path / "out" / "bead.py"
    module.write_text(module.read_text().replace("2.0*k", "3.0*k"))
    capsys.readouterr()
    assert main(["--check", str(path), *output]) == 1
    assert f"holonomic derive {path} --output" in capsys.readouterr().out


@pytest.mark.long("other tests reach its code")
def test_a_scene_runs_a_system_file(tmp_path: Path) -> None:
    written(tmp_path, BEAD, "bead")
    text = 'system = "bead.toml"\nduration = 5\naccuracy = 1e-7\n[initial]\nx = "50 cm"\n'
    scene = find(str(written(tmp_path, text, "scene")), load_module)
    found = run_scene(scene)
    assert found.is_met
    assert found.selection.declined["normal modes"] == "the equations depend on time"
    special = run_scene(
        find(str(written(tmp_path, 'code = "specialised"\n' + text, "special")), load_module),
        specialiser,
    )
    assert special.selection.model.run.motion.module.PARAMETERS == ()
    assert abs(special.y - found.y).max() < 2e-7
    # a file that changes is another system
    written(tmp_path, BEAD.replace("value = 0.2", "value = 0.4"), "bead")
    other = run_scene(find(str(tmp_path / "scene.toml"), load_module))
    assert abs(other.y - found.y).max() > 1e-2


def test_constraints_of_a_file_are_those_of_python(tmp_path: Path) -> None:
    text = """
    constraints = ["x - l*sin(theta)", { formula = "y_dot - l*theta_dot*sin(theta)", name = "up" }]
    coincide = [[["x", "y"], ["l*sin(theta)", "-l*cos(theta)"]]]
    [coordinates]
    x = { unit = "m" }
    y = { unit = "m" }
    theta = {}
    [parameters]
    m = { value = 2, unit = "kg" }
    l = { value = 1.5, unit = "m" }
    g = { value = "981/100", unit = "m/s^2" }
    [[masses]]
    mass = "m"
    position = ["x", "y"]
    """
    found = read_system(written(tmp_path, text))
    (x, y, theta), (_, vy, rate), length = found.q, found.qdot, found.params[1]
    end = (length * sp.sin(theta), -length * sp.cos(theta))
    up = Constraint(vy - length * rate * sp.sin(theta), "up")
    expected = replace(found, constraints=[x - end[0], up], coincide=[((x, y), end)])
    assert found.conditions == expected.conditions
    assert [one.name for one in found.conditions] == ["lambda_1", "up", "pin_1_x", "pin_1_y"]
    tables = text.replace("constraints = [", "coincide = []\n#").replace("coincide = [[[", "#")
    listed = tables + '\n[[constraints]]\nformula = "x - l*sin(theta)"\nunit = "N"'
    (one,) = read_system(written(tmp_path, listed)).conditions
    assert (one.formula, one.name, one.unit) == (x - end[0], "lambda_1", "N")


@pytest.mark.parametrize(("line", "words"), [
    ('constraints = "x"', "constraints = 'x' must be a list in square brackets"),
    ('constraints = [["x"]]', r"formula = \['x'\] in constraints 1 must be a number"),
    ("constraints = [{ name = 'rod' }]", "'formula' is missing in constraints 1"),
    ("constraints = [{ formul = 'x' }]", "'formul' in constraints 1 .did you mean 'formula'"),
    ('constraints = ["x", "hight"]', "constraints 2: unknown name 'hight' .did you mean 'height'"),
    ('constraints = ["__import__(\'os\')"]', "constraints 1: .*is not allowed"),
    ('constraints = [{ formula = "x", name = "os;rm" }]', "'os;rm' cannot be a name"),
    ('constraints = [{ formula = "x", name = "m" }]', "uses a name twice: m"),
    ('constraints = [{ formula = "x", unit = 3 }]', "unit = 3 in constraints 1"),
    ('constraints = ["x_dot**2 - 1"]', "constraint lambda_1 .* is not affine in the velocities"),
    ('constraints = ["k"]', "depends on no coordinate"),
    ('coincide = "x"', r"coincide = 'x' must be a list of lists \[first, second\]"),
    ('coincide = ["x", "x"]', r"coincide 1 = 'x' must be a list \[first, second\]"),
    ('coincide = [["x", "x"]]', "first = 'x' in coincide 1 must be a list in square brackets"),
    ('coincide = [[["x", "k"]]]', r"coincide 1 = .* must be a list \[first, second\]"),
    ('coincide = [[["x", "k"], ["x"]]]', "coincide contains .* two or three components each"),
    ('coincide = [[["x", "k"], ["x", "hight"]]]', "coincide 1: unknown name 'hight'"),
])  # fmt: skip
def test_invalid_constraints_are_refused(line: str, words: str, tmp_path: Path) -> None:
    path = written(tmp_path, f"{line}\n{BEAD.lstrip()}")
    with pytest.raises(SystemDefinitionError, match=words) as refusal:
        read_system(path)
    assert str(refusal.value).startswith(str(path))


@pytest.mark.parametrize(("change", "words"), [
    (('"m*g*height"', '"__import__(\'os\').system(\'touch hacked\')"'), "is not allowed"),
    (('"m*g*height"', '"m.g"'), "is not allowed in a formula"),
    (('"m*g*height"', '"(lambda: 1)()"'), "cannot parse"),
    (('"m*g*height"', '"9**9**9"'), "only numbers up to 100"),
    (('"m*g*height"', '"m*g^2"'), r"write powers with \*\*, not \^"),
    (('"m*g*height"', '"m*g*hight"'), "unknown name 'hight' .did you mean 'height'"),
    (('"m*g*height"', '"m*g*x_dot"'), "the potential depends on x_dot: it must be a function"),
    (('"m*g*height"', "true"), "potential = True in .* must be a number or a formula in quotes"),
    (('"m*g*height"', '"(m, g)"'), "potential: '.m, g.' is a column or matrix, not a number"),
    (("height = ", "pair = '(x, x)'\nheight = "), "definitions.pair: .* is a column or matrix"),
    (('mass = "m"', 'mass = "(m, m)"'), "'.m, m.' is a column or matrix, not a number"),
    (('"m*g*height"', '"' + "(" * 9000 + "m" + ")" * 9000 + '"'), "cannot parse|nested too deeply"),
    (("potential", "potentail"), "unknown key 'potentail' in .*did you mean 'potential'"),
    (("Omega = {", '"os;rm" = {'), "'os;rm' cannot be a name"),
    (("Omega = {", "volatile = {"), "'volatile' cannot be a name"),
    (("value = 1, unit", "value = -1, unit"), "parameters.m = -1.0 must be a positive number"),
    (("value = 1, unit", "value = 0, unit"), "parameters.m = 0.0 must be a positive number"),
    (("value = 1, unit", "valu = 1, unit"), "unknown key 'valu' in parameters.m"),
    (("value = 1, unit", "value = inf, unit"), "parameters.m"),
    (("value = 1, unit", "value = true, unit"), "must be a number or a formula in quotes"),
    (("height = ", "x = "), "definitions.x: the name is already used"),
    (('"x", "height"', '"x"'), "1 components"),
    (('["x", "height"]', '"x"'), "must be a list"),
    (("[[masses]]", "[masses]"), "must be tables: write .*masses"),
    (("title", "title = [[["), "is not valid TOML"),
    (('mass = "m"', 'mass = "-m"'), "mass -m is not positive"),
    (("value = 1,", 'value = "sqrt(-1)",'), r"parameters.m: value = 'sqrt\(-1\)' is not a real"),
    (('"kg"', '"kg,g"'), "the unit of m is 'kg,g', with a comma"),
    (("title", 'reactions = ["2*k"]\ntitle'), r"reactions: '2\*k' must be the name of a constant"),
    (("title", 'reactions = ["(m, m)"]\ntitle'), "reactions: '.m, m.' is a column or matrix"),
    (("c*x_dot**2/2", "c*x**2"), "depends on no velocity"),
    (('"1/2"', '"50 cm"'), "its unit is given by unit"),
    (("height = ", "late = 'height'\nheight = "), "a definition may use those above it"),
    (("[coordinates]", "[definitions.x]"), "is missing|must be"),
    (("title", 'name = "my-bead"\ntitle'), "cannot be the name of a system"),
])  # fmt: skip
def test_an_invalid_system_is_refused(
    change: tuple[str, str], words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    path = written(tmp_path, BEAD.replace(*change))
    with pytest.raises(SystemDefinitionError, match=words) as refusal, counted_calls() as calls:
        read_system(path)
    assert str(refusal.value).startswith(str(path))
    assert calls.count < 1_000_000
    assert [p.name for p in tmp_path.iterdir()] == ["mine.toml"]


def test_with_friction_only_equilibrium_and_full_equations_apply(tmp_path: Path) -> None:
    text = PENDULUM.replace("[coordinates]", 'dissipation = "theta_dot**2/20"\n[coordinates]', 1)
    written(tmp_path, text, "damped")
    scene = 'system = "damped.toml"\nduration = 20\naccuracy = 1e-7\ninitial = { theta = 1 }\n'
    found = run_scene(find(str(written(tmp_path, scene, "scene")), load_module))
    assert found.selection.declined["pendulum"] == "energy is not conserved"
    assert found.is_met
    energy = found.scene.module.energy_many(0.0, found.y, found.scene.params)
    assert energy[-1] < energy[0] - 1
    (errors,), unit = energy_errors(together([found]))
    assert abs(errors).max() < 1e-7  # with what friction took given back
    assert unit == "energy above rest"


@pytest.mark.long("other tests reach its code")
def test_deeply_nested_definitions_are_not_expanded(tmp_path: Path) -> None:
    nested = "d0 = 'theta'\n" + "".join(f"d{k} = 'd{k - 1} + sin(d{k - 1})'\n" for k in range(1, 9))
    text = PENDULUM.replace("[[masses]]", f"[definitions]\n{nested}[[masses]]")
    text = text.replace('["l*sin(theta)", "-l*cos(theta)"]', '["l*d8", "l*d8**2"]')
    path = written(tmp_path, text)
    with counted_calls() as calls:
        assert main([str(path), "--output", str(tmp_path)]) == 0
    assert calls.count < 10_000_000


def test_every_command_reports_functions_without_generated_code(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delitem(NAMES, sp.sinh)
    written(tmp_path, BEAD.replace('"m*g*height"', '"m*g*sinh(height/7)"'), "odd")
    scene = written(tmp_path, 'system = "odd.toml"\nduration = 1\ninitial = { x = 1 }\n', "scene")
    assert holonomic(["run", str(scene)]) == 2
    assert "no generated code for" in capsys.readouterr().err
    assert holonomic(["derive", str(tmp_path / "odd.toml"), "--output", str(tmp_path)]) == 2
    assert "no generated code for" in capsys.readouterr().err


def test_large_and_missing_files_are_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = written(tmp_path, "# " + "x" * 600_000)
    assert main([str(path), "--output", str(tmp_path)]) == 2
    assert "more than 500000 bytes" in capsys.readouterr().err
    assert main([str(tmp_path / "none.toml"), "--output", str(tmp_path)]) == 2
    assert "none.toml cannot be read: No such file" in capsys.readouterr().err


def test_inconsistent_forces_drives_and_reactions_are_refused() -> None:
    x, y, F = sp.symbols("x y F", real=True)
    m = sp.Symbol("m", positive=True)

    def system(**changes: object) -> System:
        parts = {
            "name": "thing",
            "title": "",
            "coordinates": [Coordinate(x, "m", "")],
            "parameters": [Parameter(m, "kg", 1.0, ""), Parameter(F, "N", 1.0, "")],
            "masses": [PointMass(m, (x, x**2))],
            "potential": 0,
        }
        return System(**(parts | changes))  # type: ignore[arg-type]

    for changes, words in (
        ({"forces": (F, F)}, "forces of system 'thing' has 2 components: give 1"),
        ({"forces": (y,)}, "the list of forces contains unknown symbols: y"),
        ({"gravity": (0, 0, -1)}, "gravity of system 'thing' has 3 components: give 2"),
        ({"reactions": (F,), "forces": (F,)}, "has reactions and applied forces"),
        ({"reactions": (y,)}, "the list of reactions contains unknown symbols: y"),
    ):
        with pytest.raises(SystemDefinitionError, match=words):
            system(**changes)
    with pytest.raises(SystemDefinitionError, match="orientation of a body in space"):
        RigidBody(m, (x, x, x), m, x)


@pytest.mark.parametrize(("change", "words"), [
    (('title = "Bead on a parabola that is shaken"', "title = 'T\"\"\"; import os'"), "the title"),
    (('"horizontal place of the bead"', '"a */ int hacked; /*"'), "the meaning"),
    (('unit = "kg"', "unit = 'm\", \"z\": str(open(\"hacked\")), \"'"), "the unit of m"),
    (('unit = "kg"', "unit = 'kg\\'"), "the unit of m"),
    (('unit = "kg"', 'unit = "k\\ng"'), "the unit of m"),
])  # fmt: skip
def test_text_is_never_executed(change: tuple[str, str], words: str, tmp_path: Path) -> None:
    text = BEAD.replace(*change)
    assert text != BEAD
    with pytest.raises(SystemDefinitionError, match=f"{words}.*must be one line without"):
        read_system(written(tmp_path, text))


def test_signs_of_symbols_are_part_of_the_module_s_identity(tmp_path: Path) -> None:
    # two systems that print alike: roots of squares may be drawn where a sign is known
    text = PENDULUM.replace('unit = "m"', 'unit = "m", positive = false')
    modules = [load_module(str(written(tmp_path, t, "one"))) for t in (PENDULUM, text, PENDULUM)]
    assert modules[0].__name__ == modules[2].__name__ != modules[1].__name__
    assert modules[0].POSITIVE != modules[1].POSITIVE


def test_decimals_are_exact_fractions() -> None:
    x, m = sp.symbols("x m", positive=True)
    found = System(
        name="thing",
        title="",
        coordinates=[Coordinate(x, "m", "")],
        parameters=[Parameter(m, "kg", 1.0, "")],
        masses=[PointMass(m, (0.1 * x, 0))],
        potential=0.5 * m * x**2,
    )
    assert found.potential == m * x**2 / 2
    assert replace(found, potential=np.int64(3)).potential == 3
    assert Derivation(found).mass_matrix[0] == m / 100


def test_independence_is_checked_within_the_reach_of_a_short_thread(tmp_path: Path) -> None:
    # at |x| > l the bead's height would be complex, and nothing could be told of its inertia
    text = PENDULUM.replace("theta", "x").replace(
        '["l*sin(x)", "-l*cos(x)"]', '["x", "-sqrt(l**2 - x**2)"]'
    )
    far = text.replace("sqrt(l**2 - x**2)", "sqrt(x**2 - l**2)")
    for file, sign in ((text, 1), (far, -1)):
        system = read_system(written(tmp_path, file))
        (mass, length, _), (x,) = system.params, system.q
        inertia = mass * (1 + x**2 / (length**2 - x**2) * sign)
        assert Derivation(system).mass_matrix[0].equals(inertia)
