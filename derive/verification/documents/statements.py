"""The statements of a document: formulas with their place, translated."""

import ast
import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from derive.formulas.syntax import ExpressionError, summands, syntax_tree
from derive.reading.latex.tree import (
    Application,
    Derivative,
    Letter,
    Matrix,
    Node,
    Number,
    Power,
    Product,
    Span,
    Statement,
    Summation,
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
    identifier,
    is_derivative,
    order,
    stem,
)

WORD = re.compile(r"(?<![\d.])[A-Za-z_]\w*")
#: The letter of gravity.
GRAVITY = "g"
#: Names of Cartesian components.
POINT = re.compile(r"([xyzXYZ])(?:_?(\w+))?\Z")
#: The square of a name.
SQUARE = re.compile(r"(\w+)\*\*2")
#: Names of an entry of a matrix or column: a letter and two indices, or one.
ENTRY = re.compile(r"([A-Za-z]+)_(\d)(?:_?(\d))?\Z")
#: Words for quantities that do not change.
CONSTANT = re.compile(r"[ck]onst(?:ante?)?|costante|cte|cste?", re.IGNORECASE)
#: The name of one such quantity.
OWN_CONSTANT = re.compile(rf"(?:{CONSTANT.pattern})_\d+", re.IGNORECASE)
#: Relations of statements that can hold or not.
EQUALITIES = ("=", ":=", "~")
#: The display of statements that are not written.
IMPLIED = -1
#: The start of names of coordinates of which a document has the velocities alone.
PLACE = "place_"
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
    is_plain: bool = False  # in plain text

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
    is_special_case: bool = False
    #: Whether a side states that the others do not change, such as ``= const``.
    is_conserved: bool = False
    #: Whether it is a statement with ± and one of these signs.
    has_two_signs: bool = False

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
    def is_displacement(self) -> bool:
        """Whether a name is a value of its own and another letter, as theta = theta_0 + eta."""
        name, last = self.subject, self.sides[-1].text
        return bool(name and re.fullmatch(rf"{name}_\w+ [+-] \w+|\w+ [+-] {name}_\w+", last))

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


#: Names such as ``dL_dtheta``, with the operand and the variables.
Derivatives = Mapping[str, tuple[str, tuple[str, ...]]]


@dataclass(frozen=True)
class Translated:
    """All statements of a document, those without a translation, and the derivatives in them."""

    formulas: tuple[DocumentFormula, ...]
    failures: tuple[tuple[Occurrence, str], ...]
    derivatives: Derivatives
    elsewhere: frozenset[DocumentFormula] = frozenset()  # formulas of other parts

    def part(self, formulas: Sequence[DocumentFormula]) -> "Translated":
        """Some of the formulas as a part of the document, with the derivatives in them."""
        elsewhere = frozenset(self.formulas).difference(formulas)
        words = {word for one in formulas for word in one.words}
        derivatives = {name: one for name, one in self.derivatives.items() if name in words}
        return Translated(tuple(formulas), self.failures, derivatives, elsewhere)


def translated(occurrences: Sequence[Occurrence]) -> Translated:
    """Translate the statements of a document."""
    translator = FormulaTranslator(notation(occurrences))
    formulas, failures = list[DocumentFormula](), list[tuple[Occurrence, str]]()
    for occurrence in occurrences:
        try:
            formulas += _formulas(occurrence, translator)
        except (UntranslatableError, RecursionError) as error:
            failures.append((occurrence, str(error)))
    return Translated(tuple(_with_special_cases(formulas)), tuple(failures), translator.derivatives)


def _with_special_cases(formulas: Sequence[DocumentFormula]) -> Iterator[DocumentFormula]:
    """Yield the formulas; squares of letters of energies above are special cases.

    These letters are parameters: no formula states their values or rates.
    """
    stated = {stem(one.subject) for one in formulas}
    stated.update(stem(word) for one in formulas for word in one.words if order(word))
    moving = set[str]()
    for formula in formulas:
        square = SQUARE.fullmatch(formula.sides[0].text)
        is_special_case = square and square[1] in moving - stated
        yield replace(formula, is_special_case=True) if is_special_case else formula
        if {*map(order, formula.words)} == {0, 1} and not order(formula.subject):
            moving.update(formula.words)


def _formulas(occurrence: Occurrence, translator: FormulaTranslator) -> Iterator[DocumentFormula]:
    yield from _with_sides(occurrence, occurrence.sides, translator)
    if isinstance(occurrence.tree, Statement) and (lower := occurrence.tree.other_sides):
        yield from _with_sides(occurrence, lower, translator)


def _with_sides(
    occurrence: Occurrence, sides: tuple[Node, ...], translator: FormulaTranslator
) -> Iterator[DocumentFormula]:
    relations = occurrence.relations
    others = [k for k, one in enumerate(relations) if one not in EQUALITIES]
    is_curvature = any(letter.primes > 1 for letter in letters(sides[0]))  # at a place, usually
    if others and others[0] and not is_curvature:  # such as > 0 behind an equation
        sides, relations = sides[: others[0] + 1], relations[: others[0]]
    if any(map(_is_at_one_time, sides)):
        raise UntranslatableError("it states a value at one time")
    index = next((one for one in INDICES if has_index(sides, one)), "")
    numbers = range(1, translator.notation.count + 1) if index else (0,)
    for number in numbers:
        written = [indexed(side, index, number) if index else side for side in sides]
        texts = [translator.text(side) for side in written]
        pairs = [*zip(("=", *relations), texts, strict=True)]
        constants = [one for one in pairs if OWN_CONSTANT.fullmatch(one[1].text)]
        if len(texts) > 2:
            pairs = [one for one in pairs if one not in constants]
        own = tuple(text for _, text in pairs)
        between = tuple(one for one, _ in pairs[1:])
        has_two_signs = bool(getattr(occurrence.tree, "other_sides", ()))
        yield DocumentFormula(
            occurrence, own, between, number,
            is_conserved=bool(constants), has_two_signs=has_two_signs,
        )  # fmt: skip


def notation(occurrences: Iterable[Occurrence]) -> LetterNotation:
    """What letters are, from all statements."""
    occurrences = [*occurrences]
    trees = [side for occurrence in occurrences for side in occurrence.sides]
    plain = FormulaTranslator()
    everything = [letter for tree in trees for letter in letters(tree)]
    dotted = {letter.name for letter in everything if letter.dots}
    primed = any(letter.primes for letter in everything)
    # a letter with dots and with primes has its rates in both notations, if one is the second
    marked = {letter.name for letter in everything if letter.primes and letter.dots}
    twice = {letter.name for letter in everything if letter.primes == 2}
    slopes = set[str]().union(*(_slope_variables(one.sides) for one in occurrences))
    both = set[str]() if slopes else (dotted & twice) - marked
    indices = [int(one.index) for one in everything if one.index.isdecimal() and one.name in dotted]
    # letters that move, or by which a function is differentiated, are its arguments
    varied: dict[str, set[str]] = {}
    for node in (one for tree in trees for one in nodes(tree)):
        if isinstance(node, Derivative) and isinstance(node.operand, Letter):
            names = {one.name for one in node.variables if isinstance(one, Letter)}
            varied.setdefault(plain.name(node.operand), {*dotted}).update(names)
    raised = {id(base) for tree in trees for base in _raised_rates(tree)}
    behind_gravity = [] if GRAVITY in varied else [*_behind_gravity(trees)]
    numbered = {one.name for one in everything if one.index.isdecimal()} & dotted
    columns = {
        GRAVITY
        for one in behind_gravity
        if isinstance(one.arguments[0], Letter)
        and not one.arguments[0].index
        and one.arguments[0].name in numbered
    }
    if not columns:
        raised |= {id(one) for one in behind_gravity}
    functions = {
        name
        for tree in trees
        for node in nodes(tree)
        if isinstance(node, Application)
        and id(node) not in raised
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
            if {*occurrence.relations} - {*EQUALITIES}:
                continue  # an interval is no row
            if isinstance(first, Letter) and any(_is_matrix(side, matrices) for side in others):
                matrices.add(plain.name(first))
    count = max(indices, default=1)
    generic = {letter.name for letter in everything if letter.index in INDICES}
    return LetterNotation(
        frozenset(functions),
        frozenset(functions - of_letters),
        frozenset(matrices),
        min(count, 9),
        bool(indices) or len(dotted - generic) < 2,
        primed and not dotted and not slopes,
        frozenset(dotted - marked if both else ()),
        moving=frozenset(dotted),
        slope=min(slopes) if len(slopes) == 1 and slopes <= dotted else "",
        columns=frozenset(columns),
    )


def _slope_variables(sides: Sequence[Node]) -> set[str]:
    """The letters but time of total derivatives beside primes."""
    if not any(letter.primes for letter in letters(sides)):
        return set()
    total = (one for one in nodes(sides) if isinstance(one, Derivative) and not one.is_partial)
    variables = {one for node in total for one in node.variables if isinstance(one, Letter)}
    return {identifier(one) for one in variables if one.name != "t"}


def _is_at_one_time(side: Node) -> bool:
    r"""Whether a side is the value of a function at a time, such as ``\\theta(0)`` of a start."""
    if not isinstance(side, Application) or len(side.arguments) != 1:
        return False
    (argument,) = side.arguments
    names = [("t", "0"), ("infty", "")]
    is_named = isinstance(argument, Letter) and (argument.name, argument.index) in names
    return isinstance(argument, Number) or is_named


def _raised_rates(tree: Node) -> Iterator[Application]:
    r"""Letters before a rate in brackets with an exponent, ``m (\dot\theta)^2``: factors."""
    for node in nodes(tree):
        if isinstance(node, Power) and isinstance(node.base, Application):
            arguments = node.base.arguments
            if len(arguments) == 1 and isinstance(arguments[0], Letter) and arguments[0].dots:
                yield node.base


def _behind_gravity(trees: Sequence[Node]) -> Iterator[Application]:
    """Brackets behind g, if it stands without brackets elsewhere.

    They hold a factor, as in ``m g(x)``, or a column of which g is a function, as in ``g(q)``.
    """
    everything = [node for tree in trees for node in nodes(tree)]
    own = [
        one
        for one in everything
        if isinstance(one, Application)
        and isinstance(one.head, Letter)
        and one.head.identifier == GRAVITY
        and len(one.arguments) == 1
        and not _is_time(one.arguments)
    ]
    count = sum(isinstance(one, Letter) and one.identifier == GRAVITY for one in everything)
    if count > len(own):
        yield from own


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


def general_statements(statements: Translated) -> tuple[DocumentFormula, ...]:
    """The formulas before one that sets parameters in them equal; nothing if none does.

    Such as m_1 = m_2 = m, with which an exchange of their indices changes no value.
    """
    formulas = statements.formulas
    moving = {stem(word) for one in formulas for word in one.words if order(word)}
    for number, formula in enumerate(formulas):
        names = {side.text for side in formula.sides}
        used = [names.intersection(one.words) for one in formulas[:number]]
        is_equality = {*formula.relations} == {"="} and names.isdisjoint(moving)
        if is_equality and all(map(str.isidentifier, names)) and max(map(len, used), default=0) > 1:
            return formulas[:number]
    return ()


def definitions(formula: DocumentFormula) -> Iterator[tuple[str, str]]:
    """Names that a formula can define, and their formulas."""
    first, *others = formula.sides
    is_zero = [one.text for one in others] == ["0"]  # as a height h = 0 where V vanishes
    is_letter = not order(formula.subject) and not POINT.match(formula.subject)
    is_letter &= not is_matrix_entry(formula.subject)
    if formula.is_special_case or formula.has_two_signs or (is_zero and is_letter):
        return
    if formula.subject:
        yield from ((formula.subject, side.text) for side in others)
    if square := SQUARE.fullmatch(first.text):  # a frequency, usually
        yield from ((square[1], f"sqrt({side.text})") for side in others)
    if first.entries:
        for side in others:
            for name, entry in zip(first.entries, side.entries, strict=False):
                yield name.text, entry.text
    yield from entries_of_chain(formula)
    last = formula.sides[-1].text
    if {*formula.relations} == {"="} and last.isidentifier():
        yield last, formula.sides[0].text
        # k_3 of k_1 = k_2 = k_3 = k
        yield from ((side.text, first.text) for side in others[1:-1] if side.text.isidentifier())


def has_neighbours(formula: DocumentFormula) -> bool:
    """Whether it sums over neighbours, as u_{j+1} - u_j, to a number without a value.

    At the ends, letters are those of a boundary.
    """
    trees = (one for side in formula.occurrence.sides for one in nodes(side))
    sums = (
        one for one in trees if isinstance(one, Summation) and not isinstance(one.upper, Number)
    )
    return any("+" in one.index or "-" in one.index for each in sums for one in letters(each.body))


def is_motion_of_several(formula: DocumentFormula) -> bool:
    """Whether it gives two letters one function of time, as x_1 = -x_2 = A*cos(omega*t)."""
    *first, last = formula.sides
    names = [one.text.removeprefix("-") for one in first]
    are_letters = all(
        one.isidentifier() and not order(one) and not is_derivative(one) for one in names
    )
    return len(names) > 1 and are_letters and "t" in WORD.findall(last.text)


def entries_of_chain(formula: DocumentFormula) -> Iterator[tuple[str, str]]:
    """Entries of matrices in the midst of a formula, and their values, which stand behind them.

    M_21 is one in ``M_12 = M_21 = m*l``, and M_11 in ``M = [[M_11, M_12], ...] = [[m, 0], ...]``.
    """
    if {*formula.relations} != {"="}:
        return
    *inner, last = formula.sides[1:]
    for side in inner:
        if is_matrix_entry(side.text):
            yield side.text, last.text
        for name, value in zip(side.entries, last.entries, strict=False):
            if ENTRY.match(name.text):
                yield name.text, value.text


def is_matrix_entry(name: str) -> bool:
    """Whether a name is that of an entry of a matrix, such as M_12."""
    match = ENTRY.match(name)
    return match is not None and match[3] is not None


def without_unknown_terms(
    formula: DocumentFormula, unknown: Collection[str]
) -> DocumentFormula | None:
    """The formula without all terms with unknown letters; None if other parts have some."""
    try:
        trees = [_reduced(syntax_tree(one.text), unknown) for one in formula.sides]
    except ExpressionError:
        return None
    # in x' = f(x, u) = ..., f is another name of the last side
    known = [one for one in trees if one is not None]
    texts = [*map(ast.unparse, known), *["0"] * (2 - len(known))]
    if any(name in WORD.findall(text) for text in texts for name in unknown):
        return None
    relations = formula.relations[: len(texts) - 1]
    return replace(formula, sides=tuple(map(FormulaText, texts)), relations=relations)


def _reduced(node: ast.expr, unknown: Collection[str]) -> ast.expr | None:
    """The tree without the terms with unknown names in sums; None if nothing is left."""
    terms = summands(node)
    if terms == [(node, 1)]:
        return _inside(node, unknown)
    known = [(one, sign) for term, sign in terms if (one := _reduced(term, unknown)) is not None]
    if not known:
        return None
    (first, sign), *others = reversed(known)
    result = first if sign > 0 else ast.UnaryOp(ast.USub(), first)
    for one, sign in others:
        result = ast.BinOp(result, ast.Add() if sign > 0 else ast.Sub(), one)
    return result


def _inside(node: ast.expr, unknown: Collection[str]) -> ast.expr | None:
    """A term with its sums reduced; None if it contains an unknown name elsewhere."""
    match node:
        case ast.Name(id=name):
            return None if name in unknown else node
        case ast.Constant():
            return node
        case ast.BinOp(left=left, op=op, right=right):
            a, b = _reduced(left, unknown), _reduced(right, unknown)
            return ast.BinOp(a, op, b) if a is not None and b is not None else None
        case ast.UnaryOp(op=op, operand=operand):
            inner = _reduced(operand, unknown)
            return ast.UnaryOp(op, inner) if inner is not None else None
        case ast.Call(func=function, args=arguments, keywords=[]):
            inner_arguments = [_reduced(one, unknown) for one in arguments]
            if all(one is not None for one in inner_arguments):
                return ast.Call(function, inner_arguments, [])  # type: ignore[arg-type]
            return None
        case ast.Tuple(elts=items, ctx=ctx):
            entries = [_reduced(one, unknown) or ast.Constant(0) for one in items]
            return ast.Tuple(entries, ctx)
    return (
        None
        if {one.id for one in ast.walk(node) if isinstance(one, ast.Name)} & {*unknown}
        else node
    )
