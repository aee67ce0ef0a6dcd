"""Fortran, in free and in fixed form."""

import re
from dataclasses import replace

from derive.reading.programs.languages.language import Language

language = Language(
    name="Fortran",
    suffixes=(".f90", ".f95", ".f03", ".f08", ".F90"),
    module="tree_sitter_fortran",
    first_index=1,
    is_half_open=False,
    has_round_indices=True,
    assigns_locals=False,
    is_case_sensitive=False,
    has_whole_quotients=True,
    roles={
        "translation_unit": "block",
        "program": "block",
        "module": "block",
        "internal_procedures": "block",
        "variable_declaration": "declaration",
        "function": "function",
        "subroutine": "function",
        "function_statement": "header",
        "subroutine_statement": "header",
        "parameters": "parameters",
        "function_result": "results",
        "init_declarator": "assign",
        "assignment_statement": "assign",
        "if_statement": "branch",
        "else_clause": "otherwise",
        "elseif_clause": "otherwise",
        "select_case_statement": "choice",
        "do_loop": "loop",
        "do_loop_statement": "loop",
        "do_statement": "header",
        "keyword_statement": "keyword",
        "program_statement": "skip",
        "module_statement": "skip",
        "implicit_statement": "skip",
        "use_statement": "skip",
        "contains_statement": "skip",
        "end_program_statement": "skip",
        "end_module_statement": "skip",
        "end_function_statement": "skip",
        "end_subroutine_statement": "skip",
        "end_do_loop_statement": "skip",
        "end_if_statement": "skip",
        "derived_type_definition": "skip",
        "intrinsic_type": "skip",
        "derived_type": "skip",
        "type_qualifier": "skip",
        "kind": "skip",
        "size": "skip",
        "identifier": "name",
        "name": "name",
        "type_member": "name",
        "number_literal": "number",
        "string_literal": "text",
        "derived_type_member_expression": "member",
        "call_expression": "call",
        "subroutine_call": "call",
        "argument_list": "arguments",
        "keyword_argument": "keyword",
        "extent_specifier": "slice",
        "parenthesized_expression": "wrapper",
        "math_expression": "binary",
        "unary_expression": "unary",
        "array_literal": "array",
        "sized_declarator": "first",
    },
)

#: Lines of fixed form: comments, and those that continue the line before, even within a word.
COMMENT = re.compile(r"^[cC*].*$", re.MULTILINE)
CONTINUED = re.compile(r"(\b\w+)?\n {5}[^\s0]")


def prepared(text: str) -> str:
    """The text in free form, with the same lines."""
    return CONTINUED.sub(r"&\n      \1", COMMENT.sub("", text))


fixed_form = replace(
    language, name="Fortran 77", suffixes=(".f", ".for", ".f77"), prepared=prepared
)
