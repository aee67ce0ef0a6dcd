"""The statements of a document: formulas with their place, translated."""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from derive.reading.latex.tree import (
    Application,
    Derivative,
    Letter,
    Matrix,
    Node,
    Number,
    Product,
    Span,
    Statement,
    Tuple,
    Unreadable,
    has_index,
    indexed,
    letters,
    nodes,
)
from derive.verification.documents.formula_translation import (
    FormulaText,
    FormulaTranslator,
    LetterNotation,
    UntranslatableError,
    order,
    stem,
)

WORD = re.compile(r"[A-Za-z_]\w*")
#: Components of positions.
COMPONENT = re.compile(r"[xyzXYZ](?:_\w+)?\Z")
#: The square of a name.
SQUARE = re.compile(r"(\w+)\*\*2")
#: Words for quantities that do not change.
CONSTANT = ("const", "constant", "konst", "konstant", "constante", "costante")
#: Relations of statements that can hold or not.
EQUALITIES = ("=", ":=", "~")
#: The display of statements that are not written.
IMPLIED = -1
#: Letters that stand for numbers as an index.
INDICES = ("i", "j")


@dataclass(frozen=True)
class Occurrence:
    """A statement as read, and its display: 0 in a line of text."""

    display: int
    line: int
    column: int
    cell: int  # of a notebook
    start: int  # of the display's LaTeX in the text of the file
    latex: str  # of the display
    tree: Statement | Unreadable
    prose: str = ""  # of the sentence around the display

    @property
    def source(self) -> str:
        """The LaTeX of the statement."""
        return self.latex[slice(*self.tree.span)].strip()

    @property
    def sides(self) -> tuple[Node, ...]:
        """The sides of the statement; none if it is unreadable."""
        return self.tree.sides if isinstance(self.tree, Statement) else ()

    @property
    def relations(self) -> tuple[str, ...]:
        """The relations between the sides."""
        return self.tree.relations if isinstance(self.tree, Statement) else ()

    @property
    def span(self) -> Span:
        """Its place in the text of the file."""
        start, end = self.tree.span
        return self.start + start, self.start + end


@dataclass(frozen=True)
class DocumentFormula:
    """A statement with its sides in our syntax; `index` is the number that an index stands for."""

    occurrence: Occurrence
    sides: tuple[FormulaText, ...]
    relations: tuple[str, ...]
    index: int = 0
    #: Whether it is a special case of a parameter, such as the critical speed omega**2 = g/R.
    is_special: bool = False

    @cached_property
    def words(self) -> tuple[str, ...]:
        """All names in the formula, also of functions, in the order of their first use."""
        result = (word for side in self.sides for word in WORD.findall(side.text))
        return tuple(dict.fromkeys(result))

    @property
    def text(self) -> str:
        """The formula in our syntax."""
        pieces = [self.sides[0].text]
        for relation, side in zip(self.relations, self.sides[1:], strict=True):
            pieces += [relation, side.text]
        return " ".join(pieces)

    @property
    def is_value(self) -> bool:
        """Whether its last side is a number, as in phi = pi."""
        return {*WORD.findall(self.sides[-1].text)} <= {"pi"}

    @property
    def is_update(self) -> bool:
        """Whether it is a step in time, such as x = x + h*x_dot, and no equation."""
        first, last = self.sides[0].text, self.sides[-1].text
        is_next = first.isidentifier() and stem(first).endswith("_plus_1")
        return is_next or (first.isidentifier() and last.startswith((f"{first} + ", f"{first} - ")))

    @property
    def subject(self) -> str:
        """The name on the left of an equation, or "" if there is a formula."""
        first = self.sides[0].text
        is_equation = self.relations[:1] in (("=",), (":=",))
        return first if is_equation and first.isidentifier() else ""


@dataclass(frozen=True)
class Translated:
    """All statements of a document, those without a translation, and the derivatives in them."""

    formulas: tuple[DocumentFormula, ...]
    failures: tuple[tuple[Occurrence, str], ...]
    derivatives: Mapping[str, tuple[str, tuple[str, ...]]]


def translated(occurrences: Sequence[Occurrence]) -> Translated:
    """Translate the statements of a document."""
    translator = FormulaTranslator(notation(occurrences))
    formulas, failures = list[DocumentFormula](), list[tuple[Occurrence, str]]()
    for occurrence in occurrences:
        try:
            formulas += _formulas(occurrence, translator)
        except (UntranslatableError, RecursionError) as error:
            failures.append((occurrence, str(error)))
    special = tuple(_with_special_cases(formulas))
    return Translated(special, tuple(failures), translator.derivatives)


def _with_special_cases(formulas: Sequence[DocumentFormula]) -> Iterator[DocumentFormula]:
    """Yield the formulas; those of squares define no letters of energies above."""
    moving = set[str]()
    for formula in formulas:
        square = SQUARE.fullmatch(formula.sides[0].text)
        yield replace(formula, is_special=bool(square and square[1] in moving))
        if {*map(order, formula.words)} == {0, 1} and not order(formula.subject):
            moving.update(formula.words)


def _formulas(occurrence: Occurrence, translator: FormulaTranslator) -> Iterator[DocumentFormula]:
    sides, relations = occurrence.sides, occurrence.relations
    if any(map(_is_at_one_time, sides)):
        raise UntranslatableError("it states a value at one time")
    index = next((one for one in INDICES if has_index(sides, one)), "")
    numbers = range(1, translator.notation.count + 1) if index else (0,)
    for number in numbers:
        written = [indexed(side, index, number) if index else side for side in sides]
        texts = [translator.text(side) for side in written]
        pairs = [*zip(("=", *relations), texts, strict=True)]
        if len(texts) > 2:
            pairs = [one for one in pairs if one[1].text not in CONSTANT]
        yield DocumentFormula(
            occurrence, tuple(text for _, text in pairs), tuple(one for one, _ in pairs[1:]), number
        )


def notation(occurrences: Iterable[Occurrence]) -> LetterNotation:
    """What letters are, from all statements."""
    trees = [side for occurrence in occurrences for side in occurrence.sides]
    plain = FormulaTranslator()
    everything = [letter for tree in trees for letter in letters(tree)]
    dotted = {letter.name for letter in everything if letter.dots}
    primed = any(letter.primes for letter in everything)
    # a letter with dots and with primes has its rates in both notations, if one is the second
    marked = {letter.name for letter in everything if letter.primes and letter.dots}
    twice = {letter.name for letter in everything if letter.primes == 2}
    both = (dotted & twice) - marked
    indices = [int(one.index) for one in everything if one.index.isdecimal() and one.name in dotted]
    # letters that move, or by which a function is differentiated, are its arguments
    varied: dict[str, set[str]] = {}
    for node in (one for tree in trees for one in nodes(tree)):
        if isinstance(node, Derivative) and isinstance(node.operand, Letter):
            names = {one.name for one in node.variables if isinstance(one, Letter)}
            varied.setdefault(plain.name(node.operand), {*dotted}).update(names)
    functions = {
        name
        for tree in trees
        for node in nodes(tree)
        if isinstance(node, Application)
        and _are_arguments(node.arguments, varied.get(name := plain.name(node.head), dotted))
    }
    of_letters = {
        plain.name(node.head)
        for tree in trees
        for node in nodes(tree)
        if isinstance(node, Application)
        and not _is_time(node.arguments)
        and all(isinstance(one, Letter) for one in node.arguments)
    }
    matrices: set[str] = set()
    for _ in range(3):
        for occurrence in occurrences:
            first, *others = occurrence.sides
            if isinstance(first, Letter) and any(_is_matrix(side, matrices) for side in others):
                matrices.add(plain.name(first))
    count = max(indices, default=1)
    return LetterNotation(
        frozenset(functions),
        frozenset(functions - of_letters),
        frozenset(matrices),
        min(count, 9),
        primed and not dotted,
        frozenset(dotted - marked if both else ()),
    )


def _is_at_one_time(side: Node) -> bool:
    r"""Whether a side is the value of a function at a time, such as ``\\theta(0)`` of a start."""
    if not isinstance(side, Application) or len(side.arguments) != 1:
        return False
    (argument,) = side.arguments
    is_start = isinstance(argument, Letter) and (argument.name, argument.index) == ("t", "0")
    return isinstance(argument, Number) or is_start


def _is_time(arguments: Sequence[Node]) -> bool:
    return [getattr(one, "identifier", "") for one in arguments] == ["t"]


def _are_arguments(arguments: Sequence[Node], moving: set[str]) -> bool:
    """Whether brackets hold arguments of a function: letters that move, or time."""
    return all(isinstance(one, Letter) for one in arguments) and any(
        one.name in moving or one.identifier == "t" for one in arguments if isinstance(one, Letter)
    )


def _is_matrix(node: Node, matrices: set[str]) -> bool:
    match node:
        case Matrix() | Tuple():
            return True
        case Letter():
            return FormulaTranslator().name(node) in matrices
        case Product(factors=factors):
            columns = [_is_matrix(one, matrices) for one in factors]
            return sum(columns) == 1
    return False


def values_last(formulas: Iterable[DocumentFormula]) -> list[DocumentFormula]:
    """The formulas with those behind the others that state numbers, as phi = pi at a place does."""
    return sorted(formulas, key=lambda one: one.is_value)


def definitions(formula: DocumentFormula) -> Iterator[tuple[str, str]]:
    """Names that a formula can define, and their formulas."""
    first, *others = formula.sides
    is_place = not order(formula.subject) and not COMPONENT.match(formula.subject)
    if formula.is_special or (is_place and [one.text for one in others] == ["0"]):
        return  # such as a height h = 0 where V vanishes
    if formula.subject:
        yield from ((formula.subject, side.text) for side in others)
    if square := SQUARE.fullmatch(first.text):  # a frequency, usually
        yield from ((square[1], f"sqrt({side.text})") for side in others)
    if first.entries:
        for side in others:
            for name, entry in zip(first.entries, side.entries, strict=False):
                yield name.text, entry.text
    last = formula.sides[-1].text
    if {*formula.relations} == {"="} and last.isidentifier():
        yield last, formula.sides[0].text
