"""``holonomic verify EQUATIONS``: verdicts on the equations of files and systems."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict

from derive.verification.hand.reading import HandDerivation, judge
from derive.verification.table import table_width, verdict_rows, wrapped


def verify(names: Sequence[str], *, as_json: bool) -> int:
    """Judge files, or the published equations of systems, and print the verdicts.

    Parameters
    ----------
    names : sequence of str
        Paths that end in ``.toml``, and names of systems.
    as_json : bool
        Whether to print JSON instead of a table.

    Returns
    -------
    int
        Exit code: 0 if all equations are correct, 1 if one is wrong, 2 if one is unreadable.

    Raises
    ------
    InputError
        When a file is invalid, or a system has no published equations.
    ExpressionError
        When the value of a parameter is not a formula.
    UnknownSystemError
        When no system has one of the names.
    SystemDefinitionError
        When the file of a system is invalid.
    """
    derivations = [judge(name) for name in names]
    if as_json:
        print(json.dumps(list(map(asdict, derivations)), indent=2, ensure_ascii=False))
    else:
        print("\n\n".join("\n".join(_lines(one, table_width())) for one in derivations))
    verdicts = {equation.verdict for one in derivations for equation in one.equations}
    return 2 if "unreadable" in verdicts else int("wrong" in verdicts)


def _lines(derivation: HandDerivation, width: int) -> Iterator[str]:
    yield wrapped(": ".join(filter(None, (derivation.system, derivation.source))), width, 0)
    if derivation.note:
        yield wrapped(derivation.note, width, 0)
    yield from verdict_rows(derivation.equations, width)
