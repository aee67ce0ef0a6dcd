"""A language: which nodes of its syntax trees have which role."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib import import_module
from time import thread_time
from typing import TYPE_CHECKING

from derive.reading.programs.program import ProgramError

if TYPE_CHECKING:
    from tree_sitter import Node, Parser

#: Some grammars need a time that grows with the square of the length of invalid text.
MAX_SECONDS = 1
#: Bytes that a parser reads at once.
CHUNK = 4096


@dataclass(frozen=True)
class Language:
    """The roles of nodes, and the few rules in which a language differs from the others.

    A role is a method of `derive.reading.programs.translation.Translator`.
    """

    name: str
    suffixes: tuple[str, ...]
    module: str  # of the grammar
    roles: Mapping[str, str]  # role of each type of node
    grammar: str = "language"  # the function of the module
    other_names: tuple[str, ...] = ()
    first_index: int = 0
    #: Whether the upper bound of a range is not an index.
    is_half_open: bool = True
    #: Whether * of matrices is their product.
    has_matrix_products: bool = False
    #: Whether ^ is a power.
    has_caret_powers: bool = False
    #: Whether a^b^c is (a^b)^c.
    has_left_powers: bool = False
    #: Whether the quotient of two whole numbers is a whole number.
    has_whole_quotients: bool = False
    #: Whether y(1) can be an entry of an array.
    has_round_indices: bool = False
    #: Whether y(1) with numbers is an entry of an array that is a variable.
    has_numbered_entries: bool = False
    #: Whether a variable that a function assigns without declaration belongs to the function.
    assigns_locals: bool = True
    #: Whether the value of a function is its last expression.
    returns_last: bool = False
    #: Whether a member of the own object is written without it.
    has_bare_members: bool = False
    is_case_sensitive: bool = True
    #: The text as the grammar reads it, with the same lines.
    prepared: Callable[[str], str] = field(default=lambda text: text)

    def parse(self, text: str) -> "Node":
        """The syntax tree of a program; `ProgramError` if there is no parser, or if it is slow."""
        parser, source = _parser(self.module, self.grammar), self.prepared(text).encode()
        end = thread_time() + MAX_SECONDS
        try:
            tree = parser.parse(
                lambda start, _: source[start : start + CHUNK],
                progress_callback=lambda *_: thread_time() > end,
            )
        except ValueError as error:
            parser.reset()
            reason = f"the program takes more than {MAX_SECONDS} s to parse"
            raise ProgramError(f"{reason}: is it written in {self.name}?") from error
        return tree.root_node


@cache
def _parser(module: str, grammar: str) -> "Parser":
    try:
        import tree_sitter

        language = getattr(import_module(module), grammar)()
    except ImportError as error:
        message = "programs are read with tree-sitter: pip install 'holonomic[documents]'"
        raise ProgramError(f"{message} ({error})") from error
    return tree_sitter.Parser(tree_sitter.Language(language))
