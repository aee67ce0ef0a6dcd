"""Hand derivations: published equations hold, and errors are located."""

import ast
import json
import tomllib
from collections.abc import Iterator
from dataclasses import fields, replace
from functools import cache
from itertools import count
from pathlib import Path
from typing import Any

import pytest
import sympy as sp
from damage import toml
from mutation import Mutation

from derive import Coordinate, Derivation, Parameter, PointMass, System, load, names
from derive.system.files.shipped import large_names
from derive.system.files.system_catalogue import published
from derive.verification import hand_derivation_files, quantity_verdicts
from derive.verification.hand_derivation_files import EQUATIONS, HEADER, judge
from derive.verification.judging.reference_system import ReferenceSystem
from derive.verification.judging.verdict import Verdict
from derive.verification.quantity_verdicts import judge_formula
from solvers.app.cli import main
from solvers.io.toml_input import InputError


@pytest.mark.long("more cases of the same kind", keep=2, daily=13)
@pytest.mark.parametrize("name", [*names(), *large_names()])
def test_published_equations_hold(name: str) -> None:
    derivation = judge(name)
    assert derivation.source
    for one in derivation.equations:
        assert one.verdict in ("verified", "equivalent"), one


def mutants(text: str) -> Iterator[str]:
    for index in count():
        mutation = Mutation(index)
        changed = mutation.visit(ast.parse(text, mode="eval"))
        if mutation.count <= index:
            return
        yield ast.unparse(changed)


SLOW = ("chain_3", "foucault_pendulum", "four_bar", "free_body", "rolling_disc", "slider_crank")
QUICK = [name for name in names() if name not in SLOW]


@pytest.fixture
def without_advice(monkeypatch: pytest.MonkeyPatch) -> None:
    """Verdicts without corrections, which have tests of their own; files share a system."""
    monkeypatch.setattr(quantity_verdicts, "advised", lambda verdict, *_: verdict)
    monkeypatch.setattr(hand_derivation_files, "load", cache(hand_derivation_files.load))


@pytest.mark.long("more cases of the same kind", keep=1, daily=9)
@pytest.mark.usefixtures("without_advice")
@pytest.mark.parametrize("name", QUICK)
def test_mutations_of_published_equations_are_wrong(name: str, tmp_path: Path) -> None:
    original, path, verdicts = published(name), tmp_path / "mutant.toml", []
    for one in judge(name).equations:
        sides = one.printed.split("=")
        for text in mutants(sides[0]):
            changed = "=".join([text, *sides[1:]])
            path.write_text(toml(_alone(original, one.printed, changed)))
            (mutant,) = judge(path).equations
            verdicts.append(mutant.verdict)
    assert "unreadable" not in verdicts
    # the rest is correct: a constant in a Lagrangian, or the sign of a square
    assert verdicts.count("wrong") >= 0.9 * len(verdicts)
    assert len(verdicts) > 3


def _alone(original: str, printed: str, changed: str) -> dict[str, Any]:
    """The document with one of its equations only, which is changed."""
    document = tomllib.loads(original)
    alone = {key: document[key] for key in HEADER if key in document}
    for key in EQUATIONS:
        match document.get(key):
            case str() as text if " ".join(text.split()) == printed:
                return alone | {key: changed}
            case list() as texts if printed in [" ".join(text.split()) for text in texts]:
                return alone | {key: [changed]}
            case dict() as table:
                for name, text in table.items():
                    if " ".join(text.split()) == printed:
                        return alone | {key: {name: changed}}
    raise AssertionError(printed)


def test_correct_accelerations_are_verified_in_any_form() -> None:
    system = load("double_pendulum")
    model = ReferenceSystem(Derivation(system), {"D": system.q[0] - system.q[1]})
    for text in (
        "(-g*(2*m1 + m2)*sin(theta1) - m2*g*sin(theta1 - 2*theta2) - 2*sin(D)*m2"
        "*(theta2_dot**2*l2 + theta1_dot**2*l1*cos(D)))/(l1*(2*m1 + m2 - m2*cos(2*D)))",
        "(m2*l1*theta1_dot**2*sin(-D)*cos(-D) + m2*g*sin(theta2)*cos(-D)"
        " + m2*l2*theta2_dot**2*sin(-D) - (m1 + m2)*g*sin(theta1))"
        "/((m1 + m2)*l1 - m2*l1*cos(-D)**2)",
    ):
        assert judge_formula(model, "", text, "accelerations", "theta1").verdict == "verified"


def test_the_command_reports_errors_and_exits_with_a_code(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "page.toml"
    path.write_text(
        'system = "single_pendulum"\nsource = "a page"\n'
        'euler_lagrange = ["theta_ddot = g/l*sin(theta)"]\nhamiltonian = "p_theta**2/(2*m*l**2)'
        ' - m*g*l*cos(theta)"\n'
    )
    assert main(["verify", str(path)]) == 1
    output = capsys.readouterr().out
    assert "single_pendulum: a page" in output
    assert "\neuler_lagrange 1  wrong        theta_ddot = g/l*sin(theta)\n" in output
    assert " wrong term: g/l*sin(theta)\n" in output
    assert " correct term: -g/l*sin(theta)\n" in output
    assert " correct form: g*sin(theta)/l + theta_ddot = 0\n" in output
    state = " state: l = 1459/500, g = 517/250, theta = 2157/5000, theta_ddot = "
    assert state in " ".join(output.split())
    assert "\nhamiltonian       verified     " in output
    assert main(["verify", "--json", str(path)]) == 1
    (derivation,) = json.loads(capsys.readouterr().out)
    assert [one["verdict"] for one in derivation["equations"]] == ["wrong", "verified"]
    assert {*derivation["equations"][0]} == {field.name for field in fields(Verdict)}
    assert main(["verify", "double_pendulum"]) == 0
    path.write_text('system = "single_pendulum"\nhamiltonian = "__import__(\'os\')"\n')
    assert main(["verify", str(path)]) == 2
    assert "\nhamiltonian  unreadable   __import__('os')\n" in capsys.readouterr().out


@pytest.mark.parametrize(("text", "words"), [
    ('system = "single_pendulum"\n', "has no equations: give at least one of"),
    ('system = "single_pendulum"\nlagranian = "1"\n', "did you mean 'lagrangian'"),
    ('system = "single_pendulum"\nmomenta = { phi = "1" }\n', "unknown key 'phi' in momenta"),
    ('system = "single_pendulum"\nlagrangian = 3\n[names]\nx = "y"\n', "names.x: unknown name 'y'"),
    ('system = "single_pendulum"\nlagrangian = 3\n[equal]\nk = "1"\n', "parameters are m, l, g"),
    ('lagrangian = "1"\n', "'system' is missing"),
    (f'system = {"1" * 5000}\n', "is not valid TOML"),
])  # fmt: skip
def test_invalid_files_are_rejected(text: str, words: str, tmp_path: Path) -> None:
    path = tmp_path / "hand.toml"
    path.write_text(text)
    with pytest.raises(InputError, match=words):
        judge(path)


@pytest.mark.parametrize(("kind", "text", "verdict"), [
    ("euler_lagrange", "m - m = 0", "wrong"),
    ("euler_lagrange", "theta_ddot - theta_ddot*(sin(theta)**2 + cos(theta)**2) = 0", "wrong"),
    ("euler_lagrange", "1e-31*theta_ddot = 1e-31*theta", "wrong"),
    ("euler_lagrange", "l*theta_ddot + g*sin(theta) + 1e-25*theta_dot = 0", "wrong"),
    ("euler_lagrange", "theta_ddot**2 = (g/l*sin(theta))**2", "wrong"),
    ("euler_lagrange", "1e12*(l*theta_ddot + g*sin(theta)) = 0", "verified"),
    ("euler_lagrange", "theta_dot*(l*theta_ddot + g*sin(theta)) = 0", "verified"),
    ("euler_lagrange", "theta_ddot = 1 = 2", "unreadable"),
    ("euler_lagrange", "(theta_ddot, 1)", "unreadable"),
    ("lagrangian", "[[1, 2], [3, 4]]", "unreadable"),
    ("lagrangian", "m*l**2*theta_dot**2/2 + m*g*l*cos(theta) + theta_ddot**2", "unreadable"),
    ("lagrangian", "m*l**2*theta_dot**2/2 + m*g*l*cos(theta) + theta*theta_dot", "equivalent"),
    ("potential_energy", "m*g*l*(1 - cos(theta))", "equivalent"),
    ("potential_energy", "2*m*g*l*sin(theta/2)**2", "equivalent"),
    ("potential_energy", "-m*g*l*sqrt(cos(theta)**2)", "wrong"),
    ("accelerations", "-g/l*sqrt(sin(theta)**2)", "wrong"),
    ("hamiltonian", "p_theta**2/(2*m*l**2) + m*g*l*(1 - cos(theta))", "equivalent"),
    ("hamiltonian", "m*l**2*theta_dot**2/2 - m*g*l*cos(theta)", "unreadable"),
])  # fmt: skip
def test_misleading_equations_are_judged_correctly(kind: str, text: str, verdict: str) -> None:
    model = ReferenceSystem(Derivation(load("single_pendulum")), {})
    assert judge_formula(model, "", text, kind, "theta").verdict == verdict


def test_at_all_states_the_lagrangian_is_real() -> None:
    x, (m, radius, g) = sp.Symbol("x", real=True), sp.symbols("m R g", positive=True)
    height = -sp.sqrt(radius**2 - x**2)
    parameters = [Parameter(m, "kg", 1.0, ""), Parameter(radius, "m", 1.0, "")]
    bead = System("bead", "Bead on a circle", [Coordinate(x, "m", "")],
        [*parameters, Parameter(g, "m/s^2", 9.81, "")],
        [PointMass(m, (x, height))], potential=m * g * height)  # fmt: skip
    model = ReferenceSystem(Derivation(bead), {})
    values = [value(model.derivation.lagrangian) for value in model.context.evaluators]
    assert all(value.rounded().is_real for value in values)


def test_models_share_states_only_where_motions_and_momenta_are_the_same() -> None:
    derivation = Derivation(load("single_pendulum"))
    system, model = derivation.system, ReferenceSystem(derivation, {})
    (qdot,), (qddot,), (p,) = system.qdot, system.qddot, system.p
    free = qddot - derivation.accelerations[0]
    assert model.agreement(free) is not None
    renamed = replace(model, names={"phi": system.q[0]})
    assert renamed.motions.evaluators is model.motions.evaluators
    loaded = replace(system, reactions=(), forces=(-qdot,))
    damped = replace(model, derivation=Derivation(loaded))
    assert damped.agreement(free) is None
    assert damped.agreement(qddot - damped.derivation.accelerations[0]) is not None
    shifted = model.with_lagrangian(derivation.lagrangian + qdot)
    assert shifted.agreement(p - derivation.momenta[0] - 1) is not None


def test_keys_can_use_the_names_of_the_source(tmp_path: Path) -> None:
    path = tmp_path / "hand.toml"
    path.write_text(
        'system = "single_pendulum"\nmomenta = { phi = "m*l**2*phi_dot" }\n'
        'hamilton = { phi = "p_phi/(m*l**2)", p_phi = "-m*g*l*sin(phi)" }\n'
        'euler_lagrange = ["phi_ddot = -g/l*sin(phi)", "phi_ddot = g/l*sin(phi)"]\n'
        '[names]\nphi = "theta"\n'
    )
    assert [one.verdict for one in judge(path).equations] == ["verified"] * 4 + ["wrong"]


def test_the_sum_of_energies_is_accepted_as_energy_although_it_is_not_conserved() -> None:
    model = ReferenceSystem(Derivation(load("rotating_hoop")), {})
    total = "m*R**2/2*(theta_dot**2 + Omega**2*sin(theta)**2) - m*g*R*cos(theta)"
    result = judge_formula(model, "", total, "energy")
    assert result.verdict == "verified"
    assert "Jacobi" in result.note
