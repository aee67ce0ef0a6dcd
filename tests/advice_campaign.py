"""Seeded mutants of correct formulas, and a judge of the printed advice on them.

The judge reads the printed text as a user does: it finds the named term in the formula,
substitutes the correction, and evaluates the result (`formula_values`). It uses nothing of
`derive.verification`.
"""

import ast
import copy
import re
import tomllib
from collections.abc import Iterator
from contextlib import redirect_stdout
from dataclasses import dataclass
from functools import cache
from io import StringIO
from pathlib import Path
from random import Random
from typing import Any

import mpmath as mp
from advice_formulas import DOCUMENTS
from formula_values import TINY, State, Truth

from solvers.app.cli import main

SCALARS = ("kinetic_energy", "potential_energy", "lagrangian", "energy", "hamiltonian")
CANONICAL = ("hamiltonian", "hamilton")
HEADER = ("system", "equal", "names")
MISTAKES = (
    "sign", "lost factor", "wrong factor", "wrong number", "index", "symbol", "function",
    "power", "lost term", "added term", "denominator",
)  # fmt: skip


@dataclass(frozen=True)
class Formula:
    """A formula of a document; the key is a coordinate, a momentum, or empty."""

    document: int
    kind: str
    key: str
    text: str


@dataclass(frozen=True)
class Mutant:
    """A formula with one mistake, and the mistaken part as it stands in the text."""

    formula: Formula
    mistake: str
    text: str
    part: str


@dataclass(frozen=True)
class Outcome:
    """The verdict on a mutant, the advice as printed, and whether it mends the formula."""

    mutant: Mutant
    verdict: str
    advice: tuple[tuple[str, str], ...]  # named terms, empty where one is missing; corrections
    mends: bool
    names_mistake: bool


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


# Mutants


def mutants(seed: int, count: int) -> Iterator[Mutant]:
    """Random mutants that are wrong by the values of `formula_values`."""
    rng, originals, known = Random(seed), list(formulas()), set()
    while count:
        formula, mistake = rng.choice(originals), rng.choice(MISTAKES)
        mutant = mutate(formula, mistake, rng)
        if mutant and mutant.text not in known and not is_right(formula, mutant.text):
            known.add(mutant.text)
            count -= 1
            yield mutant


def mutate(formula: Formula, mistake: str, rng: Random) -> Mutant | None:
    """Make one mistake at a random place; None if there is no place for it."""
    tree = ast.parse(" ".join(formula.text.replace("=", "==").split()), mode="eval")
    nodes = list(ast.walk(tree))
    places = [k for k, node in enumerate(nodes) if isinstance(node, ast.expr)]
    if mistake == "denominator":
        below = [n.right for n in nodes if isinstance(n, ast.BinOp) and isinstance(n.op, ast.Div)]
        inside = {id(node) for one in below for node in ast.walk(one)}
        places = [k for k in places if id(nodes[k]) in inside]
        mistake = rng.choice([m for m in MISTAKES if m != "denominator"])
    rng.shuffle(places)
    for place in places:
        copied = copy.deepcopy(tree)
        node = list(ast.walk(copied))[place]
        if (changed := _mistaken(node, mistake, formula, rng)) is not None:
            text = _text(_Replacement(node, changed).visit(copied))
            return Mutant(formula, mistake, text, _text(changed))
    return None


class _Replacement(ast.NodeTransformer):
    def __init__(self, old: ast.AST, new: ast.expr) -> None:
        self.old, self.new = old, new

    def visit(self, node: ast.AST) -> Any:
        return self.new if node is self.old else super().visit(node)


def _text(tree: ast.AST) -> str:
    return re.sub(r" (\*\*|\*|/) ", r"\1", ast.unparse(tree)).replace("==", "=")


def _mistaken(node: ast.AST, mistake: str, formula: Formula, rng: Random) -> ast.expr | None:
    number = ast.Constant
    match mistake, node:
        case "sign", ast.BinOp(left, ast.Add(), right):
            return ast.BinOp(left, ast.Sub(), right)
        case "sign", ast.BinOp(left, ast.Sub(), right):
            return ast.BinOp(left, ast.Add(), right)
        case "sign", ast.UnaryOp(ast.USub(), operand):
            return operand
        case "lost factor", ast.BinOp(left, ast.Mult(), right):
            return rng.choice((left, right))
        case "lost factor", ast.BinOp(left, ast.Div(), _):
            return left
        case "wrong factor", ast.BinOp(_, ast.Mult() | ast.Div(), _) | ast.Call():
            factor = rng.choice((number(2), number(3), ast.Name(rng.choice(_parameters(formula)))))
            return ast.BinOp(node, rng.choice((ast.Mult(), ast.Div())), factor)
        case "wrong number", ast.Constant(value):
            return number(rng.choice([n for n in (1, 2, 3, 4, 6) if n != value]))
        case "index", ast.Name(name) if re.search(r"\d", name):
            digit = re.search(r"\d", name)[0]
            known = {*re.findall(r"\w+", formula.text)}
            others = [name.replace(digit, n) for n in "123" if n != digit]
            others = [other for other in others if other in known]
            return ast.Name(rng.choice(others)) if others else None
        case "symbol", ast.Name(name) if name in _parameters(formula):
            others = [other for other in _parameters(formula) if other != name]
            return ast.Name(rng.choice(others)) if others else None
        case "function", ast.Call(ast.Name("sin" | "cos" as name), arguments):
            return ast.Call(ast.Name("cos" if name == "sin" else "sin"), arguments, [])
        case "power", ast.BinOp(left, ast.Pow(), _):
            return rng.choice((left, ast.BinOp(left, ast.Pow(), number(3))))
        case "lost term", ast.BinOp(left, ast.Add(), right):
            return rng.choice((left, right))
        case "lost term", ast.BinOp(left, ast.Sub(), right):
            return rng.choice((left, ast.UnaryOp(ast.USub(), right)))
        case "added term", ast.BinOp(_, ast.Mult() | ast.Div() | ast.Add(), _) | ast.Call():
            names = rng.sample(_parameters(formula), 1)
            extra = ast.BinOp(ast.Name(names[0]), ast.Mult(), copy.deepcopy(node))
            return ast.BinOp(node, rng.choice((ast.Add(), ast.Sub())), extra)
    return None


def _parameters(formula: Formula) -> list[str]:
    """The names of constants in the formula."""
    one = truth(formula.document)
    words = {*re.findall(r"[A-Za-z_]\w*", formula.text)}
    symbols = {p.name for p in one.system.params}
    own = {w for w, text in one.names.items() if {*re.findall(r"[A-Za-z]\w*", text)} <= symbols}
    return sorted(words & ((symbols - {*one.names}) | own)) or ["1"]


# Truth


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


def _close(a: Any, b: Any, *terms: Any) -> bool:
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
    states += [one.state(rng, {p.name: states[0][p.name] for p in one.system.params})]
    given = [one.evaluate(text, state) for state in states]
    true = [_true_value(one, formula, state) for state in states]
    if formula.kind in ("potential_energy", "energy", "hamiltonian"):  # up to a constant
        return _close(given[1] - given[0], true[1] - true[0], *given)
    return all(map(_close, given, true))


def _is_lagrangian(one: Truth, formula: Formula, text: str, rng: Random) -> bool:
    """Whether the equations of motion are those of the derivation, by numeric derivatives."""
    state, n = one.state(rng), len(one.q)
    names = [*one.q, *(f"{q}_dot" for q in one.q), "t"]
    point = [state[name] for name in names]

    def lagrangian(*values: Any) -> Any:
        return one.evaluate(text, {**state, **dict(zip(names, values, strict=True))})

    if _close(lagrangian(*point), one.value("lagrangian", state)):
        return True
    accelerations = mp.matrix([state[f"{q}_ddot"] for q in one.q])
    true = one.value("mass", state) * accelerations - mp.matrix(one.value("forcing", state))
    applied = one.value("applied", state)
    rates = [*(state[f"{q}_dot"] for q in one.q), *accelerations, 1]

    def derivative(*variables: int) -> Any:
        return mp.diff(lagrangian, point, tuple(variables.count(k) for k in range(2 * n + 1)))

    for i in range(n):
        terms = (rate * derivative(n + i, k) for k, rate in enumerate(rates))
        if abs(sum(terms) - derivative(i) - applied[i] - true[i]) > 1e-9 * (1 + abs(true[i])):
            return False
    return True


def _moves_rightly(one: Truth, formula: Formula, text: str, rng: Random) -> bool:
    """Whether the equation holds along motions, and not with other accelerations."""
    left, _, right = text.partition("=")
    state = one.state(rng)
    motion = {f"{q}_ddot": a for q, a in zip(one.q, one.accelerations(state), strict=True)}
    sides = [one.evaluate(side, {**state, **motion}) for side in (left, right)]
    others = [one.evaluate(side, state) for side in (left, right)]
    return _close(*sides, mp.mpf(1)) and not _close(*others)


# Advice


def outcome(mutant: Mutant, path: Path) -> Outcome:
    """Print the verdict on a mutant, and follow its advice."""
    path.write_text(_document(mutant), encoding="utf-8")
    with redirect_stdout(StringIO()) as printed:
        main(["verify", str(path)])
    verdict, advice = read_advice(printed.getvalue())
    mended = substituted(mutant, advice) if advice else []
    mends = bool(mended) and all(is_right(mutant.formula, text) for text in mended)
    return Outcome(mutant, verdict, advice, mends, _is_named(mutant, advice))


def _document(mutant: Mutant) -> str:
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
        return all(_close(one.evaluate(a, state), one.evaluate(b, state)) for a, b in pairs)
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
