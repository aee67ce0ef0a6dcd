"""A judge of the printed advice on mutants of formulas.

It reads the printed text as a user does: it finds the named term in the formula, substitutes the
correction, and evaluates the result (`formula_truth`). It uses nothing of `derive.verification`.
"""

import re
import tomllib
from contextlib import redirect_stdout
from dataclasses import dataclass
from io import StringIO
from pathlib import Path
from random import Random

from advice_formulas import DOCUMENTS
from formula_mutants import Mutant
from formula_truth import close, is_right, truth

from solvers.app.cli import main


@dataclass(frozen=True)
class Outcome:
    """The verdict on a mutant, the advice as printed, and whether it mends the formula."""

    mutant: Mutant
    verdict: str
    advice: tuple[tuple[str, str], ...]  # named terms, empty where one is missing; corrections
    mends: bool
    names_mistake: bool


def outcome(mutant: Mutant, path: Path) -> Outcome:
    """Print the verdict on a mutant, and follow its advice."""
    path.write_text(document(mutant), encoding="utf-8")
    with redirect_stdout(StringIO()) as printed:
        main(["verify", str(path)])
    verdict, advice = read_advice(printed.getvalue())
    mended = substituted(mutant, advice) if advice else []
    mends = bool(mended) and all(is_right(mutant.formula, text) for text in mended)
    return Outcome(mutant, verdict, advice, mends, _is_named(mutant, advice))


def document(mutant: Mutant) -> str:
    formula, original = mutant.formula, tomllib.loads(DOCUMENTS[mutant.formula.document])
    header = DOCUMENTS[formula.document].strip().split("\n")[0]
    tables = [f"[{t}]\n" + "".join(f'{k} = "{v}"\n' for k, v in original[t].items())
              for t in ("equal", "names") if t in original]  # fmt: skip
    if formula.kind == "euler_lagrange":
        equation = f'euler_lagrange = ["{mutant.text}"]'
    elif formula.key:
        equation = f'{formula.kind} = {{ {formula.key} = "{mutant.text}" }}'
    else:
        equation = f'{formula.kind} = "{mutant.text}"'
    return "\n".join((header, equation, *tables))


def read_advice(printed: str) -> tuple[str, tuple[tuple[str, str], ...]]:
    """The verdict, and pairs of wrong and correct terms, from the printed lines."""
    text = " ".join(printed.split())
    titles = r"(wrong term|correct term|missing term|correct form|difference|value|state|note): "
    parts = re.split(titles, text)
    verdict = re.search(r"\b(verified|equivalent|wrong|unreadable)\b", parts[0].split("=")[0])
    pairs, wrong = [], ""
    for title, value in zip(parts[1::2], parts[2::2], strict=True):
        if title == "wrong term":
            wrong = value.strip()
        elif title in ("correct term", "missing term"):
            pairs.append((wrong if title == "correct term" else "", value.strip()))
    return verdict[0] if verdict else "", tuple(pairs)


def substituted(mutant: Mutant, advice: tuple[tuple[str, str], ...]) -> list[str]:
    """The formula with corrections in place of the named terms; several if these are ambiguous."""
    texts = [mutant.text]
    for wrong, correct in advice:
        texts = [new for text in texts for new in _replaced(mutant, text, wrong, correct)]
    return texts


def _replaced(mutant: Mutant, text: str, wrong: str, correct: str) -> list[str]:
    if not wrong:
        left, equals, right = text.partition("=")
        return [f"{left} + ({correct}){' = ' * bool(equals)}{right}"]
    pattern = r"\s*".join(map(re.escape, re.findall(r"\w+|\*\*|\S", wrong)))
    places = [m.span() for m in re.finditer(rf"(?<![\w.]){pattern}(?![\w.(])", text)]
    terms = [place for place in places if _is_term(text, *place)]
    places = [(a, b) for a, b in terms or places if _is_part(mutant, text, a, b)]
    return [f"{text[:a]}+({correct}){text[b:]}" if text[a] == "-" else
            f"{text[:a]}({correct}){text[b:]}" for a, b in places]  # fmt: skip


def _is_term(text: str, start: int, end: int) -> bool:
    """Whether a sum, a bracket or a side begins and ends here."""
    before, after = text[:start].rstrip()[-1:], text[end:].lstrip()[:1]
    return (before in "(+-=," or text[start] == "-") and after in ")+-=,"


def _is_part(mutant: Mutant, text: str, start: int, end: int) -> bool:
    """Whether brackets about the part leave the value of the formula as it is."""
    sign = "+" if text[start] == "-" else ""
    bracketed = f"{text[:start]}{sign}({text[start:end]}){text[end:]}"
    one = truth(mutant.formula.document)
    state = one.state(Random(2))
    try:
        pairs = zip(text.split("="), bracketed.split("="), strict=True)
        return all(close(one.evaluate(a, state), one.evaluate(b, state)) for a, b in pairs)
    except SyntaxError:
        return False


def _is_named(mutant: Mutant, advice: tuple[tuple[str, str], ...]) -> bool:
    """Whether a named term is, contains, or lies in the mistaken part."""
    part = "".join(mutant.part.split())
    for wrong, _ in advice:
        term = "".join(wrong.split()).removeprefix("-")
        if not wrong and mutant.mistake == "lost term":
            return True
        if wrong and (term in part or part in term):
            return True
    return False
