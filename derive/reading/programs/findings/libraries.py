"""Integrators of libraries that a program calls."""

from collections.abc import Iterable, Iterator

from derive.reading.programs.evaluation.mathematics import split
from derive.reading.programs.program import Finding
from derive.reading.programs.syntax.code import Definition, Lambda, Return
from derive.reading.programs.syntax.trees import Expression, FunctionCall, Member, Name, TextLiteral

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
