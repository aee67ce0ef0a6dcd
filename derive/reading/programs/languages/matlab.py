"""MATLAB and Octave."""

import re

from derive.reading.programs.languages.language import Language

#: Ends of blocks in Octave, and assignments with an operator.
END = re.compile(r"\bend(?:function|if|while|for|_try_catch)\b")
CHANGED = re.compile(r"^([ \t]*)(\w[\w.()]*)[ \t]*([-+*/])=[ \t]*([^;\n%#]*)", re.MULTILINE)
COMMENT = re.compile(r"^([ \t]*)#", re.MULTILINE)


def prepared(text: str) -> str:
    """The words of Octave in those of MATLAB."""
    text = COMMENT.sub(r"\1%", END.sub("end", text))
    return CHANGED.sub(r"\1\2 = \2 \3 (\4)", text)


language = Language(
    name="MATLAB",
    suffixes=(".m",),
    module="tree_sitter_matlab",
    other_names=("Octave",),
    prepared=prepared,
    first_index=1,
    is_half_open=False,
    has_matrix_products=True,
    has_round_indices=True,
    has_caret_powers=True,
    has_left_powers=True,
    roles={
        "source_file": "block",
        "block": "block",
        "try_statement": "block",
        "methods": "block",
        "class_definition": "class",
        "function_definition": "function",
        "function_output": "results",
        "function_arguments": "parameters",
        "lambda": "lambda",
        "assignment": "assign",
        "if_statement": "branch",
        "else_clause": "otherwise",
        "elseif_clause": "otherwise",
        "switch_statement": "choice",
        "for_statement": "loop",
        "while_statement": "loop",
        "iterator": "header",
        "return_statement": "return",
        "command": "skip",
        "catch_clause": "skip",
        "global_operator": "skip",
        "persistent_operator": "skip",
        "properties": "skip",
        "identifier": "name",
        "number": "number",
        "string": "text",
        "field_expression": "member",
        "function_call": "call",
        "arguments": "arguments",
        "range": "slice",
        "spread_operator": "all",
        "handle_operator": "first",
        "parenthesis": "wrapper",
        "binary_operator": "binary",
        "unary_operator": "unary",
        "postfix_operator": "transpose",
        "matrix": "matrix",
        "multioutput_variable": "array",
    },
)
