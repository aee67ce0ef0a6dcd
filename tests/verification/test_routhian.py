"""Routhians: published ones, the motion that they give, and mistakes of hand derivations."""

from dataclasses import replace
from pathlib import Path

import pytest
import sympy as sp

from derive import Constraint, Coordinate, Derivation, Parameter, PointMass, System, load
from derive.formulas.generic_values import is_small, sample
from derive.formulas.numeric import Evaluator
from derive.handout.derivation_document import write_document
from derive.mechanics.routhian import Routhian
from derive.reading.document_formats import read_document
from derive.verification.documents.judgement import judge_document
from derive.verification.documents.letters.hints import hints
from derive.verification.hand_derivation_files import judge
from derive.verification.judging.verdict import Verdict

r, phi, g = sp.symbols("r phi g", real=True)
m, k = sp.symbols("m k", positive=True)
kepler = System("kepler", "A planet",
    [Coordinate(r, "m", "distance"), Coordinate(phi, "rad", "angle")],
    [Parameter(m, "kg", 1.0, "mass"), Parameter(k, "J m", 1.0, "attraction")],
    [PointMass(m, (r * sp.cos(phi), r * sp.sin(phi)))], potential=-k / r)  # fmt: skip

#: H. Goldstein, Classical Mechanics, 5.7, 8.3; L. D. Landau, E. M. Lifshitz, Mechanics, § 14, 35
TOP = ("(A + m*l**2)*theta_dot**2/2 - (p_phi - p_psi*cos(theta))**2/(2*(A + m*l**2)*sin(theta)**2)"
    " - p_psi**2/(2*C) - m*g*l*cos(theta)")  # fmt: skip
TOP_EQUATION = ("(A + m*l**2)*theta_ddot = m*g*l*sin(theta)"
    " + (p_phi - p_psi*cos(theta))**2*cos(theta)/((A + m*l**2)*sin(theta)**3)"
    " - p_psi*(p_phi - p_psi*cos(theta))/((A + m*l**2)*sin(theta))")  # fmt: skip
PUBLISHED = {
    "heavy_top": TOP,
    "spherical_pendulum": "m*l**2*theta_dot**2/2 - p_phi**2/(2*m*l**2*sin(theta)**2)"
    " + m*g*l*cos(theta)",
    "kepler": "m*r_dot**2/2 - p_phi**2/(2*m*r**2) + k/r",
}


def derivation(name: str) -> Derivation:
    return Derivation(kepler if name == "kepler" else load(name))


@pytest.mark.parametrize("name", PUBLISHED)
def test_published_routhians(name: str) -> None:
    d = derivation(name)
    symbols = {s.name: s for s in (*d.system.params, *d.system.q, *d.system.qdot, *d.system.p)}
    assert is_small(d.routhian - sp.sympify(PUBLISHED[name], locals=symbols))
    assert {*d.conserved_momenta} == {p for p in d.system.p if p.name in ("p_phi", "p_psi")}


@pytest.mark.parametrize("name", [*PUBLISHED, "cart_1", "cart_2"])
def test_reduced_equations_have_the_accelerations_of_the_whole_system(name: str) -> None:
    d = derivation(name)
    system = d.system
    state = sample((*system.params, *system.q, *system.qdot), 0)
    state |= {p: value.xreplace(state) for p, value in zip(system.p, d.momenta, strict=True)}
    M, f = (one.xreplace(state).evalf(40) for one in (d.mass_matrix, d.forcing))
    state |= dict(zip(system.qddot, M.LUsolve(f), strict=True))
    at = Evaluator(state)
    for residual in d.routh_equations:
        assert abs(at(residual).number) < 1e-30
    for velocity, value in d.cyclic_velocities.items():
        assert abs(at(value - velocity).number) < 1e-30
    # they determine the remaining accelerations
    others = [q for q in system.q if q not in d.cyclic_coordinates]
    accelerations = [a for q, a in zip(system.q, system.qddot, strict=True) if q in others]
    determinant = d.routh_equations.jacobian(accelerations).xreplace(state).evalf().det()
    assert abs(determinant) > 1e-6


def test_coordinates_with_forces_or_constraints_are_not_cyclic() -> None:
    assert Derivation(load("furuta_pendulum")).cyclic_coordinates == ()  # a motor turns alpha
    assert Derivation(load("chaplygin_sleigh")).cyclic_coordinates == ()
    d = Derivation(load("double_pendulum"))
    assert d.cyclic_coordinates == ()
    assert is_small(d.routhian - d.lagrangian)


def test_reactions_act_on_the_other_coordinates() -> None:
    x, y, z = sp.symbols("x y z", real=True)
    l = sp.symbols("l", positive=True)  # noqa: E741
    rod = Constraint(x**2 + z**2 - l**2, "rod", "N/m", "tension")
    sliding = System("sliding", "A pendulum that slides across", [
        Coordinate(q, "m", "position") for q in (x, y, z)],
        [Parameter(m, "kg", 1.0, "mass"), Parameter(l, "m", 1.0, "rod"),
         Parameter(g, "m/s^2", 9.81, "gravity")],
        [PointMass(m, (x, y, z))], constraints=[rod])  # fmt: skip
    d = Derivation(sliding)
    assert d.cyclic_coordinates == (y,)
    assert list(d.routh_equations) == [d.euler_lagrange[0], d.euler_lagrange[2]]


def test_one_of_several_cyclic_coordinates_can_be_eliminated() -> None:
    d = Derivation(load("heavy_top"))
    partial = Routhian(d, (1,))
    (psi,) = partial.velocities.values()
    whole = (d.lagrangian - d.system.p[1] * d.system.qdot[1]).xreplace({d.system.qdot[1]: psi})
    assert is_small(partial.function - whole)


def test_steps_end_with_the_routhian() -> None:
    titles = [step.title for step in Derivation(load("spherical_pendulum")).steps]
    assert titles[-1] == "Routhian"
    assert "Routhian" not in [step.title for step in Derivation(load("double_pendulum")).steps]


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize("name", ["spherical_pendulum", "cart_1"])
def test_documents_contain_it_and_are_verified(name: str, tmp_path: Path) -> None:
    (path,) = write_document(derivation(name), tmp_path / "document.tex")
    formulas = judge_document(read_document(path), hints(name, None)).formulas
    own = [one for one in formulas if one.latex.startswith("R &") or "partial R" in one.latex]
    assert [one.verdict for one in own] == ["verified", "verified"]


@pytest.mark.long("other tests reach its code")
def test_friction_and_routhian_have_different_letters(tmp_path: Path) -> None:
    c, spherical = sp.Symbol("c", positive=True), load("spherical_pendulum")
    rubbing = replace(spherical, dissipation=c * spherical.qdot[0] ** 2 / 2,
        parameters=[*spherical.parameters, Parameter(c, "N m s", 0.1, "friction")])  # fmt: skip
    (path,) = write_document(Derivation(rubbing), tmp_path / "document.tex")
    formulas = judge_document(read_document(path), hints("spherical_pendulum", None)).formulas
    of = {one.latex.split("=")[0].strip(" &"): one.verdict for one in formulas}
    assert of["R"] == "definition"
    assert of[r"R_{\mathrm{cyc}}"] == "verified"


@pytest.mark.parametrize(("sign", "verdict"), [("-", "verified"), ("+", "wrong")])
def test_a_routhian_in_a_document_is_judged(sign: str, verdict: str, tmp_path: Path) -> None:
    path = tmp_path / "page.md"
    path.write_text(
        r"With $T = \frac12 m l^2(\dot\theta^2 + \sin^2\theta\,\dot\phi^2)$, $V = -m g l\cos\theta$"
        r" and $p_\phi = m l^2\sin^2\theta\,\dot\phi$ the Routhian is"
        rf" $$R = \frac12 m l^2\dot\theta^2 {sign} \frac{{p_\phi^2}}{{2 m l^2\sin^2\theta}}"
        r" + m g l\cos\theta$$"
    )
    *_, one = judge_document(read_document(path)).formulas
    assert one.verdict == verdict
    assert ("it is the Lagrangian with p_phi" in one.note) == (verdict == "wrong")


def judged(folder: Path, system: str, *lines: str) -> tuple[Verdict, ...]:
    path = folder / "source.toml"
    path.write_text("\n".join([f'system = "{system}"', *lines]))
    return judge(path).equations


@pytest.mark.parametrize("name", ["heavy_top", "spherical_pendulum"])
def test_published_routhians_are_verified(name: str, tmp_path: Path) -> None:
    (verdict,) = judged(tmp_path, name, f'routhian = "{PUBLISHED[name]}"')
    assert verdict.verdict == "verified"


@pytest.mark.long("more cases of the same kind", keep=4)
@pytest.mark.parametrize(
    ("text", "verdict", "note"),
    [
        (f"-({TOP})", "equivalent", "the opposite sign"),
        (TOP.replace(" - p_psi**2/(2*C)", ""), "equivalent", "a function of the constant momenta"),
        (f"{TOP} + theta_dot*p_phi*cos(theta)", "equivalent", "a total time derivative"),
        (f"2*({TOP})", "wrong", ""),
        (TOP.replace("2 - (p_phi", "2 + (p_phi").replace("- p_psi**2/(2", "+ p_psi**2/(2"),
         "wrong", "it is the Lagrangian with p_phi, p_psi"),
        (TOP.replace("- m*g", "+ m*g"), "wrong", ""),
        (f"phi_dot + {TOP}", "unreadable", "phi_dot cannot occur"),
        ("p_psi*phi_dot*cos(theta) + (A + l**2*m)*(phi_dot**2*sin(theta)**2 + theta_dot**2)/2"
         " - p_psi**2/(2*C) - m*g*l*cos(theta)", "verified", ""),
    ],
)  # fmt: skip
def test_other_routhians_of_a_top(text: str, verdict: str, note: str, tmp_path: Path) -> None:
    (one,) = judged(tmp_path, "heavy_top", f'routhian = "{text}"')
    assert one.verdict == verdict, one
    assert note in one.note
    assert bool(one.witness) == (verdict == "wrong")


def test_the_sum_of_products_with_the_other_sign_is_wrong(tmp_path: Path) -> None:
    text = PUBLISHED["spherical_pendulum"].replace("- p_phi**2", "+ 3*p_phi**2")  # L + p*phi_dot
    (one,) = judged(tmp_path, "spherical_pendulum", f'routhian = "{text}"')
    assert one.verdict == "wrong"
    assert one.corrections[0].wrong.startswith("3")


def test_the_first_wrong_term_is_named(tmp_path: Path) -> None:
    text = PUBLISHED["spherical_pendulum"].replace("+ m*g", "- m*g")
    (one,) = judged(tmp_path, "spherical_pendulum", f'routhian = "{text}"')
    assert "m*g*l*cos(theta)" in one.corrections[0].wrong


def test_reduced_equations_are_judged(tmp_path: Path) -> None:
    (one,) = judged(tmp_path, "heavy_top", f'euler_lagrange = ["{TOP_EQUATION}"]')
    assert one.verdict == "equivalent"
    assert "it holds for the momenta" in one.note
    assert "incomplete" not in one.note
    substituted = TOP_EQUATION.replace("(theta) + (p_phi", "(theta) - (p_phi")
    substituted = substituted.replace("- p_psi*(p_phi", "+ p_psi*(p_phi")
    (one,) = judged(tmp_path, "heavy_top", f'euler_lagrange = ["{substituted}"]')
    assert one.verdict == "wrong"
    assert "it follows from the Lagrangian with p_phi, p_psi" in one.note
