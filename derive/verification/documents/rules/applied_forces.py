"""Equations of motion with terms whose letters have no meaning, such as D u and F."""

import ast
from collections.abc import Collection
from dataclasses import replace

from derive.formulas.syntax import ExpressionError, summands, syntax_tree
from derive.verification.documents.formula_translation import FormulaText
from derive.verification.documents.statements import WORD, DocumentFormula


def without_unknown_terms(
    formula: DocumentFormula, unknown: Collection[str]
) -> DocumentFormula | None:
    """The formula without all terms with unknown letters; None if other parts have some."""
    try:
        trees = [_reduced(syntax_tree(one.text), unknown) for one in formula.sides]
    except ExpressionError:
        return None
    # in x' = f(x, u) = ..., f is another name of the last side
    known = [one for one in trees if one is not None]
    texts = [*map(ast.unparse, known), *["0"] * (2 - len(known))]
    if any(name in WORD.findall(text) for text in texts for name in unknown):
        return None
    relations = formula.relations[: len(texts) - 1]
    return replace(formula, sides=tuple(map(FormulaText, texts)), relations=relations)


def _reduced(node: ast.expr, unknown: Collection[str]) -> ast.expr | None:
    """The tree without the terms with unknown names in sums; None if nothing is left."""
    terms = summands(node)
    if terms == [(node, 1)]:
        return _inside(node, unknown)
    known = [(one, sign) for term, sign in terms if (one := _reduced(term, unknown)) is not None]
    if not known:
        return None
    (first, sign), *others = reversed(known)
    result = first if sign > 0 else ast.UnaryOp(ast.USub(), first)
    for one, sign in others:
        result = ast.BinOp(result, ast.Add() if sign > 0 else ast.Sub(), one)
    return result


def _inside(node: ast.expr, unknown: Collection[str]) -> ast.expr | None:
    """A term with its sums reduced; None if it contains an unknown name elsewhere."""
    match node:
        case ast.Name(id=name):
            return None if name in unknown else node
        case ast.Constant():
            return node
        case ast.BinOp(left=left, op=op, right=right):
            a, b = _reduced(left, unknown), _reduced(right, unknown)
            return ast.BinOp(a, op, b) if a is not None and b is not None else None
        case ast.UnaryOp(op=op, operand=operand):
            inner = _reduced(operand, unknown)
            return ast.UnaryOp(op, inner) if inner is not None else None
        case ast.Call(func=function, args=arguments, keywords=[]):
            inner_arguments = [_reduced(one, unknown) for one in arguments]
            if all(one is not None for one in inner_arguments):
                return ast.Call(function, inner_arguments, [])  # type: ignore[arg-type]
            return None
        case ast.Tuple(elts=items, ctx=ctx):
            entries = [_reduced(one, unknown) or ast.Constant(0) for one in items]
            return ast.Tuple(entries, ctx)
    return (
        None
        if {one.id for one in ast.walk(node) if isinstance(one, ast.Name)} & {*unknown}
        else node
    )
