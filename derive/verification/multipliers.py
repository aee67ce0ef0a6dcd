"""The multipliers of a source: their names, and the signs and factors with which it uses them."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import sympy as sp

from derive.formulas.expression import Scope
from derive.formulas.syntax import ExpressionError
from derive.system.system import System
from derive.verification.engine import Context
from derive.verification.model import Model
from derive.verification.terms import difference

#: A source may write a constraint times one of these factors.
FACTORS = (*map(sp.Integer, (1, -1, 2, -2)), sp.S.Half, -sp.S.Half)


def with_multipliers(model: Model, equations: Sequence[str]) -> Model:
    """The model with the usual names of multipliers, with which most equations hold."""
    system = model.derivation.system
    if not system.conditions or not equations:
        return model
    motions = model.motions

    def holding(names: Scope) -> int:
        return sum(_holds(motions, text, {**motions.scope, **names}) for text in equations)

    found = max(usual_names(system), key=holding)
    return replace(model, names={**found, **model.names})


def usual_names(system: System) -> Iterator[Scope]:
    """Names of the multipliers with each of the factors."""
    for factor in FACTORS:
        names = {f"lambda_{k}": factor * one for k, one in enumerate(system.multipliers, 1)}
        if len(names) == 1:
            names["lambda"] = names["lambda_1"]
        yield names


def _holds(motions: Context, text: str, scope: Scope) -> bool:
    try:
        return motions.is_small(difference(text, scope))
    except ExpressionError:
        return False
