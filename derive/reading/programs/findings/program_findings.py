"""The equations and findings of all regions of a program, each of them once."""

import re
from collections.abc import Callable, Iterator
from dataclasses import replace

from derive.reading.programs.evaluation.arrays import entries
from derive.reading.programs.evaluation.calls import CONDITION, VariableValue
from derive.reading.programs.evaluation.context import ProgramContext, statements, static_path
from derive.reading.programs.evaluation.following import LOOP
from derive.reading.programs.evaluation.numeric_values import number
from derive.reading.programs.evaluation.values import root
from derive.reading.programs.findings.degrees import (
    angles,
    is_converted,
    named_in_degrees,
    starts_in_degrees,
    takes_degrees,
)
from derive.reading.programs.findings.function_equations import FunctionEquations, Names
from derive.reading.programs.findings.rates import Rates, rates
from derive.reading.programs.findings.regions import Region
from derive.reading.programs.findings.step_methods import (
    euler_findings,
    integrated,
    library_findings,
    runge_kutta_findings,
    written_methods,
    written_pairs,
)
from derive.reading.programs.findings.updates import Pair, Updates, without_time
from derive.reading.programs.findings.updates import names as paths
from derive.reading.programs.program import (
    Finding,
    NumericConstant,
    Program,
    ProgramEquation,
    RateFunction,
    UnreadPart,
)
from derive.reading.programs.syntax.code import Assignment, Definition, Statement
from derive.reading.programs.syntax.formula_text import UnwrittenError, Writer
from derive.reading.programs.syntax.trees import Expression, Name, Opaque

#: Names of accelerations, such as theta_ddot, ddx, and ddx[1] of arrays.
NAMED = re.compile(r"(?:([^\W\d]\w*?)_?ddot|dd([^\W\d]\w*))(\[\d+\])?")


class Findings:
    """Collects what regions compute."""

    def __init__(self, context: ProgramContext, body: tuple[Statement, ...]) -> None:
        self._context = context
        self._functions: list[RateFunction] = []
        #: Functions without a state, whose accelerations are known by their names.
        self._named: list[RateFunction] = []
        self._findings: list[Finding] = []
        self._unread: list[UnreadPart] = []
        #: Lines of loops that change coordinates step by step, which are regions of their own.
        self._loops: set[int] = set()
        #: Functions that are passed to integrators, and initial states.
        self._integrated: dict[str, Expression] = {}
        #: Whether sines are those of degrees, as a library for drawing allows.
        self._takes_degrees = False
        self._angles: dict[str, dict[int, str]] = {}
        self._starts = [
            (static_path(one.target), one.value)
            for one in statements(body, inner=True)
            if isinstance(one, Assignment) and not one.operator
        ]

    def add(self, region: Region) -> None:
        """Add the equations and the method of a region."""
        follower = region.follower
        self._unread += [UnreadPart(line, why, region.name) for line, why in follower.faults]
        self._findings += library_findings(follower.calls, region.name)
        self._takes_degrees |= any(map(takes_degrees, follower.calls))
        for path, state in integrated(follower.calls):
            if entries(state) is not None:
                self._integrated.setdefault(path.rpartition(".")[2], state)
        has_accelerations = _is_of_second_order(region.definition)
        result = None if has_accelerations else rates(region.definition, region.follower)
        if result and result.is_step:
            lines = result.lines
            follower.steps += [
                VariableValue(lines[q], q, value) for q, value in result.values.items()
            ]
            follower.variables |= result.values
        elif result:
            self._add_rates(region, result)
        for is_met in (False, True):
            self._add_updates(region, is_met=is_met)
        self._add_named(region)
        self._add_open(region)

    def _add_open(self, region: Region) -> None:
        """Note values that are open since they are computed in loops or under conditions."""
        given = {one.name for one in region.definition.parameters}
        values = [v for path, v in region.follower.variables.items() if root(path) in given]
        if region.follower.returned is not None:
            values.append(region.follower.returned)
        result = region.follower.result(region.definition)
        if region.follower.other_returns and isinstance(result, Opaque):
            values.append(result)
        for value in values:
            for one in opaque(value):
                if one.reason in (LOOP, CONDITION):
                    self._unread.append(UnreadPart(one.line, one.reason, region.name))

    def _add_rates(self, region: Region, result: Rates) -> None:
        names = Names(region.follower.steps)
        equations = FunctionEquations(region.name, names)
        velocities = result.velocities
        for q, v in velocities.items():
            names.define(v, f"{names(q)}_dot")
        for q, value in result.values.items():
            if q in velocities:
                v = velocities[q]
                equations.acceleration(result.lines[v], q, v, result.values[v])
            elif q not in velocities.values():
                equations.rate(result.lines[q], q, value)
        self._end(region, equations, names, [*result.values.values()])
        angular = angles([*result.values.values()])
        self._angles[region.definition.name] = {
            i: q for i, q in enumerate(result.values) if q in angular
        }

    def _add_named(self, region: Region) -> None:
        """Add accelerations by their names, as xddot of a function with xdot.

        They are a last choice, unless the parameters of the function state them.
        """
        follower = region.follower
        names = Names(follower.steps)
        equations = FunctionEquations(region.name, names)
        is_stated = _is_of_second_order(region.definition)
        found = {step.path: step for step in follower.steps if NAMED.fullmatch(step.path)}
        used = {path for step in found.values() for path in paths(step.value)}
        pairs = []
        for step in found.values():
            match = NAMED.fullmatch(step.path)
            name, entry = (match[1] or match[2], match[3] or "") if match else ("", "")
            rates = (f"{name}dot", f"{name}_dot", f"d{name}")
            given = (f"{one}{entry}" for one in (name, *rates))
            values = (follower.variables.get(one, Name(step.line, one)) for one in given)
            q, *rest = (one.path if isinstance(one, Name) else "" for one in values)
            v = rest[-1] if is_stated else next((one for one in rest if one in used), "")
            pairs.append((step, q, v))
            if q and v:
                names.define(v, f"{names(q)}_dot")
        if any(v for _, _, v in pairs) and all(q for _, q, _ in pairs):
            for step, q, v in pairs:
                equations.acceleration(step.line, q, v, step.value)
        equations.end()
        if equations.equations and not equations.unread:
            own = tuple(equations.equations)
            functions = self._functions if is_stated else self._named
            functions.append(RateFunction(region.name, region.line, own, names.read))

    def _add_updates(self, region: Region, *, is_met: bool) -> None:
        updates = Updates(region.follower, is_met=is_met)
        leaps = {one.velocity.variable for one in updates.pairs if one.uses_middle_velocity}
        written = [
            one
            for one in written_methods(updates, region.follower.returned)
            if not {*one.rates} <= leaps  # its second stage is that of the next step
        ]
        self._findings += runge_kutta_findings(written, region.name)
        names = Names(region.follower.steps)
        equations = FunctionEquations(region.name, names)
        changed = {name for one in written for name in one.rates}
        pairs = tuple(one for one in updates.pairs if one.coordinate.variable not in changed)
        self._unread += [UnreadPart(line, why, region.name) for line, why in updates.unread]
        if region.is_loop and (written or pairs or updates.recurrences):
            self._loops.add(region.line)
        for path in updates.times:
            names.define(path, "t")
        used, result = {}, list(written_pairs(updates, written))
        for pair in pairs:
            q = pair.coordinate.variable
            value, used[q] = updates.acceleration(pair)
            result.append((q, pair.velocity.variable, value))
        result += [(q, "", value) for q, value in updates.recurrences]
        for q, v, _ in result:
            names.define(q, names(without_time(q)))
            if v:
                names.define(v, f"{names(q)}_dot")
        for q, v, value in result:
            equations.acceleration(value.line, q, v, value)
        values = [value for *_, value in result]
        self._end(region, equations, names, values)
        self._findings += euler_findings(
            pairs, used, region, self._context.constants, names.in_program
        )
        self._findings += _misuses(updates, pairs, region.name, names.in_program)
        self._findings += [
            Finding(
                value.line, "verlet", region.name, f"Verlet's method without the velocity of {q}"
            )
            for q, value in updates.recurrences
        ]
        angular = angles(values) & {q for q, *_ in result}
        converted = {path for path, start in self._starts if is_converted(start)}
        for path, start in self._starts:
            if path in angular:
                self._findings += starts_in_degrees(
                    path, start, self._context.constants, region.name, path not in converted
                )

    def _end(
        self, region: Region, equations: FunctionEquations, names: Names, values: list[Expression]
    ) -> None:
        equations.end()
        for value in values:
            self._findings += named_in_degrees(value, region.name)
        self._unread += equations.unread
        result = tuple(equations.equations)
        if result:
            self._functions.append(RateFunction(region.name, region.line, result, names.read))

    def program(self, file: str, language: str) -> Program:
        """The program, with each equation in the function where it stands."""
        for name, state in self._integrated.items():
            items = entries(state) or ()
            for index, q in self._angles.get(name, {}).items():
                if index < len(items):
                    self._findings += starts_in_degrees(
                        q, items[index], self._context.constants, name
                    )
        functions = self._own_equations()
        read = {equation.line for one in functions for equation in one.equations} | self._loops
        unread = {(one.line, one.reason): one for one in self._unread if one.line not in read}
        starts = {one.name: one.line for one in functions}
        findings: dict[tuple[int, str], Finding] = {}
        for one in self._findings:
            if one.kind == "degrees" and self._takes_degrees:
                continue
            known = findings.get((one.line, one.kind))
            if known is None or starts.get(known.function, 0) < starts.get(one.function, 0):
                findings[one.line, one.kind] = one
        constants = [
            NumericConstant(name, text, value.line)
            for name, value in self._context.constants.items()
            if number(value) is not None and (text := _written(value))
        ]
        return Program(
            file,
            language,
            functions,
            tuple(constants),
            tuple(sorted(findings.values(), key=lambda one: one.line)),
            tuple(sorted(unread.values(), key=lambda one: one.line)),
        )

    def _own_equations(self) -> tuple[RateFunction, ...]:
        """The functions without equations that they take from functions that they call."""
        self._functions = self._functions or self._named
        best: dict[int, RateFunction] = {}
        for function in self._functions:
            for equation in function.equations:
                line, known = equation.line, best.get(equation.line)
                if known is None or _nearness(known, line) < _nearness(function, line):
                    best[line] = function
        result = []
        for function in self._functions:
            own = tuple(e for e in function.equations if best[e.line] is function)
            if own and not any(_is_part(own, other.equations) for other in self._functions):
                result.append(replace(function, equations=own))
        return tuple(result)


def _misuses(
    updates: Updates, pairs: tuple[Pair, ...], function: str, shown: Callable[[str], str]
) -> Iterator[Finding]:
    """Values of the wrong time in a method."""
    for pair in pairs:
        for line, path in updates.mixed(pair) if pair.uses_middle_velocity else ():
            text = f"a half of leapfrog has {shown(path)} both before and after its change"
            yield Finding(line, "mixed_update", function, text, True)
    for line in updates.misplaced:
        text = "a stage of a Runge-Kutta method adds another to the rate, not to the state"
        yield Finding(line, "runge_kutta", function, text, True)


def _is_of_second_order(function: Definition) -> bool:
    """Whether parameters are accelerations, velocities and coordinates, as in Julia's libraries."""
    match [one.name for one in function.parameters]:
        case [accelerations, velocities, coordinates, *_]:
            return (accelerations, velocities) == (f"dd{coordinates}", f"d{coordinates}")
    return False


def _is_part(rates: tuple[ProgramEquation, ...], others: tuple[ProgramEquation, ...]) -> bool:
    """Whether values that look like rates are terms of an equation of another function."""
    lines = {origin.line for one in others for origin in one.origins}
    lines -= {one.line for one in others}
    return all(one.kind == "rate" and one.line in lines for one in rates)


def _nearness(function: RateFunction, line: int) -> int:
    """The larger, the nearer a function begins before a line."""
    return function.line if function.line <= line else -function.line


def opaque(tree: Expression) -> Iterator[Opaque]:
    """The parts of a value that cannot be followed."""
    if isinstance(tree, Opaque):
        yield tree
    for part in tree.parts:
        yield from opaque(part)


def _written(value: Expression) -> str:
    writer = Writer(lambda path: path)
    try:
        writer.write(value)
    except UnwrittenError:
        return ""
    return writer.text
