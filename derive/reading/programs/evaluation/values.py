"""Values of expressions in the names that a function starts with."""

from collections.abc import Mapping

from derive.reading.programs.evaluation.arrays import (
    combined,
    entries,
    flat,
    transposed,
    turned,
)
from derive.reading.programs.evaluation.context import OWN_OBJECTS, ProgramContext, assigned
from derive.reading.programs.evaluation.counted_loops import BODIES, bound, integer, mentions
from derive.reading.programs.evaluation.mathematics import constant
from derive.reading.programs.syntax.code import Lambda
from derive.reading.programs.syntax.formula_text import UnwrittenError, plain
from derive.reading.programs.syntax.trees import (
    MAX_DEPTH,
    MAX_SIZE,
    Array,
    Choice,
    Comprehension,
    Expression,
    FunctionCall,
    Item,
    Member,
    Name,
    NumberLiteral,
    Opaque,
    OperatorExpression,
    Record,
    Result,
    Slice,
    TextLiteral,
    replaced,
)


class Values:
    """The values of variables at a statement, and of expressions in them."""

    def __init__(self, context: ProgramContext, owner: str = "") -> None:
        self.context, self.owner = context, owner
        self.variables: dict[str, Expression] = {}
        self.parameters: set[str] = set()
        #: Copies of arrays, of which entries can change by themselves.
        self.copies: set[str] = set()
        #: Arrays that a caller passes, which the function changes.
        self.references: dict[str, str] = {}
        self._open: set[str] = set()
        #: Names with one numeric value, which stay letters.
        self.fixed: set[str] = set()
        #: Bounds of loops over bodies, and the indices of those that are followed, with their ends.
        self.counts: set[str] = set()
        self.indices: dict[str, int] = {}

    def value(self, tree: Expression) -> Expression:
        """The value of an expression."""
        self.context.spend()
        value = self._value(tree)
        if value.size > MAX_SIZE or value.depth > MAX_DEPTH:
            return Opaque(tree.line, "the formula is too large")
        return value

    def _value(self, tree: Expression) -> Expression:
        match tree:
            case Name():
                return self.variable(tree.line, self.references.get(tree.path, tree.path))
            case Member(base=base, name=name):
                return self._member(tree, base, name)
            case Item():
                return self._item(tree)
            case OperatorExpression(operator=operator, operands=operands):
                values = tuple(map(self.value, operands))
                return combined(tree.line, operator, values, self.context.language)
            case FunctionCall():
                return self.called(tree)
            case Array():
                return Array(tree.line, tuple(map(self.value, tree.items)))
            case NumberLiteral() | TextLiteral() | Lambda() | Slice() | Opaque() | Result():
                return tree
            case Record() | Choice():
                return replaced(tree, tuple(map(self.value, tree.parts)))
            case Comprehension():
                return self._listed(tree)
        raise AssertionError(tree)

    def _listed(self, tree: Comprehension) -> Expression:
        values, before = list[Expression](), {**self.variables}
        if (indices := self.range(tree.lower, tree.upper)) is None:
            return Opaque(tree.line, "a comprehension is not followed")
        for index in indices:
            self.variables[tree.variable] = NumberLiteral(tree.line, str(index))
            values.append(self.value(tree.element))
        self.variables = before
        return Array(tree.line, tuple(values))

    def range(self, lower: Expression, upper: Expression) -> range | None:
        """The indices of a loop over bodies; None if they are not known, or for another loop."""
        if bound(upper) not in self.counts and not mentions(lower, self.indices):
            return None
        first, end = (integer(self.value(one)) for one in (lower, upper))
        return None if first is None or end is None else range(first, end)

    def called(self, call: FunctionCall) -> Expression:
        """The value of a call."""
        raise NotImplementedError

    def variable(self, line: int, path: str) -> Expression:
        """The value of a variable, or of an entry or member of one."""
        if path in self.variables:
            known = self.variables[path]
            is_filled = is_zeros(known) or path in self.copies
            return (self._collected(line, path) if is_filled else None) or known
        if (array := self._collected(line, path)) is not None:
            return array
        if path in self.counts:
            return NumberLiteral(line, str(BODIES))
        if (value := constant(line, path)) is not None:
            return value
        if (result := self._property(line, path)) is not None:
            return result
        shared = self.context.shared.get(path)
        if shared is None or path in self._open | self.fixed or self._is_parameter(path):
            return Name(line, path)
        self._open.add(path)
        value = self.value(shared)
        self._open.remove(path)
        return value

    def _property(self, line: int, path: str) -> Expression | None:
        """The value of a property, which a function without arguments gives; None for others."""
        base, _, name = path.partition(".")
        if base not in OWN_OBJECTS or not name.isidentifier() or path in self.context.variables:
            return None
        function = self.context.function(path, self.owner)
        if function is None or len(function.parameters) > (base in ("self", "obj")):
            return None
        if any("." in one for one in assigned(function.body)):  # which may be passed on
            return None
        return self.called(FunctionCall(line, Member(line, Name(line, base), name), ()))

    def _is_parameter(self, path: str) -> bool:
        name = path.partition(".")[0]
        return name in self.parameters and name not in ("self", "this")

    def _collected(self, line: int, path: str) -> Expression | None:
        """The array of which the entries were assigned one by one."""
        result, rows = dict[int, Expression](), dict[int, dict[int, Expression]]()
        first = self.context.language.first_index
        for key, value in self.variables.items():
            if not key.startswith(f"{path}["):
                continue
            match [*map(whole, key[len(path) + 1 : -1].replace("][", ",").split(","))]:
                case [int(index)]:
                    result[index - first] = value
                case [int(row), int(column)]:
                    rows.setdefault(row - first, {})[column - first] = value
        if rows:
            for row, value in result.items():  # of the first column
                rows.setdefault(row, {})[0] = value
            arrays = {i: _array(line, row) for i, row in rows.items()}
            result = {i: one for i, one in arrays.items() if one}
        return _array(line, result)

    def place(self, tree: Expression) -> str | None:
        """The name of a variable, an entry or a member; None for values without a name."""
        match tree:
            case Name(path=path):
                return self.references.get(path, path)
            case Member(base=base, name=name):
                return f"{outer}.{name}" if (outer := self._object(base)) else None
            case Item(base=base, indices=indices):
                outer, index = self._object(base), self._index(indices)
                return f"{outer}[{index}]" if outer and index else None
        return None

    def _object(self, tree: Expression) -> str | None:
        """The name of an array or object, which can be another name for one."""
        place = self.place(tree)
        value = self.variables.get(place) if place and place not in self.copies else None
        return value.path if isinstance(value, Name) else place

    def _index(self, indices: tuple[Expression, ...]) -> str:
        """An index of one entry, as a text; empty for ranges."""
        values = list(map(self.value, indices))
        is_column = len(values) == 2 and not isinstance(values[1], Slice)
        if is_column and NumberLiteral(0, str(self.context.language.first_index)) == values[1]:
            values.pop()  # of a column as a matrix
        numbers = map(integer, values)
        values = [
            one if index is None or index < 0 else NumberLiteral(one.line, str(index))
            for one, index in zip(values, numbers, strict=True)
        ]
        try:
            return plain(values[0]) if len(values) == 1 else ",".join(map(plain, values))
        except UnwrittenError:
            return ""

    def _member(self, tree: Expression, base: Expression, name: str) -> Expression:
        if name in ("T", "transpose"):
            return turned(self.value(base))
        if name in ("ravel", "flatten"):
            return flat(self.value(base))
        if name in ("mag", "mag2", "hat") and entries(vector := self.value(base)):  # of VPython
            return self.called(FunctionCall(tree.line, Name(tree.line, name), (vector,)))
        if path := self.place(tree):
            if path in self.variables or not isinstance(base, Name):
                return self.variable(tree.line, path)
            record = self.variables.get(base.path)
            field = _field(record, name) if record else None
            return field or self.variable(tree.line, path)
        return Opaque(tree.line, f"the member {name} of a value is not followed")

    def _item(self, tree: Item) -> Expression:
        if len(tree.indices) == 1 and isinstance(tree.indices[0], Slice):
            return self._part(tree, tree.indices[0])
        if (one := row_or_column(tree)) is not None:
            rows = entries(self.value(tree.base)) or ()
            columns = Array(tree.line, tuple(Array(tree.line, entries(row) or ()) for row in rows))
            base = transposed(columns) if tree.indices[1] is one and rows else tree.base
            return self._item(Item(tree.line, base, (one,)))
        if isinstance(tree.base, Name) and tree.base.path == "SA":  # a static array of Julia
            return Array(tree.line, tuple(map(self.value, tree.indices)))
        path, index = self.place(tree), self._index(tree.indices)
        if path and path in self.variables:
            return self.variables[path]
        base = self.value(tree.base)
        if (items := entries(base)) is not None and (number := whole(index)) is not None:
            place = number - (self.context.language.first_index if number >= 0 else 0)
            if -len(items) <= place < len(items):
                return items[place]
            if path and self.place(tree.base) not in self.variables:
                return self.variable(tree.line, path)  # others are assigned before it
        if path and isinstance(base, Name) and self.place(tree.base) not in self.copies:
            return self.variable(tree.line, path)
        if isinstance(base, Name) and index:
            return self.variable(tree.line, f"{base.path}[{index}]")
        if isinstance(base, Opaque):
            return base
        if isinstance(base, Item) and whole(index) == self.context.language.first_index:
            match base.base:
                case OperatorExpression(operator="solve"):
                    return base  # of a solution that is a column as a matrix
        whole_array = self.variables.get(self.place(tree.base) or "", base)
        if is_zeros(base) or is_zeros(whole_array):
            return NumberLiteral(tree.line, "0")
        return Item(tree.line, base, tuple(map(self.value, tree.indices)))

    def _part(self, tree: Item, bounds: Slice) -> Expression:
        """A range of entries; without an end, as many as stand before it: y = (q, q̇)."""
        base = self.value(tree.base)
        language = self.context.language
        lower, upper = (
            one if one is None else whole(self._index((one,)))
            for one in (bounds.lower, bounds.upper)
        )
        start = (lower or language.first_index) - language.first_index
        if (bounds.lower and lower is None) or (bounds.upper and upper is None):
            return Opaque(tree.line, "a range of indices is not followed")
        end = 2 * start if upper is None else upper - language.first_index
        if upper is None and bounds.lower and mentions(bounds.lower, self.indices):
            end = BODIES
        end += upper is not None and not language.is_half_open
        if (items := entries(base)) is not None:
            return Array(tree.line, items[start : None if upper is None else end])
        if is_zeros(base) and upper is not None:
            numbers = range(start + language.first_index, end + language.first_index)
            entry = (Item(tree.line, tree.base, (NumberLiteral(0, str(i)),)) for i in numbers)
            return Array(tree.line, tuple(entry))  # to be filled
        if not isinstance(base, Name) or not end:
            return Opaque(tree.line, "a range of entries is not followed")
        return Array(tree.line, self.named_entries(tree.line, base.path, start, end))

    def named_entries(self, line: int, path: str, start: int, end: int) -> tuple[Expression, ...]:
        """The entries of an array that has a name, from one up to another, counted from 0."""
        first = self.context.language.first_index
        return tuple(self.variable(line, f"{path}[{i + first}]") for i in range(start, end))


def _array(line: int, found: Mapping[int, Expression]) -> Array | None:
    """The array of entries by their indices; None if some are missing."""
    if found and sorted(found) == list(range(len(found))):
        return Array(line, tuple(found[i] for i in range(len(found))))
    return None


def _field(tree: Expression, name: str) -> Expression | None:
    """A value with a name in a record."""
    match tree:
        case Result(value=value):
            return _field(value, name)
        case Record(fields=fields):
            return dict(fields).get(name)
    return None


def row_or_column(tree: Item) -> Expression | None:
    """The index of a whole row or column, as i of ``k(i, :)``; None for other entries."""
    match tree.indices:
        case (Slice(lower=None, upper=None), index) | (index, Slice(lower=None, upper=None)):
            return None if isinstance(index, Slice) else index
    return None


def root(path: str) -> str:
    """The variable of an entry or member."""
    return path.partition("[")[0].partition(".")[0]


def whole(text: str) -> int | None:
    """An index that is a number."""
    return int(text) if text.lstrip("-").isdigit() else None


def is_zeros(tree: Expression) -> bool:
    """Whether a value is an array of zeros, or one to be filled."""
    names = "zeros zeros_like empty empty_like similar zero fill make Array".split()
    match tree:
        case FunctionCall(function=Name(path=path)) | FunctionCall(function=Member(name=path)):
            return path.rpartition(".")[2] in names
    return False
