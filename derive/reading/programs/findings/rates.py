"""Equations of a function that returns the rates of a state, or assigns them."""

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from derive.reading.programs.evaluation.arrays import entries, flat, is_array
from derive.reading.programs.evaluation.context import OWN_OBJECTS
from derive.reading.programs.evaluation.following import Follower
from derive.reading.programs.evaluation.sums import inner, terms
from derive.reading.programs.evaluation.values import whole
from derive.reading.programs.syntax.code import Definition
from derive.reading.programs.syntax.trees import Expression, FunctionCall, Name, Record


@dataclass(frozen=True)
class Rates:
    """The rates of variables, by the names of the variables."""

    values: Mapping[str, Expression]
    lines: Mapping[str, int]
    is_step: bool = False  # the values are not rates, but the variables after a step

    @property
    def velocities(self) -> dict[str, str]:
        """The velocity of each coordinate: its rate is another variable of the state."""
        result = {}
        for variable, value in self.values.items():
            rate = inner(value)
            if isinstance(rate, Name) and rate.path != variable and rate.path in self.values:
                result[variable] = rate.path
        return {q: v for q, v in result.items() if v not in result}


def rates(definition: Definition, follower: Follower) -> Rates | None:
    """The rates that a function computes; None if it computes none."""
    for outputs, lines in _outputs(definition, follower):
        if any(map(is_array, outputs.values())):
            continue  # a matrix
        if len(outputs) >= 2 and (keys := _state(definition, follower, outputs)) is not None:
            found = dict(zip(keys, outputs.values(), strict=True))
            result = Rates(found, dict(zip(keys, lines, strict=True)))
            if _is_observation(result):
                continue
            return replace(result, is_step=not result.velocities and _is_step(found))
    return None


def _is_observation(rates: Rates) -> bool:
    """Whether values are measurements of a state, such as (x, x_dot, cos(theta), sin(theta))."""
    values = {variable: inner(value) for variable, value in rates.values.items()}
    kept = sum(value == Name(0, variable) for variable, value in values.items())
    is_direction = any(
        isinstance(one, FunctionCall)
        and one.function in (Name(0, "sin"), Name(0, "cos"))
        and isinstance(inner(one.arguments[0]), Name)
        for one in values.values()
    )
    return is_direction or kept > len(rates.velocities)


def _is_step(values: Mapping[str, Expression]) -> bool:
    """Whether values are those of the same variables later, not their rates."""
    return any(
        sign == 1 and inner(term) == Name(0, path)
        for path, value in values.items()
        for sign, term in terms(inner(value))
    )


def _outputs(
    definition: Definition, follower: Follower
) -> Iterator[tuple[dict[str, Expression], list[int]]]:
    """Values that a function returns or assigns, by their indices or names of members."""
    last = {step.path: step.line for step in follower.steps}
    value = follower.result(definition)
    items = entries(flat(value))
    if items is not None:
        yield {str(i): one for i, one in enumerate(items)}, [one.line for one in items]
    if isinstance(record := inner(value), Record):
        yield dict(record.fields), [one.line for _, one in record.fields]
    for parameter in definition.parameters:
        items = entries(flat(follower.variables.get(parameter.name, value)))
        if parameter.name in follower.variables and items is not None:
            yield {str(i): one for i, one in enumerate(items)}, [one.line for one in items]
    groups: dict[str, dict[str, Expression]] = {}
    for path, value in follower.variables.items():
        base, key = _split(path)
        if base and key and not (isinstance(value, Name) and value.path == path):
            groups.setdefault(base, {})[key] = value
    for base, group in groups.items():
        if all(whole(key) is not None for key in group):
            numbers = sorted(group, key=int)
            first = follower.context.language.first_index
            if [int(one) for one in numbers] != [*range(first, first + len(numbers))]:
                continue
            lines = [last.get(f"{base}[{one}]", definition.line) for one in numbers]
            yield {str(i): group[one] for i, one in enumerate(numbers)}, lines
        elif base not in OWN_OBJECTS and not any(whole(key) is not None for key in group):
            lines = [last.get(f"{base}.{one}", definition.line) for one in group]
            yield group, lines


def _split(path: str) -> tuple[str, str]:
    if path.endswith("]"):
        base, _, key = path[:-1].rpartition("[")
        return base, key if whole(key) is not None else ""
    base, _, key = path.rpartition(".")
    return base, key


def _state(
    definition: Definition, follower: Follower, outputs: dict[str, Expression]
) -> list[str] | None:
    """The variables whose rates the outputs are; None if that is not clear."""
    names = [tree.path for one in outputs.values() for tree in _names(one)]
    first = follower.context.language.first_index
    counts: Counter[str] = Counter()
    plain = map(inner, outputs.values())
    rates_by_name = {v.path for v in plain if isinstance(v, Name)}
    for name in dict.fromkeys(names):
        base, key = _split(name)
        if key and base:
            counts[base] += 1 + 100 * (name in rates_by_name)
    parameters = {one.name for one in definition.parameters}
    # theta, p_theta, phi, p_phi = y, of which cyclic coordinates occur nowhere else
    taken = {step.value.path for step in follower.steps if isinstance(step.value, Name)}
    for base, _ in counts.most_common():
        if all(whole(key) is not None for key in outputs):
            keys = [f"{base}[{i + first}]" for i in range(len(outputs))]
        else:
            keys = [f"{base}.{key}" for key in outputs]
        used = {name for name in names if _split(name)[0] == base}
        own = {name for name in rates_by_name if _split(name)[0] == base}
        is_whole = used == {*keys} or used <= {*keys} <= taken
        is_canonical = is_whole and base in parameters
        is_canonical &= not any(
            {f"{other}[{i + first}]" for i in range(len(outputs))} <= {*names}
            for other in parameters - {base}
        )  # a force by coordinates and velocities
        if (own and own <= {*keys}) or is_canonical:
            return keys
    return _scalars(definition, outputs, rates_by_name)


def _scalars(
    definition: Definition, outputs: dict[str, Expression], direct: set[str]
) -> list[str] | None:
    """The state as separate parameters, in the order of the outputs; time may stand before."""
    names = [one.name for one in definition.parameters]
    values = [inner(one) for one in outputs.values()]
    for start in range(min(3, len(names) - len(values) + 1)):
        keys = names[start : start + len(values)]
        own = (value == Name(0, key) for key, value in zip(keys, values, strict=True))
        if direct and direct <= {*keys} and not any(own):
            return keys
    return None


def _names(tree: Expression) -> Iterator[Name]:
    if isinstance(tree, Name):
        yield tree
    for part in tree.parts:
        yield from _names(part)
