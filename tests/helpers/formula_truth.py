"""Correct formulas of textbooks, and whether a text in place of one is right, in numbers."""

import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from random import Random
from typing import Any

import mpmath as mp
from advice_formulas import DOCUMENTS
from formula_values import TINY, State, Truth

SCALARS = ("kinetic_energy", "potential_energy", "lagrangian", "energy", "hamiltonian")
HEADER = ("system", "equal", "names")


@dataclass(frozen=True)
class Formula:
    """A formula of a document; the key is a coordinate, a momentum, or empty."""

    document: int
    kind: str
    key: str
    text: str


def formulas() -> Iterator[Formula]:
    for number, document in enumerate(DOCUMENTS):
        for kind, value in tomllib.loads(document).items():
            if kind in SCALARS:
                yield Formula(number, kind, "", value)
            elif kind not in HEADER:
                rows = value.items() if isinstance(value, dict) else (("", text) for text in value)
                yield from (Formula(number, kind, key, text) for key, text in rows)


@cache
def truth(document: int) -> Truth:
    return Truth(tomllib.loads(DOCUMENTS[document]))


def is_right(formula: Formula, text: str) -> bool:
    """Whether the formula, with `text` in place of its own, is right at random states."""
    one, rng = truth(formula.document), Random(1)
    check = {"euler_lagrange": _moves_rightly, "lagrangian": _is_lagrangian}.get(
        formula.kind, _has_right_values
    )
    try:
        return all(check(one, formula, text, rng) for _ in range(3))
    except (ArithmeticError, KeyError, TypeError, ValueError, SyntaxError):
        return False


def close(a: Any, b: Any, *terms: Any) -> bool:
    return bool(abs(a - b) <= TINY * max(map(abs, (a, b, *terms, mp.mpf("1e-6")))))


def _true_value(one: Truth, formula: Formula, state: State) -> Any:
    kind, names = formula.kind, {**{q: q for q in one.q}, **one.names}
    if kind in ("momenta", "accelerations", "hamilton"):
        is_force = formula.key not in names
        index = one.q.index(names[formula.key.removeprefix("p_") if is_force else formula.key])
        if kind == "momenta":
            return state[f"p_{one.q[index]}"]
        if kind == "accelerations":
            return one.accelerations(state)[index]
        return one.value("force", state)[index] if is_force else state[f"{one.q[index]}_dot"]
    return one.value("energy" if kind == "hamiltonian" else kind, state)


def _has_right_values(one: Truth, formula: Formula, text: str, rng: Random) -> bool:
    states = [one.state(rng)]
    states.append(one.another(rng, states[0]))
    given = [one.evaluate(text, state) for state in states]
    true = [_true_value(one, formula, state) for state in states]
    if formula.kind not in ("potential_energy", "energy", "hamiltonian"):
        return all(map(close, given, true))
    # a function of parameters and time exerts no force; T + V is an energy, too
    totals = [sum(one.value(k, s) for k in SCALARS[:2]) for s in states]
    accepted = (true, totals) if formula.kind == "energy" else (true,)
    return any(close(given[1] - given[0], b - a, *given) for a, b in accepted)


def _is_lagrangian(one: Truth, formula: Formula, text: str, rng: Random) -> bool:
    """Whether the equations of motion are those of the derivation, times a constant."""
    state = one.state(rng)
    pairs = _equations(one, text, state) + _equations(one, text, one.another(rng, state))
    factor = pairs[0][0] / pairs[0][1]
    if any(abs(own - factor * true) > 1e-9 * (1 + abs(own)) for own, true in pairs):
        return False
    return bool(abs(factor - 1) < 1e-9 or (factor > 0 and not any(one.value("applied", state))))


def _equations(one: Truth, text: str, state: State) -> list[tuple[Any, Any]]:
    """d/dt ∂L/∂q̇ - ∂L/∂q by numeric derivatives, and as derived."""
    names = [*one.q, *(f"{q}_dot" for q in one.q), "t"]
    point, n = [state[name] for name in names], len(one.q)

    def lagrangian(*values: Any) -> Any:
        return one.evaluate(text, {**state, **dict(zip(names, values, strict=True))})

    def derivative(*variables: int) -> Any:
        return mp.diff(lagrangian, point, tuple(variables.count(k) for k in range(2 * n + 1)))

    accelerations = mp.matrix([state[f"{q}_ddot"] for q in one.q])
    true = one.value("mass", state) * accelerations - mp.matrix(one.value("forcing", state))
    true += mp.matrix(one.value("applied", state))
    rates = [*(state[f"{q}_dot"] for q in one.q), *accelerations, 1]
    return [
        (sum(rate * derivative(n + i, k) for k, rate in enumerate(rates)) - derivative(i), true[i])
        for i in range(n)
    ]


def _moves_rightly(one: Truth, formula: Formula, text: str, rng: Random) -> bool:
    """Whether the equation holds along motions, and not with other accelerations."""
    left, _, right = text.partition("=")
    state = one.state(rng)
    motion = {f"{q}_ddot": a for q, a in zip(one.q, one.accelerations(state), strict=True)}
    sides = [one.evaluate(side, {**state, **motion}) for side in (left, right)]
    others = [one.evaluate(side, state) for side in (left, right)]
    return close(*sides, mp.mpf(1)) and not close(*others)
