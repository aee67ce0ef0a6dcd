"""The numbered formulas of a document, and sums that are short to read."""

import ast
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import combinations_with_replacement, count, islice, product

import sympy as sp

from derive.formulas.syntax import is_sum, summands
from derive.formulas.typeset.line_breaks import latex_rows, width_of
from derive.handout.derived_letters import DerivedLetters
from derive.handout.document_model import WIDTH, Block, NumberedEquation, Paragraph, in_text
from derive.mechanics.energies.reduction import collected

#: Width of the left side of a column or matrix, and lines of the longest readable formula.
NAME_WIDTH, READABLE = 8, 3
#: Parts of the largest value of which the width is determined; others have hundreds in a row.
MOST_PARTS = 5000


@dataclass(frozen=True)
class Numbering:
    """Formulas in the notation of a system, numbered in the order in which they are requested."""

    notation: DerivedLetters
    numbers: Iterator[int] = field(default_factory=lambda: count(1))

    def equation(
        self,
        *before: str,
        value: sp.Expr | sp.MatrixBase,
        after: tuple[str, ...] = (),
        is_given: bool = False,
    ) -> NumberedEquation:
        """A formula with a derived side, after the sides `before` and before those `after`."""
        order = self.notation.order
        return NumberedEquation(next(self.numbers), before, value, after, order, is_given)

    def relation(self, *sides: str) -> NumberedEquation:
        """A formula between names."""
        return NumberedEquation(
            next(self.numbers), sides, None, (), self.notation.order, is_given=True
        )

    def vectors(
        self, rate: str, values: Sequence[sp.MatrixBase], *, is_given: bool = False
    ) -> Iterator[Block]:
        """Positions or velocities of the masses; by components where a column is too wide."""
        for r, value in zip(self.notation.positions, values, strict=True):
            if self.fits(value):
                yield self.equation(f"{r}_vector{rate}", value=value, is_given=is_given)
            else:
                for axis, entry in zip("xyz", value, strict=False):
                    yield self.equation(f"{r}_{axis}{rate}", value=entry, is_given=is_given)

    def column(self, name: str, value: sp.MatrixBase) -> Iterator[Block]:
        """A column; by entries where it is too wide, and a number where it has one entry."""
        if len(value) == 1:
            yield self.equation(name, value=value[0])
        elif self.fits(value):
            yield self.equation(f"{name}_vector", value=value)
        else:
            for i, entry in enumerate(value, 1):
                yield self.equation(f"{name}_{i}", value=entry)

    def matrix(self, name: str, value: sp.MatrixBase) -> Iterator[Block]:
        """A symmetric matrix; by entries where it is too wide, a number where it has one entry."""
        n = value.rows
        if n == 1:
            yield self.equation(name, value=value[0])
        elif self.fits(value):
            yield self.equation(name, value=value)
        else:
            yield Paragraph(f"`{name}` is symmetric. Entries that are not listed are zero.")
            comma = "_" if n > 9 else ""
            for i, j in combinations_with_replacement(range(n), 2):
                if value[i, j] != 0:
                    yield self.equation(f"{name}_{i + 1}{comma}{j + 1}", value=value[i, j])

    def rows(self, name: str, value: sp.MatrixBase) -> Iterator[Block]:
        """A matrix of any shape; by entries where it is too wide."""
        if self.fits(value):
            yield self.equation(name, value=value)
            return
        yield Paragraph(f"Entries of `{name}` that are not listed are zero.")
        comma = "_" if max(value.shape) > 9 else ""
        for i, j in product(range(value.rows), range(value.cols)):
            if value[i, j] != 0:
                yield self.equation(f"{name}_{i + 1}{comma}{j + 1}", value=value[i, j])

    def fits(self, value: sp.Expr | sp.MatrixBase) -> bool:
        """Whether a value fits on a line, beside its name."""
        if next(islice(sp.preorder_traversal(value), MOST_PARTS, None), None) is not None:
            return False
        return width_of(self.notation.order.tree(value)) < WIDTH - NAME_WIDTH

    def are_readable(self, values: Iterable[sp.Expr]) -> bool:
        """Whether no value is longer than `READABLE` lines, and no term of a sum than one line."""
        trees = [*map(self.notation.order.tree, values)]
        terms = (term for tree in trees if is_sum(tree) for term, _ in summands(tree))
        name = ast.Name("H", ast.Load())
        rows = (len(latex_rows([name, tree], WIDTH)) for tree in trees)
        return max(rows) <= READABLE and all(width_of(term) < WIDTH for term in terms)

    def text(self, *values: sp.Expr) -> str:
        """Values in a sentence."""
        return in_text(*map(self.notation.order.tree, values))


def tidied(expression: sp.Expr, *variables: sp.Symbol) -> sp.Expr:
    """`expression` with one term for each function of `variables`, roots and divisors unchanged.

    An expanded divisor, such as the square of l² - x², hides that it is one.
    """
    powers = {
        power: power.base
        for power in expression.atoms(sp.Pow)
        if power.base.is_Add and not (power.exp.is_Integer and power.exp > 0)
    }
    bases = sorted({*powers.values()}, key=sp.default_sort_key)
    names = {base: sp.Symbol(f"root {k}", positive=True) for k, base in enumerate(bases)}
    flat = expression.xreplace({power: names[base] ** power.exp for power, base in powers.items()})
    total = collected(flat, *variables, *names.values())
    return total.xreplace({name: base for base, name in names.items()})
