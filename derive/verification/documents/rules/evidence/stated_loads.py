"""Forces that equations of motion state beside those of a system, and what contradicts them.

Each equation with letters of applied forces is a combination of M q̈ - f = Q with Q for these:
several determine Q, with which all others must agree.
"""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from derive.formulas.expression import parse
from derive.formulas.numeric import Evaluator
from derive.formulas.syntax import ExpressionError
from derive.verification.documents.formula_translation import order
from derive.verification.documents.rules.consequences import WithVerdict
from derive.verification.documents.rules.known_values import DocumentNamespace
from derive.verification.documents.rules.roles import Roles
from derive.verification.documents.rules.side_comparison import SideComparison
from derive.verification.documents.rules.side_verdict import SideVerdict
from derive.verification.documents.rules.small_motions import SmallMotions
from derive.verification.documents.statements import WORD, DocumentFormula

#: The end of the note on an equation that holds but for letters of applied forces.
AS_FORCES = "as applied forces"
#: The largest difference of values of order 1 that counts as none.
CLOSE = 1e-9
#: Why an equation has no values: what is not understood, or a mass matrix that is singular.
FAILURES = (
    ExpressionError, NotImplementedError, TypeError, ValueError, ArithmeticError,
    np.linalg.LinAlgError,
)  # fmt: skip
#: The fewest equations of which one can contradict the others.
FEWEST = 3

Array = NDArray[np.float64]


@dataclass(frozen=True)
class _LoadEquation:
    """An equation c·(M q̈ - f - Q) = 0 by its number among the formulas."""

    number: int
    has_loads: bool
    difference: sp.Expr
    factors: Array  # c at each state
    values: Array  # c·Q

    @property
    def coordinate(self) -> int | None:
        """The number of the coordinate of which it is the equation, times a number; or None."""
        (moving,) = np.nonzero(np.abs(self.factors).max(axis=0) > CLOSE)
        is_own = len(moving) == 1 and np.ptp(self.factors[:, moving[0]]) < CLOSE
        return int(moving[0]) if is_own else None


def with_contrary_loads(
    namespace: DocumentNamespace, linear: SmallMotions, verdicts: Sequence[WithVerdict]
) -> list[WithVerdict]:
    """The verdicts, with `wrong` for an equation whose loads contradict those of all others.

    One term of it must be another one by the forces that the others state, and it combines those of
    several coordinates: with other forces, that of one can be of another case. The equation of a
    coordinate has no load if it holds without one, and no other has one.
    """
    result = [*verdicts]
    if namespace.derivation.system.conditions:
        return result
    loads = {
        word: sp.Symbol(word, real=True)
        for formula, one in verdicts
        if one.verdict.note.endswith(AS_FORCES)
        for side in formula.sides
        for word in WORD.findall(side.text)
        if word not in namespace.all_names
    }
    if not loads:
        return result
    every = _equations(namespace, loads, verdicts)
    loaded = {one.coordinate for one in every if one.has_loads}
    equations = [
        one for one in every
        if one.has_loads or (one.coordinate is not None and one.coordinate not in loaded)
    ]  # fmt: skip
    if len(equations) < FEWEST or _agree(equations):
        return result
    contrary = [
        one for k, one in enumerate(equations)
        if one.has_loads
        and _agree([*equations[:k], *equations[k + 1 :]])
    ]  # fmt: skip
    if len(contrary) == 1 and contrary[0].coordinate is None:
        (wrong,) = contrary
        forces = _forces(namespace, [one for one in equations if one is not wrong])
        formula, _ = verdicts[wrong.number]
        own = forces and _verdict(namespace, linear, formula, loads, forces)
        if own:
            result[wrong.number] = formula, own
    return result


def _equations(
    namespace: DocumentNamespace, loads: dict[str, sp.Symbol], verdicts: Sequence[WithVerdict]
) -> list[_LoadEquation]:
    """The equations of motion that hold, with loads or without."""
    d, result = namespace.derivation, list[_LoadEquation]()
    names = {**namespace.all_names, **loads}
    numbers = {s: sp.Rational(7 * k + 3, 5 * k + 4) for k, s in enumerate(loads.values())}
    rest = dict.fromkeys(d.system.qddot, sp.S.Zero)
    states = [Evaluator({**one.state, **numbers}) for one in namespace.model.context.evaluators]
    for number, (formula, one) in enumerate(verdicts):
        has_loads = one.verdict.note.endswith(AS_FORCES)
        is_exact = one.verdict.verdict == "verified" and not one.verdict.note
        is_equation = is_exact and 2 in map(order, formula.words)
        if not (has_loads or is_equation):
            continue
        with suppress(*FAILURES):
            left, right = (
                parse(side.text, names) for side in (formula.sides[0], formula.sides[-1])
            )
            difference = sp.sympify(left - right).xreplace(dict(namespace.model.momenta))
            slopes = [difference.diff(one) for one in d.system.qddot]
            factors, values = [], []
            for at in states:
                M = np.array([[_number(at, x) for x in row] for row in d.mass_matrix.tolist()])
                f = np.array([_number(at, x) for x in d.forcing])
                c = np.linalg.solve(M, [_number(at, x) for x in slopes])
                factors.append(c)
                values.append(-_number(at, difference.xreplace(rest)) - c @ f)
            if np.any(factors):
                rows = np.array(factors), np.array(values)
                result.append(_LoadEquation(number, has_loads, difference, *rows))
    return result


def _number(evaluator: Evaluator, expression: sp.Expr) -> float:
    return float(evaluator(sp.sympify(expression)).number.real)


def _agree(equations: Sequence[_LoadEquation]) -> bool:
    """Whether there are forces with which all equations hold."""
    return all(
        _residual(np.array([one.factors[k] for one in equations]),
                  np.array([one.values[k] for one in equations])) < CLOSE
        for k in range(len(equations[0].values))
    )  # fmt: skip


def _residual(factors: Array, values: Array) -> float:
    sizes = np.maximum(np.abs(factors).max(axis=1), 1e-300)
    factors, values = factors / sizes[:, np.newaxis], values / sizes
    solution = np.linalg.lstsq(factors, values, rcond=None)[0]
    return float(np.abs(factors @ solution - values).max())


def _forces(namespace: DocumentNamespace, equations: Sequence[_LoadEquation]) -> list[sp.Expr]:
    """The applied force of each coordinate by its own equation; nothing if one has none."""
    d, result = namespace.derivation, dict[int, sp.Expr]()
    rest = dict.fromkeys(d.system.qddot, sp.S.Zero)
    for one in equations:
        if (k := one.coordinate) is not None:
            factor = sp.nsimplify(one.factors[0, k], rational=True)
            value = -one.difference.xreplace(rest) / factor - d.forcing[k]
            result.setdefault(k, sp.expand(value))
    return [result[k] for k in range(len(d.system.q))] if len(result) == len(d.system.q) else []


def _verdict(
    namespace: DocumentNamespace,
    linear: SmallMotions,
    formula: DocumentFormula,
    loads: dict[str, sp.Symbol],
    forces: Sequence[sp.Expr],
) -> SideVerdict | None:
    """The verdict by stated forces, if one term of the equation is wrong."""
    own = namespace.with_forces(forces, loads)
    comparison = SideComparison(own, linear, Roles(own, linear))
    with suppress(*FAILURES):
        left, right = (own.value(one.text) for one in (formula.sides[0], formula.sides[-1]))
        result = comparison.compared(formula, formula.sides[0], formula.sides[-1], left, right)
        terms = result.verdict.corrections
        if result.verdict.verdict == "wrong" and len(terms) == 1 and terms[0].wrong:
            return result
    return None
