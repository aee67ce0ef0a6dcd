"""Mistakes planted into the text of formulas: another sign, operation, function or power."""

import ast


def is_constant(node: ast.BinOp) -> bool:
    """Whether it is a fraction, which Python and C compute when they read it."""
    return isinstance(node.left, ast.Constant) and isinstance(node.right, ast.Constant)


class Planted(ast.NodeTransformer):
    """Plant one mistake, the `place`-th of those that are possible; `seen` counts the places."""

    def __init__(self, place: int) -> None:
        self.place, self.seen = place, 0

    def _here(self) -> bool:
        self.seen += 1
        return self.seen - 1 == self.place

    def visit_BinOp(self, node: ast.BinOp) -> ast.AST:
        self.generic_visit(node)
        if is_constant(node):
            return node
        if isinstance(node.op, ast.Pow):
            return node.left if self._here() else node
        other = {ast.Add: ast.Sub(), ast.Sub: ast.Add(), ast.Mult: ast.Add(), ast.Div: ast.Mult()}
        return ast.BinOp(node.left, other[type(node.op)], node.right) if self._here() else node

    def visit_UnaryOp(self, node: ast.UnaryOp) -> ast.AST:
        self.generic_visit(node)
        if isinstance(node.operand, ast.Constant):
            return node  # a negative number, no operation
        return node.operand if self._here() else node

    def visit_Call(self, node: ast.Call) -> ast.AST:
        self.generic_visit(node)
        other = {"sin": "cos", "cos": "sin"}.get(getattr(node.func, "id", ""))
        return (
            ast.Call(ast.Name(other, ast.Load()), node.args, []) if other and self._here() else node
        )
