"""Values of formulas as a reader with a calculator finds them, independent of the verification.

Formulas are evaluated in 30 digits at random states; names of the source are followed along a
path through the state, which gives their derivatives. The derivation supplies the true values:
numbers of T, V, M and f, from which everything else follows.
"""

import ast
from collections.abc import Callable
from functools import cache, cached_property, partial
from random import Random
from types import CodeType
from typing import Any

import mpmath as mp
import sympy as sp

from derive import Derivation, load
from derive.mechanics.specialisation import substituted
from derive.system.symbols import TIME

State = dict[str, Any]
ARITHMETIC = {
    name: getattr(mp, name) for name in ("sin", "cos", "tan", "exp", "log", "sqrt", "mpf")
}
ARITHMETIC["__builtins__"] = {}
#: Relative difference of equal values.
TINY = mp.mpf(10) ** -14
mp.mp.dps = 30


class Truth:
    """The system of a document, its true values, and random states."""

    def __init__(self, document: dict[str, Any]) -> None:
        self.names: dict[str, str] = document.get("names", {})
        system = load(document["system"])
        symbols = {p.name: p for p in system.params}
        equal = document.get("equal", {}).items()
        self.system = substituted(
            system, {symbols[a]: symbols[b] if b in symbols else sp.Integer(b) for a, b in equal}
        )
        self.q = [q.name for q in self.system.q]

    def state(self, rng: Random, constants: State | None = None) -> State:
        """A random state: parameters, time, coordinates, velocities, accelerations, momenta."""

        def uniform(low: float, high: float) -> Any:
            return mp.mpf(rng.uniform(low, high))

        state = {p.name: uniform(0.7, 1.7) for p in self.system.params} | {"t": uniform(0.2, 0.9)}
        state |= constants or {}
        for q in self.system.q:
            sign = 1 if q.is_positive else rng.choice((-1, 1))
            state[q.name] = sign * uniform(0.2, 0.6)
            for suffix in ("_dot", "_ddot"):
                state[q.name + suffix] = rng.choice((-1, 1)) * uniform(0.3, 1.2)
        for name, p in zip(self.q, self.value("momenta", state), strict=True):
            state[f"p_{name}"] = p
        return state

    def value(self, quantity: str, state: State) -> Any:
        """A quantity of the derivation at a state: a number, or a list."""
        function = self._functions[quantity]
        value = function(*(state[name] for name in self._arguments))
        return list(value) if isinstance(value, mp.matrix) and quantity != "mass" else value

    def another(self, rng: Random, state: State) -> State:
        """A state with the same parameters at the same time."""
        names = [p.name for p in self.system.params]
        return self.state(rng, {name: state[name] for name in (*names, "t")})

    def accelerations(self, state: State) -> list[Any]:
        return list(mp.lu_solve(self.value("mass", state), mp.matrix(self.value("forcing", state))))

    @cached_property
    def _arguments(self) -> list[str]:
        s = self.system
        return [symbol.name for symbol in (*s.params, *s.q, *s.qdot, *s.qddot, TIME)]

    @cached_property
    def _functions(self) -> dict[str, Callable[..., Any]]:
        d, s = Derivation(self.system), self.system
        values = {
            "kinetic_energy": d.kinetic_energy, "potential_energy": d.potential_energy,
            "lagrangian": d.lagrangian, "energy": d.energy, "mass": d.mass_matrix,
            "forcing": d.forcing, "momenta": d.momenta,
            "force": sp.Matrix([d.lagrangian.diff(q) for q in s.q]) + sp.Matrix(s.applied),
            "applied": sp.Matrix(s.applied),
        }  # fmt: skip
        arguments = (*s.params, *s.q, *s.qdot, *s.qddot, TIME)
        return {name: sp.lambdify(arguments, one, "mpmath") for name, one in values.items()}

    def evaluate(self, text: str, state: State) -> Any:
        """The value of a formula of the source."""
        code, words = _compiled(text)
        return eval(code, {word: self._meaning(word, state) for word in words} | ARITHMETIC)

    def _meaning(self, word: str, state: State) -> Any:
        if word in self.names:
            return self._own(self.names[word], state)
        for order, suffix in enumerate(("_dot", "_ddot"), 1):
            if (base := word.removesuffix(suffix)) != word and base in self.names:
                path = partial(self._along, self.names[base], state)
                return mp.diff(path, 0, order)
        if word.startswith("p_") and word[2:] in self.names:
            return self._momentum(self.names[word[2:]], state)
        return state[word]

    def _momentum(self, text: str, state: State) -> Any:
        """The momentum of a function of one coordinate."""
        for q in self.q:
            slope = mp.diff(lambda x, q=q: self._own(text, {**state, q: x}), state[q])
            if slope:
                return state[f"p_{q}"] / slope
        raise KeyError(text)

    def _own(self, text: str, state: State) -> Any:
        """The value of a formula in the names of the system."""
        code, words = _compiled(text)
        return eval(code, {word: state[word] for word in words} | ARITHMETIC)

    def _along(self, text: str, state: State, s: Any) -> Any:
        """The value after the time `s`, at constant accelerations."""
        moved = {**state, "t": state["t"] + s}
        for q in self.q:
            moved[q] += s * state[f"{q}_dot"] + s**2 * state[f"{q}_ddot"] / 2
            moved[f"{q}_dot"] += s * state[f"{q}_ddot"]
        return self._own(text, moved)


@cache
def _compiled(text: str) -> tuple[CodeType, frozenset[str]]:
    """A formula with numbers of 30 digits, and the names in it."""
    tree = ast.parse(" ".join(text.split()), mode="eval")
    words = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant):
            node.value = mp.mpf(str(node.value))
    return compile(ast.unparse(tree), text, "eval"), frozenset(words - {*ARITHMETIC})
