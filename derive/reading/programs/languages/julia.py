"""Julia."""

import re

from derive.reading.programs.languages.language import Language

#: A number before a name in a row of a matrix; the grammar would read their product.
NUMBER = re.compile(r"(?<![\w.])(\d[\d_]*+\.?+\d*+(?:e[+-]?\d++)?+)(?=[ \t]+[^\W\d])")
#: An operator between a number and a bracket; the grammar would read the call of a function.
OPERATOR = re.compile(r"(?<=\d)(\.?)([-+*/^])(?=\()")
#: Parameters that are types, whose calls convert numbers.
TYPES = re.compile(r"\bwhere\s+(?:\{([^{}]*)\}|(\w+))")


def prepared(text: str) -> str:
    """The text with such numbers in brackets, spaces around such operators, no conversions."""
    types = {
        word.partition("<:")[0].strip()
        for braces, single in TYPES.findall(text)
        for word in (braces or single).split(",")
    }
    for name in types:
        text = re.sub(rf"\b{re.escape(name)}(?=\()", " " * len(name), text)
    return OPERATOR.sub(r"\1 \2 ", NUMBER.sub(r"(\1)", text))


language = Language(
    name="Julia",
    suffixes=(".jl",),
    module="tree_sitter_julia",
    prepared=prepared,
    first_index=1,
    is_half_open=False,
    has_matrix_products=True,
    returns_last=True,
    has_caret_powers=True,
    roles={
        "source_file": "block",
        "module_definition": "block",
        "compound_statement": "block",
        "let_statement": "block",
        "const_statement": "block",
        "global_statement": "block",
        "local_statement": "block",
        "try_statement": "block",
        "macro_argument_list": "block",
        "macrocall_expression": "block",
        "parametrized_type_expression": "first",
        "macro_identifier": "skip",
        "struct_definition": "skip",
        "using_statement": "skip",
        "import_statement": "skip",
        "export_statement": "skip",
        "catch_clause": "skip",
        "function_definition": "function",
        "signature": "header",
        "arrow_function_expression": "lambda",
        "assignment": "assign",
        "compound_assignment_expression": "assign",
        "let_binding": "assign",
        "ternary_expression": "conditional",
        "return_statement": "return",
        "if_statement": "branch",
        "else_clause": "otherwise",
        "elseif_clause": "otherwise",
        "for_statement": "loop",
        "while_statement": "loop",
        "for_binding": "header",
        "identifier": "name",
        "integer_literal": "number",
        "float_literal": "number",
        "string_literal": "text",
        "field_expression": "member",
        "index_expression": "item",
        "call_expression": "call",
        "broadcast_call_expression": "call",
        "argument_list": "arguments",
        "named_argument": "keyword",
        "range_expression": "slice",
        "parenthesized_expression": "wrapper",
        "typed_expression": "first",
        "binary_expression": "binary",
        "juxtaposition_expression": "product",
        "unary_expression": "unary",
        "adjoint_expression": "transpose",
        "comprehension_expression": "comprehension",
        "vector_expression": "array",
        "tuple_expression": "array",
        "open_tuple": "array",
        "matrix_expression": "matrix",
    },
)
