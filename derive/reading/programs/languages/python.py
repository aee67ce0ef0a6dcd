"""Python."""

import re

from derive.reading.programs.languages.language import Language

#: Commands of notebooks.
COMMAND = re.compile(r"^[ \t]*[%!].*$", re.MULTILINE)
#: The library VPython, in which the norm of a vector is its direction.
VPYTHON = re.compile(r"^[ \t]*(?:from|import)[ \t]+(?:vpython|visual)\b", re.MULTILINE)


def prepared(text: str) -> str:
    """The text without the commands of notebooks; directions of VPython have their other name."""
    if VPYTHON.search(text):
        text = re.sub(r"\bnorm\(", "hat (", text)
    return COMMAND.sub("", text)


language = Language(
    name="Python",
    suffixes=(".py", ".pyw"),
    module="tree_sitter_python",
    prepared=prepared,
    roles={
        "module": "block",
        "block": "block",
        "decorated_definition": "block",
        "expression_statement": "block",
        "with_statement": "block",
        "try_statement": "block",
        "finally_clause": "block",
        "class_definition": "class",
        "function_definition": "function",
        "lambda": "lambda",
        "assignment": "assign",
        "augmented_assignment": "assign",
        "named_expression": "assign",
        "conditional_expression": "conditional",
        "return_statement": "return",
        "if_statement": "branch",
        "else_clause": "otherwise",
        "elif_clause": "otherwise",
        "except_clause": "skip",
        "with_clause": "skip",
        "decorator": "skip",
        "import_statement": "skip",
        "import_from_statement": "skip",
        "global_statement": "shared",
        "nonlocal_statement": "shared",
        "match_statement": "choice",
        "for_statement": "loop",
        "while_statement": "loop",
        "identifier": "name",
        "type": "skip",
        "integer": "number",
        "float": "number",
        "string": "text",
        "attribute": "member",
        "subscript": "item",
        "slice": "slice",
        "call": "call",
        "argument_list": "arguments",
        "keyword_argument": "keyword",
        "parenthesized_expression": "wrapper",
        "binary_operator": "binary",
        "unary_operator": "unary",
        "list": "array",
        "tuple": "array",
        "expression_list": "array",
        "pattern_list": "array",
        "tuple_pattern": "array",
        "list_pattern": "array",
        "generator_expression": "comprehension",
        "list_comprehension": "comprehension",
        "dictionary": "record",
        "pair": "pair",
        "parameters": "parameters",
        "lambda_parameters": "parameters",
    },
)
