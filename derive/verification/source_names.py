"""The names of a formula, and expressions of its system written with them."""

import ast
from collections.abc import Iterator
from typing import Any

import sympy as sp

from derive.formulas.expression import Scope, parse
from derive.formulas.syntax import syntax_tree


class SourceNames:
    """The names that the sides of a formula use, as symbols that print as written."""

    def __init__(self, text: str, scope: Scope) -> None:
        self._scope, self._sides = scope, [syntax_tree(side) for side in text.split("=")]
        used = {node.id for node in self.nodes() if isinstance(node, ast.Name)}
        self._written: dict[str, Any] = {
            word: sp.Symbol(word, real=True) if isinstance(value, sp.Expr) else value
            for word, value in scope.items()
        } | {"pi": sp.pi}
        #: The names in the formula.
        self.names = [self._written[w] for w in sorted(used) if isinstance(scope.get(w), sp.Expr)]
        words = [word for word, value in scope.items() if isinstance(value, sp.Symbol)]
        # the rate of a momentum of a unit mass is an acceleration, which has a name
        words = [word for word in words if word in used or not _is_rate_of_momentum(word, scope)]
        # later ones prevail: names of the source, and above all those in the formula
        words.sort(key=lambda word: (word in used, word != scope[word].name))
        #: The symbols of the system, as the formula writes them.
        self.symbols = {scope[word]: self._written[word] for word in words}

    def nodes(self) -> Iterator[ast.AST]:
        """Yield all parts of the formula."""
        for side in self._sides:
            yield from ast.walk(side)

    def parse(self, text: str) -> sp.Expr:
        """A formula with its own names as symbols."""
        return parse(text, self._written)

    def write(self, expression: sp.Expr) -> sp.Expr:
        """An expression of the system in the names of the formula."""
        return expression.xreplace(self.symbols)

    def meaning(self, written: sp.Expr) -> sp.Expr:
        """A formula in the symbols of the system."""
        names = {s: self._scope[s.name] for s in written.free_symbols if s.name in self._scope}
        return written.xreplace(names)


def _is_rate_of_momentum(word: str, scope: Scope) -> bool:
    return word.endswith("_dot") and word.startswith("p_") and word[: -len("_dot")] in scope
