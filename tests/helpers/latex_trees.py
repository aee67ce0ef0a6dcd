"""Syntax trees of formulas as short text, for tests of the reader of LaTeX."""

from derive.reading.latex.tree import (
    Application,
    AtPlace,
    Call,
    Derivative,
    Dotted,
    Letter,
    Matrix,
    Node,
    Norm,
    Number,
    Power,
    Product,
    Quotient,
    Root,
    Statement,
    Sum,
    Summation,
    Transpose,
    Tuple,
    Unreadable,
)


def show(node: Node | Statement | Unreadable) -> str:
    """A tree as text: ``l theta.^2`` has a letter with one dot, ``[a / b]`` is a quotient."""
    match node:
        case Number():
            return node.digits
        case Letter():
            marks = "." * node.dots + "'" * node.primes
            return ("bold " if node.is_bold else "") + node.identifier + marks
        case Sum():
            signs = "".join(
                f" {'+' if sign > 0 else '-'} {show(term)}" for sign, term in node.terms
            )
            return f"({signs.removeprefix(' + ').strip()})"
        case Product():
            return " ".join(map(show, node.factors))
        case Quotient():
            return f"[{show(node.numerator)} / {show(node.denominator)}]"
        case Power():
            return f"{tight(node.base)}^{tight(node.exponent)}"
        case Root():
            return f"root{node.degree}{brackets(node.radicand)}"
        case Call():
            return node.function + brackets(node.argument)
        case Application():
            return f"{show(node.head)}@({', '.join(map(show, node.arguments))})"
        case Derivative():
            variables = ", ".join(map(show, node.variables))
            return f"{'∂' if node.is_partial else 'd'}({show(node.operand)}; {variables})"
        case Dotted():
            return f"dots{node.dots}{brackets(node.operand)}"
        case Matrix():
            return f"[{'; '.join(', '.join(map(show, row)) for row in node.rows)}]"
        case Tuple():
            return f"<{', '.join(map(show, node.items))}>"
        case Transpose():
            return f"{tight(node.operand)}^T"
        case Norm():
            return f"|{show(node.operand)}|"
        case AtPlace():
            return f"at({show(node.operand)})"
        case Summation():
            parts = (node.index, node.lower, node.upper)
            index, lower, upper = ("" if part is None else show(part) for part in parts)
            return f"sum({show(node.body)}; {index} = {lower}..{upper})"
        case Statement():
            pairs = zip(node.relations, map(show, node.sides[1:]), strict=True)
            return show(node.sides[0]) + "".join(f" {sign} {side}" for sign, side in pairs)
        case Unreadable():
            return f"unreadable: {node.reason}"


def brackets(node: Node) -> str:
    return show(node) if isinstance(node, Sum) else f"({show(node)})"


def tight(node: Node) -> str:
    return f"({show(node)})" if isinstance(node, Product | Power | Transpose) else show(node)
