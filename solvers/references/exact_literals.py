"""Generated functions that compute with all digits of their literals, instead of floats.

A quotient such as ``1.0/3.0`` is rounded to double precision before it meets another number, and a
literal with forty digits when it is read: a series with more digits would not notice.
"""

import __future__

import ast
import inspect
from collections.abc import Callable
from decimal import Decimal
from functools import cache
from textwrap import dedent
from types import CodeType
from typing import Any

#: The name of the function that takes the text of a literal, and flags of the compiler.
LITERAL, FLAGS = "_literal", __future__.annotations.compiler_flag


def with_exact_literals(
    function: Callable[..., Any], number: Callable[[Decimal], Any]
) -> Callable[..., Any]:
    """A generated function in which `number` takes the place of each literal with a point.

    A function without source, or with variables of another function, stays as it is.
    """
    code = _code(function)
    if code is None:
        return function
    namespace = {**function.__globals__, LITERAL: lambda text: number(Decimal(text))}
    exec(code, namespace)  # the text of a function that is executed anyway
    result: Callable[..., Any] = namespace[function.__name__]
    return result


@cache
def _code(function: Callable[..., Any]) -> CodeType | None:
    """The definition of a function, compiled with calls in place of its literals."""
    try:
        source = dedent(inspect.getsource(function))
        tree = ast.parse(source)
    except (OSError, TypeError, SyntaxError):
        return None
    if not isinstance(tree.body[0], ast.FunctionDef) or inspect.getclosurevars(function).nonlocals:
        return None
    tree = ast.fix_missing_locations(_Literals(source).visit(tree))
    return compile(tree, function.__module__, "exec", FLAGS, dont_inherit=True)


class _Literals(ast.NodeTransformer):
    """Replaces literals of type float in a text by calls with their digits."""

    def __init__(self, source: str) -> None:
        self._source = source

    def visit_Constant(self, node: ast.Constant) -> ast.expr:
        if not isinstance(node.value, float):
            return node
        text = ast.Constant(ast.get_source_segment(self._source, node))
        return ast.copy_location(ast.Call(ast.Name(LITERAL, ast.Load()), [text], []), node)
