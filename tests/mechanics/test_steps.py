"""A derivation's steps say what is derived, for every system, and stand beside the right lines."""

from html import escape

import pytest
import sympy as sp

from derive import Derivation, load, names
from derive.formulas.expression import FUNCTIONS, parse
from derive.formulas.typeset.typesetting import Formula
from derive.verification.judging.verdict import Verdict
from derive.verification.report.derivation_beside_report import EQUATIONS_OF_STEP, compare_steps
from derive.verification.report.report_judgement import EQUATIONS


def values_by_name(d: Derivation) -> dict[str, sp.Expr | sp.MatrixBase]:
    """What each name on a left side stands for."""
    s = d.system
    if s.conditions:
        last = {"G": d.constraint_jacobian, "gamma": d.constraint_forcing}
    else:
        rates, forces = d.hamilton_equations
        force_names = (p.name.replace("p_", "pdot_", 1) for p in s.p)
        last = {
            "H": d.hamiltonian,
            **dict(zip((q.name for q in s.qdot), rates, strict=True)),
            **dict(zip(force_names, forces, strict=True)),
        }
    if 0 < len(d.cyclic_coordinates) < len(s.q):
        last["R"] = d.routhian
    return {
        "K": d.kinetic_energy,
        "P": d.potential_energy,
        "L": d.lagrangian,
        "M": d.mass_matrix,
        "f": d.forcing,
        **{f"r{k}": sp.Matrix(mass.position) for k, mass in enumerate(s.masses, 1)},
        **{f"r{k}_dot": velocity for k, velocity in enumerate(d.velocities, 1)},
        **dict(zip((p.name for p in s.p), d.momenta, strict=True)),
        **last,
    }


# three angles take SymPy half a minute, and show nothing more
@pytest.mark.long("more cases of the same kind", keep=5)
@pytest.mark.parametrize("name", [name for name in names() if not name.endswith("_3")])
def test_every_formula_is_the_derived_one(name: str) -> None:
    derivation = Derivation(load(name))
    values = values_by_name(derivation)
    symbols = set().union(*(sp.Matrix([v]).free_symbols for v in values.values()))
    system = derivation.system
    symbols |= {*system.qdot, *system.qddot, *system.multipliers}
    namespace = {**FUNCTIONS, **{s.name: s for s in symbols}}
    names_shown, residuals = set(), []
    for step in derivation.steps:
        for formula in step.formulas:
            left, right = formula.text.split(" = ")
            if left not in values:
                residuals.append(left)
                continue
            names_shown.add(left)
            apart = sp.Matrix([parse(right, namespace)]) - sp.Matrix([values[left]])
            assert apart.expand().is_zero_matrix or sp.simplify(apart).is_zero_matrix, left
    assert names_shown == {*values}
    products = [residual for residual in residuals if "*[[" in residual]
    equations = [parse(one, namespace) for one in residuals if one not in products]
    conditions = [one.formula for one in system.conditions]
    reduced = [*derivation.routh_equations] if "R" in values else []
    assert equations[: len(equations) - len(reduced)] == [*conditions, *derivation.euler_lagrange]
    for equation, residual in zip(
        equations[-len(reduced) :] if reduced else [], reduced, strict=True
    ):
        assert sp.simplify(equation - residual) == 0
    assert [product[0] for product in products] == (["M", "G"] if conditions else ["M"])


def test_every_step_is_shown_with_its_own_lines(double: Derivation) -> None:
    def verified(name: str) -> Verdict:
        return Verdict(name, "verified", EQUATIONS[name].printed)

    every = list(compare_steps(double, verified))
    assert [one.step.title for one in every] == [*EQUATIONS_OF_STEP]
    shown = [verdict.id for one in every for verdict in one.verdicts]
    assert len({*shown}) == len(shown)
    assert {*shown} <= {*EQUATIONS}
    for one in every:
        assert one.section.count('class="line verified"') == len(one.verdicts)
        assert one.section.startswith(f"<h3>{one.step.title}</h3>")


def test_notebooks_show_a_system_and_its_derivation_as_mathematics() -> None:
    system = load("elastic_pendulum")
    derivation = Derivation(system)
    shown, own = derivation._repr_html_(), system._repr_html_()
    assert all(escape(step.title) in shown for step in derivation.steps)
    assert shown.count("<details open>") == shown.count("</details>") == len(derivation.steps)
    assert all(formula.html in shown for step in derivation.steps for formula in step.formulas)
    assert derivation.steps[1]._repr_html_() in shown
    for part in (*system.coordinates, *system.parameters):
        assert f"<td>{part.unit}</td><td>{part.meaning}</td>" in own
    assert Formula.of("r1", sp.Matrix(system.masses[0].position)).html in own
