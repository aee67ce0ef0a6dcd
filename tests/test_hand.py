"""Hand derivations: published equations hold, every slip in them is found, and told where it is."""

import ast
import json
from collections.abc import Iterator
from pathlib import Path

import pytest
from mutation import Mutation

from derive import Derivation, load, names
from derive.system.catalogue import published
from derive.verification.hand.equations import judge
from derive.verification.hand.judgement import judged
from derive.verification.hand.meaning import Meaning
from solvers.app.cli import main
from solvers.io.toml_input import InputError


@pytest.mark.parametrize("name", names())
def test_published_equations_hold(name: str) -> None:
    found = judge(name)
    assert found.source
    for one in found.judgements:
        assert one.verdict in ("equal", "equivalent"), one


def slips(text: str) -> Iterator[str]:
    place = 0
    while True:
        mutation = Mutation(place)
        changed = mutation.visit(ast.parse(text, mode="eval"))
        if mutation.count <= place:
            return
        yield ast.unparse(changed)
        place += 1


QUICK = [name for name in names() if name not in ("chain_3", "foucault_pendulum")]


@pytest.mark.parametrize("name", QUICK)
def test_every_slip_in_them_is_found(name: str, tmp_path: Path) -> None:
    original = published(name)
    found, tried = 0, 0
    for one in judge(name).judgements:
        sides = one.printed.split("=")
        for text in slips(sides[0]):
            changed = "=".join([text, *sides[1:]])
            (tmp_path / "slip.toml").write_text(_replaced(original, one.printed, changed))
            (verdict,) = {
                j.verdict for j in judge(tmp_path / "slip.toml").judgements
                if j.place == one.place
            }  # fmt: skip
            tried += 1
            # a constant in a Lagrangian, or the sign of what is squared, changes nothing
            assert verdict != "unreadable"
            found += verdict == "wrong"
    assert found >= 0.9 * tried
    assert tried > 3


def _replaced(original: str, printed: str, changed: str) -> str:
    """The file with one formula changed, however it was broken into lines."""
    lines = original.replace("\\\n", "").split('"')
    for k, part in enumerate(lines):
        if " ".join(part.split()) == printed:
            lines[k] = changed
            return '"'.join(lines)
    raise AssertionError(printed)


DOUBLE = "m1*l1**2*theta1_dot**2/2 + m2*(l1**2*theta1_dot**2 + l2**2*theta2_dot**2 " \
    "+ 2*l1*l2*cos(theta2 - theta1)*theta1_dot*theta2_dot)/2"  # fmt: skip


@pytest.mark.parametrize(("kind", "key", "text", "term", "should_be"), [
    # a web page forgot g in the last term: arsnumerandi.com/post/11
    ("lagrangian", "", f"{DOUBLE} + (m1 + m2)*g*l1*cos(theta1) + m2*l2*cos(theta2)",
     "m2 * l2 * cos(theta2)", "g*l2*m2*cos(theta2)"),
    ("lagrangian", "", f"{DOUBLE} - (m1 + m2)*g*l1*cos(theta1) + m2*g*l2*cos(theta2)",
     "-(m1 + m2) * g * l1 * cos(theta1)", "g*l1*(m1 + m2)*cos(theta1)"),
    ("lagrangian", "", f"{DOUBLE} + (m1 + m2)*g*l1*cos(theta1)", "", "g*l2*m2*cos(theta2)"),
    ("lagrangian", "", f"{DOUBLE} + (m1 + m2)*g*l1*cos(theta1) + m2*g*l2*sin(theta2)",
     "m2 * g * l2 * sin(theta2)", "g*l2*m2*cos(theta2)"),
    ("euler_lagrange", "0",
     "(m1 + m2)*l1*theta1_ddot + m2*l2*theta2_ddot*cos(theta1 - theta2)"
     " - m2*l2*theta2_dot**2*sin(theta1 - theta2) + (m1 + m2)*g*sin(theta1) = 0",
     "-m2 * l2 * theta2_dot ** 2 * sin(theta1 - theta2)",
     "l2*m2*theta2_dot**2*sin(theta1 - theta2)"),
    ("euler_lagrange", "1",
     "l2*theta2_ddot + l1*theta1_ddot*cos(theta1 - theta2)"
     " = l1*theta1_dot**2*sin(theta1 - theta2) + g*sin(theta2)",
     "g * sin(theta2)", "-g*sin(theta2)"),
    ("momenta", "theta2", "m2*l2**2*theta2_dot + m2*l1*l2*theta1_dot*cos(theta1 + theta2)",
     "m2 * l1 * l2 * theta1_dot * cos(theta1 + theta2)",
     "l1*l2*m2*theta1_dot*cos(theta1 - theta2)"),
    ("accelerations", "theta1",
     "(-g*(2*m1 + m2)*sin(theta1) - m2*g*sin(theta1 - 2*theta2) - 2*sin(theta1 - theta2)*m2"
     "*(theta2_dot**2*l2 - theta1_dot**2*l1*cos(theta1 - theta2)))"
     "/(l1*(2*m1 + m2 - m2*cos(2*theta1 - 2*theta2)))",
     "-2 * sin(theta1 - theta2) * m2 * (theta2_dot ** 2 * l2 - theta1_dot ** 2 * l1 * "
     "cos(theta1 - theta2))", None),
    ("accelerations", "theta1",
     "(-g*(2*m1 + m2)*sin(theta1) - m2*g*sin(theta1 - 2*theta2) - 2*sin(theta1 - theta2)*m2"
     "*(theta2_dot**2*l2 + theta1_dot**2*l1*cos(theta1 - theta2)))"
     "/(l1*(2*m1 + m2 + m2*cos(2*theta1 - 2*theta2)))",
     "l1*(2*m1 + m2*cos(2*theta1 - 2*theta2) + m2)", None),
])  # fmt: skip
def test_the_first_wrong_term_is_named_with_what_should_stand_there(
    kind: str, key: str, text: str, term: str, should_be: str | None
) -> None:
    meaning = Meaning(Derivation(load("double_pendulum")), {})
    found = judged("here", text, meaning, kind, key)
    assert (found.verdict, found.term) == ("wrong", term)
    assert should_be is None or found.should_be == should_be
    printed, right = (float(part) for part in found.witness.split(", but it should be "))
    assert abs(printed - right) > 1e-3
    # the correction is right
    kind = "euler_lagrange" if "= 0" in found.correction else kind
    assert judged("there", found.correction, meaning, kind, key).verdict == "equal"


def test_accelerations_that_are_right_are_equal_in_whatever_form() -> None:
    meaning = Meaning(Derivation(load("double_pendulum")), {"D": "theta1 - theta2"})
    for text in (
        "(-g*(2*m1 + m2)*sin(theta1) - m2*g*sin(theta1 - 2*theta2) - 2*sin(D)*m2"
        "*(theta2_dot**2*l2 + theta1_dot**2*l1*cos(D)))/(l1*(2*m1 + m2 - m2*cos(2*D)))",
        "(m2*l1*theta1_dot**2*sin(-D)*cos(-D) + m2*g*sin(theta2)*cos(-D)"
        " + m2*l2*theta2_dot**2*sin(-D) - (m1 + m2)*g*sin(theta1))"
        "/((m1 + m2)*l1 - m2*l1*cos(-D)**2)",
    ):
        assert judged("", text, meaning, "accelerations", "theta1").verdict == "equal"


def test_the_command_tells_what_is_wrong_and_exits_so(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "page.toml"
    path.write_text(
        'system = "single_pendulum"\nsource = "a page"\n'
        'euler_lagrange = ["theta_ddot = g/l*sin(theta)"]\nhamiltonian = "p_theta**2/(2*m*l**2)'
        ' - m*g*l*cos(theta)"\n'
    )
    assert main(["verify", str(path)]) == 1
    told = capsys.readouterr().out
    assert "single_pendulum: a page" in told
    assert "wrong       euler_lagrange 1" in told
    assert "wrong: g / l * sin(theta), which should be -g*sin(theta)/l" in told
    assert "equal       hamiltonian" in told
    assert main(["verify", "--json", str(path)]) == 1
    (found,) = json.loads(capsys.readouterr().out)
    assert [one["verdict"] for one in found["judgements"]] == ["wrong", "equal"]
    assert main(["verify", "double_pendulum"]) == 0
    path.write_text('system = "single_pendulum"\nhamiltonian = "__import__(\'os\')"\n')
    assert main(["verify", str(path)]) == 2
    assert "unreadable  hamiltonian" in capsys.readouterr().out


@pytest.mark.parametrize(("text", "words"), [
    ('system = "single_pendulum"\n', "has no equations: give some of"),
    ('system = "single_pendulum"\nlagranian = "1"\n', "did you mean 'lagrangian'"),
    ('system = "single_pendulum"\nmomenta = { phi = "1" }\n', "unknown key 'phi' in momenta"),
    ('system = "single_pendulum"\nlagrangian = 3\n[names]\nx = "y"\n', "names.x: unknown name 'y'"),
    ('system = "single_pendulum"\nlagrangian = 3\n[equal]\nk = "1"\n', "parameters are m, l, g"),
    ('lagrangian = "1"\n', "'system' is missing"),
    (f'system = {"1" * 5000}\n', "is no TOML file"),
])  # fmt: skip
def test_files_that_make_no_sense_are_refused(text: str, words: str, tmp_path: Path) -> None:
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
    ("euler_lagrange", "1e12*(l*theta_ddot + g*sin(theta)) = 0", "equal"),
    ("euler_lagrange", "theta_dot*(l*theta_ddot + g*sin(theta)) = 0", "equal"),
    ("euler_lagrange", "theta_ddot = 1 = 2", "unreadable"),
    ("lagrangian", "m*l**2*theta_dot**2/2 + m*g*l*cos(theta) + theta_ddot**2", "unreadable"),
    ("lagrangian", "m*l**2*theta_dot**2/2 + m*g*l*cos(theta) + theta*theta_dot", "equivalent"),
    ("potential_energy", "m*g*l*(1 - cos(theta))", "equivalent"),
    ("potential_energy", "2*m*g*l*sin(theta/2)**2", "equivalent"),
    ("potential_energy", "-m*g*l*sqrt(cos(theta)**2)", "wrong"),
    ("accelerations", "-g/l*sqrt(sin(theta)**2)", "wrong"),
    ("hamiltonian", "p_theta**2/(2*m*l**2) + m*g*l*(1 - cos(theta))", "equivalent"),
    ("hamiltonian", "m*l**2*theta_dot**2/2 - m*g*l*cos(theta)", "unreadable"),
])  # fmt: skip
def test_what_only_seems_right_or_wrong_is_judged_as_it_is(
    kind: str, text: str, verdict: str
) -> None:
    meaning = Meaning(Derivation(load("single_pendulum")), {})
    assert judged("", text, meaning, kind, "theta").verdict == verdict


def test_their_letters_may_stand_for_coordinates_in_keys(tmp_path: Path) -> None:
    path = tmp_path / "hand.toml"
    path.write_text('system = "single_pendulum"\nmomenta = { phi = "m*l**2*phi_dot" }\n'
                    'hamilton = { phi = "p_phi/(m*l**2)", p_phi = "-m*g*l*sin(phi)" }\n'
                    'euler_lagrange = ["phi_ddot = -g/l*sin(phi)", "phi_ddot = g/l*sin(phi)"]\n'
                    '[names]\nphi = "theta"\n')  # fmt: skip
    found = judge(path).judgements
    assert [one.verdict for one in found] == ["equal"] * 4 + ["wrong"]


def test_the_sum_of_energies_is_an_energy_though_it_is_not_kept() -> None:
    meaning = Meaning(Derivation(load("rotating_hoop")), {})
    total = "m*R**2/2*(theta_dot**2 + Omega**2*sin(theta)**2) - m*g*R*cos(theta)"
    found = judged("", total, meaning, "energy", "")
    assert found.verdict == "equal"
    assert "Jacobi" in found.note
