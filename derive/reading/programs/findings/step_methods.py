"""The method of integration: of a library, or step by step with its faults."""

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field

from derive.reading.programs.evaluation.mathematics import split
from derive.reading.programs.evaluation.sums import inner, terms, total
from derive.reading.programs.findings.regions import Region
from derive.reading.programs.findings.runge_kutta import Method, method, shifted, value_at
from derive.reading.programs.findings.updates import Pair, Update, Updates, names
from derive.reading.programs.program import Finding
from derive.reading.programs.syntax.code import Definition, Lambda, Return
from derive.reading.programs.syntax.trees import (
    Array,
    Expression,
    FunctionCall,
    Member,
    Name,
    NumberLiteral,
    TextLiteral,
)

#: Functions that a browser or a drawing library calls once a picture.
DRAWING = {"draw", "animate", "animation", "render", "redraw", "tick", "frame", "drawframe"}
#: Usual names of step sizes.
STEP_SIZE = re.compile(r"(?:^|\.)(?:d_?t|delta_?t(?:ime)?|time_?step|step_?size)$", re.IGNORECASE)


@dataclass
class WrittenMethod:
    """A method that is written out, and the rates of the variables that it changes."""

    line: int
    method: Method
    rates: dict[str, Expression]
    #: Variables, and the other ones to which their stages add their rates instead.
    exchanged: dict[str, str] = field(default_factory=dict)


def written_methods(updates: Updates, returned: Expression | None) -> list[WrittenMethod]:
    """The Runge-Kutta methods by which variables, or a value that is returned, are changed."""
    changes = [
        (name, one.line, total(one.line, one.increment)) for name, one in updates.updates.items()
    ]
    value = None if returned is None else inner(returned)
    for entry in value.items if isinstance(value, Array) else () if value is None else (value,):
        parts = [*terms(entry)]
        own = next((one for one in parts if one[0] == 1 and isinstance(one[1], Name)), None)
        if own and isinstance(own[1], Name):
            rest = [one for one in parts if one is not own]
            changes.append((own[1].path, entry.line, total(entry.line, rest)))
    found: list[WrittenMethod] = []
    for name, line, increment in changes:
        if (result := method(increment)) is not None:
            one = next((other for other in found if other.method == result[0]), None)
            if one is None:
                found.append(one := WrittenMethod(line, result[0], {}))
            one.rates[name] = result[1]
            others = shifted(increment)
            if name not in others and (other := {each for each, *_ in changes} & others):
                one.exchanged[name] = min(other)
    return found


def written_pairs(
    updates: Updates, written: Sequence[WrittenMethod]
) -> Iterator[tuple[str, str, Expression]]:
    """Coordinates, velocities and accelerations of methods that are written for each of them.

    The first stage of a coordinate is its velocity: the value of a function that returns it, or
    its increment is proportional to it.
    """
    rates = {name: value for one in written for name, value in one.rates.items()}
    for name, value in rates.items():
        rate = inner(value)
        if isinstance(rate, Name) and rate.path != name and rate.path in rates:
            yield name, rate.path, rates[rate.path]
    at_rest = dict.fromkeys(updates.updates, 0.0)
    for name, update in updates.updates.items():
        if name in rates:
            continue
        increment = total(update.line, update.increment)
        for velocity, value in rates.items():
            with suppress(ArithmeticError, ValueError):
                if value_at(increment, at_rest) or not value_at(
                    increment, at_rest | {velocity: 1.0}
                ):
                    continue
                yield name, velocity, value


def runge_kutta_findings(written: Sequence[WrittenMethod], function: str) -> Iterator[Finding]:
    """Remarks on the methods that are written out."""
    for result in written:
        one, possible = result.method, min(result.method.stages, 4)
        text = f"a Runge-Kutta method of {one.stages} stages and order {one.order} is written out"
        is_fault = one.order < possible
        if result.exchanged:
            is_fault = True
            pairs = (f"those of {name} to {other}" for name, other in result.exchanged.items())
            text = f"stages add rates to other variables: {', '.join(pairs)}"
        elif is_fault:
            weights = ", ".join(f"{x:.4g}" for x in one.b)
            nodes = ", ".join(f"{sum(row):.4g}" for row in one.A)
            text += f": weights {weights}, stages at {nodes} of the step"
            text += f"; order {possible} is possible"
        yield Finding(result.line, "runge_kutta", function, text, is_fault)


def euler_findings(
    pairs: tuple[Pair, ...],
    used: Mapping[str, frozenset[str]],
    region: Region,
    constants: Mapping[str, Expression],
    shown: Callable[[str], str],
) -> Iterator[Finding]:
    """Remarks on coordinates and velocities that are changed by their rates.

    `used` has the variables after their update that the acceleration of each coordinate uses.
    """
    coordinates = {pair.coordinate.variable for pair in pairs}
    velocities = {pair.velocity.variable for pair in pairs}
    function = region.name
    for pair in pairs:
        q, v = pair.coordinate, pair.velocity
        x, rate = shown(q.variable), shown(v.variable)
        new = used.get(q.variable, frozenset())
        moved = new & coordinates
        if pair.has_other_terms:
            continue
        if pair.uses_middle_velocity:
            text = f"leapfrog: {rate} and {x} are changed in turn, one of them in two halves"
            yield Finding(q.line, "leapfrog", function, text)
            continue
        if pair.uses_new_velocity:
            text = f"semi-implicit Euler: {rate} first (line {v.line}), then {x}"
            yield Finding(q.line, "semi_implicit_euler", function, text)
        elif q.variable in moved:
            text = f"semi-implicit Euler: {x} first, then {rate} (line {v.line})"
            yield Finding(q.line, "semi_implicit_euler", function, text)
        else:
            text = f"explicit Euler, with which undamped oscillations grow: {x} is changed by the"
            yield Finding(q.line, "explicit_euler", function, f"{text} old value of {rate}")
        partly = (new & velocities) | (moved if moved != coordinates else frozenset())
        if partly:
            changed = ", ".join(sorted(map(shown, partly)))
            text = f"the acceleration for {rate} uses values after the step: {changed}"
            yield Finding(v.line, "mixed_update", function, text)
    yield from _steps(pairs, region, constants)
    for pair in pairs:
        yield from _damping(pair.velocity, function, shown)


def _steps(
    pairs: tuple[Pair, ...], region: Region, constants: Mapping[str, Expression]
) -> Iterator[Finding]:
    for pair in pairs:
        line, step = pair.coordinate.line, pair.step
        if step is None and (name := _step_of(pair.velocity)):
            q, v = pair.coordinate.variable, pair.velocity.variable
            text = f"{v} is changed with the step size {name}, and {q} without it"
            yield Finding(line, "lost_step", region.name, text, True)
            return
        value = constants.get(step.path, step) if isinstance(step, Name) else step
        if step is None:
            text = "no step size: each call advances the motion by one unit of time"
        elif isinstance(value, NumberLiteral) and float(value.digits) >= 1:
            text = f"the step size is {value.digits}"
        elif not region.is_loop and region.name.rpartition(".")[2].lower() in DRAWING:
            text = "one step a picture: the step size is that of the pictures"
        else:
            continue
        yield Finding(line, "frame_step", region.name, text)
        return


def _step_of(velocity: Update) -> str:
    """The name of a step size that each term of a change contains; "" if there is none."""
    parts = [{*names(term)} for _, term in velocity.increment]
    known = sorted(one for one in set[str]().union(*parts) if STEP_SIZE.search(one))
    return next((one for one in known if all(one in part for part in parts)), "")


def _damping(velocity: Update, function: str, shown: Callable[[str], str]) -> Iterator[Finding]:
    if velocity.damping is not None:
        text = f"{shown(velocity.variable)} is multiplied by a factor each step: damping"
        yield Finding(velocity.damping_line or velocity.line, "damping", function, text)


#: Functions that integrate, and the library and the method by default.
INTEGRATORS = {
    "odeint": ("an integrator", "LSODA in SciPy"),
    "solve_ivp": ("SciPy", "RK45"),
    "ode45": ("MATLAB", "an embedded pair of order 5"),
    "ode23": ("MATLAB", "an embedded pair of order 3"),
    "ode113": ("MATLAB", "a multistep method"),
    "ode15s": ("MATLAB", "an implicit multistep method"),
    "ode23s": ("MATLAB", "an implicit method"),
    "ode23t": ("MATLAB", "the trapezoidal rule"),
    "ode78": ("MATLAB", "an embedded pair of order 8"),
    "ode89": ("MATLAB", "an embedded pair of order 9"),
    "lsode": ("Octave", "LSODE"),
    "ODEProblem": ("DifferentialEquations.jl", "the method of solve"),
    "SecondOrderODEProblem": ("DifferentialEquations.jl", "the method of solve"),
    "integrate_const": ("Boost", "the stepper of the call"),
    "integrate_adaptive": ("Boost", "the stepper of the call"),
    "diffeqsolve": ("diffrax", "the solver of the call"),
    "complex_ode": ("SciPy", "the integrator of the call"),
}
#: Those that take the initial state before the times.
STATE_FIRST = ("odeint", "ODEProblem", "SecondOrderODEProblem")


def library_findings(calls: Iterable[FunctionCall], function: str) -> Iterator[Finding]:
    """The integrators among calls."""
    for call in calls:
        name = split(_path(call.function))[1]
        if name in INTEGRATORS:
            library, method = INTEGRATORS[name]
            chosen = dict(call.keywords).get("method")
            if isinstance(chosen, TextLiteral | Name):
                method = chosen.value if isinstance(chosen, TextLiteral) else chosen.path
            text = f"{name} of {library} integrates: {method}"
            if library == "an integrator":
                text = f"{name} integrates: {method}"
            yield Finding(call.line, "library", function, text)


def integrated(calls: Iterable[FunctionCall]) -> Iterator[tuple[str, Expression]]:
    """Functions that are passed to an integrator, and their initial states."""
    for call in calls:
        name = split(_path(call.function))[1]
        functions = [path for one in call.arguments if (path := _function(one))]
        place = 1 if name in STATE_FIRST else 2
        if name in INTEGRATORS and functions and len(call.arguments) > place:
            yield functions[0], call.arguments[place]


def _function(tree: Expression) -> str:
    """A function by its name, or the function that one without a name calls."""
    match tree:
        case Lambda(function=Definition(body=(Return(value=FunctionCall(function=inner)),))):
            return _path(inner)
        case TextLiteral(value=name):
            return name
    return _path(tree)


def _path(tree: Expression) -> str:
    match tree:
        case Name(path=path):
            return path
        case Member(base=base, name=name):
            return f"{_path(base)}.{name}"
    return ""
