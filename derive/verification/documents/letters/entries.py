"""Matrices and columns of a document by their entries: M of M_11, M_12, …, and f of f_1, f_2."""

import re
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import sympy as sp

#: Names of an entry: a letter and one index, or two.
ENTRY = re.compile(r"([A-Za-z]+)_(\d)(?:_?(\d))?\Z")


def matrices_by_entries(names: Iterable[str]) -> frozenset[str]:
    """Letters that have entries in two rows and columns."""
    result: dict[str, set[tuple[str, str]]] = {}
    for name in names:
        if (match := ENTRY.match(name)) and match[3]:
            result.setdefault(match[1], set()).add((match[2], match[3]))
    return frozenset(
        letter for letter, places in result.items() if {("1", "1"), ("2", "2")} <= places
    )


def composed(
    words: Iterable[str], namespace: Mapping[str, Any], count: int
) -> Iterator[tuple[str, sp.ImmutableDenseMatrix]]:
    """Yield the names of matrices and columns without a value whose entries have one."""
    matrices = matrices_by_entries(namespace)
    for name in words:
        letter = name.removesuffix("_column")
        if name in namespace or "_" in letter:
            continue
        if letter in matrices:
            yield name, _matrix(letter, namespace, count)
        elif name != letter:
            column = [namespace.get(f"{letter}_{k + 1}") for k in range(count)]
            if all(isinstance(one, sp.Expr) for one in column):
                yield name, sp.ImmutableDenseMatrix(column)


def _matrix(letter: str, namespace: Mapping[str, Any], count: int) -> sp.ImmutableDenseMatrix:
    """A matrix whose entries that are not written are those of its transpose, or zero."""

    def entry(i: int, j: int) -> sp.Expr:
        places = ((i + 1, j + 1), (j + 1, i + 1))
        names = [f"{letter}_{a}{between}{b}" for a, b in places for between in ("", "_")]
        return next((namespace[name] for name in names if name in namespace), sp.S.Zero)

    return sp.ImmutableDenseMatrix(count, count, entry)
