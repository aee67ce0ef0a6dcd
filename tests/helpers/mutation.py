"""Mutations of formulas: another sign, operation, function or power."""

import ast


def is_constant(node: ast.BinOp) -> bool:
    """Whether the operation has constant operands, which Python and C fold."""
    return isinstance(node.left, ast.Constant) and isinstance(node.right, ast.Constant)


class Mutation(ast.NodeTransformer):
    """Apply the `index`-th of the possible mutations; `count` is the number of those visited."""

    def __init__(self, index: int) -> None:
        self.index, self.count = index, 0

    def _applies(self) -> bool:
        self.count += 1
        return self.count - 1 == self.index

    def visit_BinOp(self, node: ast.BinOp) -> ast.AST:
        self.generic_visit(node)
        if is_constant(node):
            return node
        if isinstance(node.op, ast.Pow):
            return node.left if self._applies() else node
        other = {ast.Add: ast.Sub(), ast.Sub: ast.Add(), ast.Mult: ast.Add(), ast.Div: ast.Mult()}
        return ast.BinOp(node.left, other[type(node.op)], node.right) if self._applies() else node

    def visit_UnaryOp(self, node: ast.UnaryOp) -> ast.AST:
        self.generic_visit(node)
        if isinstance(node.operand, ast.Constant):
            return node  # a negative number is not an operation
        return node.operand if self._applies() else node

    def visit_Call(self, node: ast.Call) -> ast.AST:
        self.generic_visit(node)
        other = {"sin": "cos", "cos": "sin"}.get(getattr(node.func, "id", ""))
        if not other or not self._applies():
            return node
        return ast.Call(ast.Name(other, ast.Load()), node.args, [])
