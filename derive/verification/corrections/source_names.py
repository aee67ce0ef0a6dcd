"""The names of a formula, and expressions of its system written with them."""

import ast
from collections.abc import Iterable, Iterator
from typing import Any

import sympy as sp

from derive.formulas.expression import FUNCTIONS, Namespace, parse
from derive.formulas.syntax import syntax_tree


class SourceNames:
    """The names that the sides of a formula use, as symbols that print as written."""

    def __init__(self, text: str, namespace: Namespace) -> None:
        self._namespace, self._sides = namespace, [syntax_tree(side) for side in text.split("=")]
        used = {node.id for node in self.nodes() if isinstance(node, ast.Name)}
        self._written: dict[str, Any] = {
            word: sp.Symbol(word, real=True) if isinstance(value, sp.Expr) else value
            for word, value in namespace.items()
        } | {"pi": sp.pi}
        #: The names in the formula.
        self.names = [
            self._written[w] for w in sorted(used) if isinstance(namespace.get(w), sp.Expr)
        ]
        words = [word for word, value in namespace.items() if isinstance(value, sp.Symbol)]
        # the rate of a momentum of a unit mass is an acceleration, which has a name
        words = [
            word for word in words if word in used or not _is_rate_of_momentum(word, namespace)
        ]
        # later ones prevail: names of the source, and above all those in the formula
        words.sort(key=lambda word: (word in used, word != namespace[word].name))
        #: The symbols of the system, as the formula writes them.
        self.symbols = {namespace[word]: self._written[word] for word in words}

    def quantities(self, others: Iterable[sp.Symbol]) -> dict[str, sp.Expr]:
        """The names in the formula, and `others`, with the values that they stand for.

        Operators such as ``ddt(a)`` are not computed from the names in them: `others` should then
        contain the symbols of the formula's value.
        """
        known = {str(name): self._namespace[str(name)] for name in self.names if not name.is_number}
        known = {name: x for name, x in known.items() if not isinstance(x, sp.MatrixBase)}
        symbols = {value: name for name, value in known.items() if value.is_Symbol}
        symbols = {symbol: str(self.write(symbol)) for symbol in others} | symbols
        own = {name: symbol for symbol, name in symbols.items()}
        return own | {name: value for name, value in known.items() if not value.is_number}

    @property
    def has_operators(self) -> bool:
        """Whether the formula contains operators, such as derivatives."""
        calls = (node.func for node in self.nodes() if isinstance(node, ast.Call))
        return any(isinstance(one, ast.Name) and one.id not in FUNCTIONS for one in calls)

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
        names = {
            s: self._namespace[s.name] for s in written.free_symbols if s.name in self._namespace
        }
        return written.xreplace(names)


def _is_rate_of_momentum(word: str, namespace: Namespace) -> bool:
    return word.endswith("_dot") and word.startswith("p_") and word[: -len("_dot")] in namespace
