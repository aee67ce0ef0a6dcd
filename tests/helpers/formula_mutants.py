"""Random mistakes in formulas: signs, factors, numbers, indices, functions, powers and terms."""

import ast
import copy
import re
from collections.abc import Iterator
from dataclasses import dataclass
from random import Random
from typing import Any

from formula_truth import Formula, formulas, is_right, truth

MISTAKES = (
    "sign", "lost factor", "wrong factor", "wrong number", "index", "symbol", "function",
    "power", "lost term", "added term", "denominator",
)  # fmt: skip


@dataclass(frozen=True)
class Mutant:
    """A formula with one mistake, and the mistaken part as it stands in the text."""

    formula: Formula
    mistake: str
    text: str
    part: str


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
