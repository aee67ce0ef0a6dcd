"""``holonomic verify EQUATIONS``: what was found about each equation, in words or as JSON."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict

from derive.verification.hand.equations import HandDerivation, judge


def verify(names: Sequence[str], *, as_json: bool) -> int:
    """Judge files, or the published equations of systems; print; return the exit code.

    Parameters
    ----------
    names : sequence of str
        Paths that end in ``.toml``, and names of systems.
    as_json : bool
        Whether to print JSON instead of words.

    Returns
    -------
    int
        0 if all equations are right, 1 if one is wrong, 2 if one cannot be read.

    Raises
    ------
    InputError
        When a file is no hand derivation, or a system has no published equations.
    ExpressionError
        When a parameter is set to what is no formula.
    UnknownSystemError
        When a name, or the system that a file names, is not that of a system.
    SystemDefinitionError
        When a file is about a system whose own file is wrong.
    """
    found = [judge(name) for name in names]
    if as_json:
        print(json.dumps([asdict(one) for one in found], indent=2, ensure_ascii=False))
    else:
        print("\n\n".join("\n".join(told(one)) for one in found))
    verdicts = {judgement.verdict for one in found for judgement in one.judgements}
    return 2 if "unreadable" in verdicts else int("wrong" in verdicts)


def told(hand: HandDerivation) -> Iterator[str]:
    """The verdicts, and of what is wrong the reason and the correction."""
    yield ": ".join(filter(None, (hand.system, hand.source)))
    if hand.note:
        yield f"  {hand.note}"
    for one in hand.judgements:
        yield f"  {one.verdict:<11} {one.place}{': ' if one.note else ''}{one.note}"
        rows = {"written": one.printed}
        if one.should_be:
            rows["wrong"] = f"{one.term}, which should be {one.should_be}"
            if not one.term:
                rows["wrong"] = f"a term is missing: {one.should_be}"
        rows |= {"in numbers": one.witness, "right": one.correction}
        if one.verdict in ("wrong", "unreadable"):
            yield from (f"      {title}: {text}" for title, text in rows.items() if text)
