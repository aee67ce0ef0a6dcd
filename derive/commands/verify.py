"""``holonomic verify EQUATIONS``: verdicts on the equations of files and systems."""

import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict

from derive.verification.hand import HandDerivation, judge
from derive.verification.verdict import table_width, verdict_rows, wrapped


def verify(names: Sequence[str], *, as_json: bool) -> int:
    """Print the verdicts; return 0, 1 if an equation is wrong, or 2 if one is unreadable."""
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
