"""Syntax trees of formulas: text is parsed by Python's parser, and never executed."""

import ast
import keyword
import re

#: The relations between the sides of a statement.
RELATION = re.compile(r"(>=|<=|=|>|<)")

#: Words of Python's grammar, which are names in a formula, such as lambda.
KEYWORD = re.compile(rf"\b(?:{'|'.join(keyword.kwlist)})\b")
#: From an ASCII letter to the wide letter that Python's parser normalises to it.
WIDE = 0xFEE0

#: Characters of the longest formula.
MAX_LENGTH = 20_000


class ExpressionError(ValueError):
    """Invalid formula; the message names the invalid part and the allowed syntax."""


def syntax_tree(text: str) -> ast.expr:
    """Return the syntax tree of a formula."""
    if len(text) > MAX_LENGTH:
        raise ExpressionError(f"a formula has {len(text)} characters; at most {MAX_LENGTH} allowed")
    text = text.strip()
    if not text:
        raise ExpressionError("a formula is empty: write one, such as 0")
    for character in "#\n\\":
        if character in text:
            raise ExpressionError(f"{character!r} has no meaning in a formula: {text[:80]!r}")
    source = python_source(text)
    try:
        tree = ast.parse(source, mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        raise ExpressionError(f"cannot parse {text[:80]!r} as a formula: {error}") from None
    line = source.encode()  # columns are counted in bytes
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant):
            # the digits, since the value is already rounded; `kind` is free but for text
            node.kind = line[node.col_offset : node.end_col_offset].decode()
    return tree


def is_sum(node: ast.expr) -> bool:
    """Whether a part of a formula is a sum or a difference."""
    return isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add | ast.Sub)


def summands(node: ast.expr) -> list[tuple[ast.expr, int]]:
    """The terms of a sum and their signs; brackets behind a sign stay whole."""
    terms: list[tuple[ast.expr, int]] = []
    while isinstance(node, ast.BinOp) and is_sum(node):
        terms.append((node.right, 1 if isinstance(node.op, ast.Add) else -1))
        node = node.left
    match node:
        case ast.UnaryOp(op=ast.USub(), operand=operand) if not is_sum(operand):
            terms.append((operand, -1))
        case _:
            terms.append((node, 1))
    return terms[::-1]


def place(text: str, node: ast.expr) -> tuple[int, int]:
    """Where a part of a formula begins and ends in its text, which may have spaces around it."""
    stripped = text.lstrip()
    spaces, line = len(text) - len(stripped), python_source(stripped).encode()
    columns = node.col_offset, node.end_col_offset  # counted in bytes
    start, end = (spaces + len(line[:column].decode()) for column in columns)
    return start, end


def python_source(text: str) -> str:
    """The formula as Python's parser reads it; columns of a syntax tree are those of this text."""
    # with a wide letter, the parser reads a keyword as a name, and normalises it
    return KEYWORD.sub(lambda word: chr(ord(word[0][0]) + WIDE) + word[0][1:], text)
