"""The LaTeX of documents, read back, has the values of the derivation."""

import cmath
from functools import cache
from math import prod
from pathlib import Path
from random import Random

import pytest
import sympy as sp
from latex_trees import show

from derive import Derivation, load, names, reduced
from derive.formulas.typeset.lettering import lettering
from derive.handout.derivation_document import document, with_letters, write_document
from derive.handout.derived_letters import DerivedLetters
from derive.handout.formats.tex import equation_rows
from derive.reading.document_formats import read_document
from derive.reading.latex.display_reader import formulas
from derive.reading.latex.tree import (
    Application,
    Call,
    Letter,
    Matrix,
    Node,
    Number,
    Power,
    Product,
    Quotient,
    Root,
    Statement,
    Sum,
)
from derive.system.symbols import TIME
from derive.verification.documents.judgement import judge_document

FUNCTIONS = {"sin": cmath.sin, "cos": cmath.cos, "tan": cmath.tan, "exp": cmath.exp}
Key = tuple[str, str, int]
State = dict[Key, complex]


def key_of(name: str) -> Key:
    """The letter, index and dots with which a name is printed."""
    read = lettering(name)
    return read.letter, "".join(map(index_of, read.indices)), read.dots


def index_of(index: str) -> str:
    letter, inner, _ = key_of(index) if not index.isdigit() else (index, "", 0)
    return f"{letter}_{inner}" if inner else letter


def value(node: Node, state: State) -> complex:
    """The value of a number that is written in LaTeX."""
    match node:
        case Number(digits):
            return complex(digits)
        case Letter(name, _, index, dots):
            return state[name, index, dots]
        case Sum(terms):
            return sum(sign * value(term, state) for sign, term in terms)
        case Product(factors):
            return prod(value(factor, state) for factor in factors)
        case Quotient(above, below):
            return value(above, state) / value(below, state)
        case Power(Application(head, (argument,)), exponent):  # the factor has no exponent
            return value(head, state) * value(argument, state) ** value(exponent, state)
        case Power(base, exponent):
            return value(base, state) ** value(exponent, state)
        case Root(radicand, 2):
            return cmath.sqrt(value(radicand, state))
        case Call(function, argument):
            return FUNCTIONS[function](value(argument, state))
        case Application(head, (argument,)):  # a factor before brackets
            return value(head, state) * value(argument, state)
    raise AssertionError(f"{node} is no number")


def entries(node: Node) -> list[Node]:
    return [entry for row in node.rows for entry in row] if isinstance(node, Matrix) else [node]


def expected(d: Derivation) -> dict[str, sp.Expr | sp.MatrixBase]:
    """What stands behind the left sides of a document, by the first side as text."""
    s, many = d.system, len(d.system.q) > 1
    slopes = [d.lagrangian.diff(q) for q in s.q]
    masses = DerivedLetters(s).positions
    values = {
        **{f"{r}_vector": sp.Matrix(m.position) for r, m in zip(masses, s.masses, strict=True)},
        **{f"{r}_vector_dot": v for r, v in zip(masses, d.velocities, strict=True)},
        "T": d.kinetic_energy,
        "V": d.potential_energy,
        "L": d.lagrangian,
        "E": d.energy,
        "R": s.dissipation or d.routhian,
        **dict(zip((p.name for p in s.p), d.momenta, strict=True)),
        "M": d.mass_matrix,
        "f_vector" if many else "f": d.forcing,
        "b_vector" if many else "b": d.drift,
        "ddt(E)": d.power,
    }
    for q, qdot, left, slope, applied in zip(
        s.q, s.qdot, d.euler_lagrange, slopes, s.applied, strict=True
    ):
        reactions = sp.Add(
            *(
                c.symbol * c.formula.diff(qdot if c.formula.has(*s.qdot) else q)
                for c in s.conditions
            )
        )
        values[f"ddt(d(L, {qdot}))"] = left + slope + applied + reactions
        values[f"d(L, {q})"] = slope
        force = f" - Q_{q}" if applied else ""
        reaction = DerivedLetters(s).reaction(s.q.index(q)).replace("_sys", "")
        values[f"ddt(d(L, {qdot})) - d(L, {q}){force}{reaction}"] = left
        values[f"Q_{q}"] = applied
        values[f"pdot_{q}"] = slope + applied  # with the momenta of the velocities
    others = [k for k, q in enumerate(s.q) if q not in d.cyclic_coordinates]
    for k, residual in zip(others, d.routh_equations, strict=True):
        force = f" - Q_{s.q[k]}" if s.applied[k] else ""
        values[f"ddt(d(R, {s.qdot[k]})) - d(R, {s.q[k]}){force}"] = residual
    values |= {one.coordinate.symbol.name: one.formula for one in reduced(s).eliminated}
    if s.conditions:
        values |= {f"phi_{k}": one.formula for k, one in enumerate(s.conditions, 1)}
        values |= {"G": d.constraint_jacobian, "gamma_vector": d.constraint_forcing}
    elif d.mass_matrix.is_diagonal() or len(s.q) < 3:
        values |= dict(zip((a.name for a in s.qddot), d.accelerations, strict=True))
        values |= dict(zip((v.name for v in s.qdot), d.hamilton_equations[0], strict=True))
        values["H"] = d.hamiltonian
    if d.is_linearisable:
        linear, omega = d.linearisation(), sp.Symbol("omega", positive=True)
        M, K = linear.mass_matrix, linear.stiffness_matrix
        values |= {"M_0": M, "K_0": K, "det(K_0 - omega**2*M_0)": (K - omega**2 * M).det()}
        values["omega**2"] = K[0] / M[0]
    return with_entries(values)


def with_entries(values: dict[str, sp.Expr | sp.MatrixBase]) -> dict[str, sp.Expr | sp.MatrixBase]:
    """The values, and those of entries under their own names."""
    named = dict(values)
    for name, whole in values.items():
        if isinstance(whole, sp.MatrixBase) and whole.cols > 1:
            for i in range(whole.rows):
                named |= {f"{name}_{i + 1}{j + 1}": whole[i, j] for j in range(whole.cols)}
        elif isinstance(whole, sp.MatrixBase):
            letter, _, dot = name.partition("_vector")
            named |= {f"{letter}_{i}": entry for i, entry in enumerate(whole, 1)}
            axes = zip("xyz", whole, strict=False)
            named |= {f"{letter}_{axis}{dot}": entry for axis, entry in axes}
    return named


@cache
def derivation(name: str) -> Derivation:
    return Derivation(load(name))


@pytest.mark.long("more cases of the same kind", keep=2, daily=12)
@pytest.mark.parametrize("name", names())
def test_latex_read_back_has_the_values_of_the_derivation(name: str) -> None:
    d, random = with_letters(derivation(name)), Random(name)
    s = d.system
    moving = (*s.q, *s.qdot, *s.qddot, *s.multipliers, TIME)
    numbers = {x: random.uniform(0.2, 0.9) for x in (*s.params, *moving)}
    momenta = [complex(p.xreplace(numbers)) for p in d.momenta]
    numbers |= dict(zip(s.p, momenta, strict=True))
    numbers[sp.Symbol("omega", positive=True)] = 0.7
    state = {key_of(symbol.name): complex(x) for symbol, x in numbers.items()}
    right, compared = expected(d), 0
    for equation in document(d).equations:
        rows = " \\\\\n".join(equation_rows(equation))
        (statement,) = formulas(rf"\begin{{aligned}} {rows} \end{{aligned}} \tag{{1}}")
        assert isinstance(statement, Statement), rows
        assert len(statement.sides) == len(equation.sides)
        assert {*statement.relations} == {"="}
        if equation.value is not None:
            wanted = right[equation.before[0].replace("_sys", "")]
            printed = entries(statement.sides[len(equation.before)])
            for node, entry in zip(printed, sp.Matrix([wanted]), strict=True):
                assert cmath.isclose(
                    value(node, state), complex(entry.xreplace(numbers)), rel_tol=1e-9, abs_tol=1e-9
                ), (equation.number, rows)
                compared += 1
    assert compared > 15


@pytest.mark.parametrize("suffix", ["tex", "html", "ipynb"])
def test_every_format_is_read_as_the_same_formulas(tmp_path: Path, suffix: str) -> None:
    d = derivation("elastic_pendulum")
    (path,) = write_document(d, tmp_path / f"document.{suffix}")
    displays = [one.latex for one in read_document(path).displays if not one.is_inline]
    expected = [" \\\\\n".join(equation_rows(one)) for one in document(d).equations]
    assert [read(one) for one in displays] == [read(one) for one in expected]


def read(latex: str) -> str:
    (statement,) = formulas(latex)
    assert isinstance(statement, Statement)
    return " = ".join(map(show, statement.sides))


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.slow
@pytest.mark.parametrize("name", ["driven_pendulum", "elastic_pendulum", "cart_1"])
def test_a_document_is_verified_from_its_own_latex(tmp_path: Path, name: str) -> None:
    (path,) = write_document(derivation(name), tmp_path / "document.tex")
    verdicts = [one.verdict for one in judge_document(read_document(path)).formulas]
    assert {*verdicts} <= {"verified", "definition"}
    assert verdicts.count("verified") > len(verdicts) / 2
