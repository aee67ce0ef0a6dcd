"""The names of a source: formulas in the names of the system, with derivatives and momenta."""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any
from unicodedata import normalize

import sympy as sp

from derive.formulas.expression import Namespace, Value, parse
from derive.formulas.syntax import ExpressionError
from derive.system.symbols import TIME
from derive.system.system import System
from derive.verification.judging.engine import Context
from derive.verification.judging.reference_system import (
    ReferenceSystem,
    depends_on,
    own_names,
    time_derivative,
)
from derive.verification.judging.terms import difference
from solvers.io.toml_input import InputError


def meanings(names: Mapping[str, str], system: System) -> dict[str, Any]:
    """Parse the source's names, and define derivatives and momenta that are not among them."""
    own, given = own_names(system), {}
    for printed, text in names.items():
        name = normalised(printed)
        if not name.isidentifier():
            raise InputError(f"names: {printed[:50]!r} is no name: use letters, digits and _")
        given[name] = parsed(f"names.{name}", text, own)
    derived: dict[str, Any] = {}
    for name, value in given.items():
        rate, moving = value, depends_on(value, (*system.q, *system.qdot, TIME))
        for order in ("dot", "ddot"):
            if moving and not depends_on(rate, (*system.qddot, *system.p)):
                derived[f"{name}_{order}"] = rate = time_derivative(system, rate)
        if coordinate := _coordinate(system, value):
            q, p = coordinate
            derived[f"p_{name}"] = p / value.diff(q)
    return derived | given


def normalised(name: str) -> str:
    """A name as in a formula, where Python's parser normalises it."""
    return normalize("NFKC", name)


def parsed(
    key: str, text: str, namespace: Namespace, read: Callable[[str, Namespace], Value] = parse
) -> Value:
    """The value of the formula at a key of a file; an `InputError` names the key."""
    try:
        return read(text, namespace)
    except ExpressionError as error:
        raise InputError(f"{key}: {error}") from error


def names_of_coordinates(kind: str, model: ReferenceSystem) -> list[str]:
    """Names of coordinates and of functions of them; for Hamilton's equations also of momenta.

    Functions of several coordinates have accelerations, but no momentum.
    """
    system, namespace = model.derivation.system, model.context.namespace
    names = dict.fromkeys([*(q.name for q in system.q), *model.names])
    if kind == "accelerations":
        return [name for name in names if _is_position(system, namespace[name])]
    single = [name for name in names if _coordinate(system, namespace[name])]
    return [*single, *(f"p_{name}" for name in single)] if kind == "hamilton" else single


def _coordinate(system: System, value: Value) -> tuple[sp.Symbol, sp.Symbol] | None:
    """The coordinate of which `value` is a function, and its momentum; None for other values."""
    own = [pair for pair in zip(system.q, system.p, strict=True) if depends_on(value, pair)]
    return own[0] if len(own) == 1 and _is_position(system, value) else None


def _is_position(system: System, value: Value) -> bool:
    """Whether `value` is a number that depends on coordinates, and at most on time besides."""
    others = (*system.qdot, *system.qddot, *system.p)
    is_number = not isinstance(value, sp.MatrixBase)  # a column is an expression, too
    return is_number and depends_on(value, system.q) and not depends_on(value, others)


#: A name in a formula.
WORD = re.compile(r"\w+")
#: A source may write a constraint times one of these factors.
FACTORS = (*map(sp.Integer, (1, -1, 2, -2)), sp.S.Half, -sp.S.Half)


def with_multipliers(model: ReferenceSystem, equations: Sequence[str]) -> ReferenceSystem:
    """The model with the usual names of multipliers, with which most equations hold."""
    system = model.derivation.system
    if not system.conditions or not equations:
        return model
    named = [*usual_names(system)]
    deciding = [text for text in equations if not named[0].keys().isdisjoint(WORD.findall(text))]
    if not deciding:  # which saves their motions
        return replace(model, names={**named[0], **model.names})
    motions = model.motions

    def holding(names: Namespace) -> int:
        return sum(_holds(motions, text, {**motions.namespace, **names}) for text in deciding)

    best = max(named, key=holding)
    return replace(model, names={**best, **model.names})


def usual_names(system: System) -> Iterator[Namespace]:
    """Names of the multipliers with each of the factors."""
    for factor in FACTORS:
        names = {f"lambda_{k}": factor * one for k, one in enumerate(system.multipliers, 1)}
        if len(names) == 1:
            names["lambda"] = names["lambda_1"]
        yield names


def _holds(motions: Context, text: str, namespace: Namespace) -> bool:
    try:
        return motions.is_small(difference(text, namespace))
    except ExpressionError:
        return False
