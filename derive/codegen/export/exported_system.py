"""The program of an exported file: functions of a system, and a simulation with a method."""

import ast
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from importlib import resources
from math import cos, inf, sin
from typing import Any, Protocol

import numpy as np

from derive.codegen.export.exported_program import ExportedProgram, SubsetBackend, Without, stores
from derive.codegen.function_specs import Form
from derive.codegen.module_functions import Functions, split
from derive.codegen.module_summary import units
from derive.mechanics.derivation import Derivation
from derive.system.symbols import TIME
from solvers.io.suggestion import did_you_mean

#: Steps of Newton's method onto the constraints, after every step of the motion.
CORRECTIONS = 2
#: Parts of the simulation that need an event, angles, or control of the step size.
EVENT = ("event", "is_event", "print_event", "locate", "kind")
ANGLES = ("angles", "there", "follow", "START_ANGLES", "ANGLE_COUNT")
CONTROL = ("advance",)
FIXED = ("advance_steps",)


class ExplicitMethod(Protocol):
    """An explicit Runge–Kutta method, such as `solvers.runge_kutta.tableau.Tableau`."""

    @property
    def title(self) -> str:
        """Its usual name."""

    @property
    def A(self) -> Sequence[Sequence[Any]]:  # noqa: N802  the usual name
        """The matrix of stages; numbers convert to float."""

    @property
    def b(self) -> Sequence[Any]:
        """Weights."""

    @property
    def c(self) -> Sequence[Any]:
        """Nodes."""

    @property
    def error_weights(self) -> Sequence[Sequence[Any]]:
        """Weights of one or two error estimates."""

    @property
    def error_order(self) -> int:
        """The order of the error estimate."""

    @property
    def is_splitting(self) -> bool:
        """Whether positions and velocities have stages of their own."""


@dataclass(frozen=True)
class Simulation:
    """What an exported simulation computes.

    Parameters
    ----------
    method : Tableau
        An explicit Runge–Kutta method.
    params : sequence of float
        In the order of the system's parameters and inputs.
    y0 : sequence of float
        The start: coordinates, then velocities.
    duration : float
        In s.
    samples : int
        Number of rows of output after the start, evenly spaced.
    steps : int
        Number of equal steps between two rows; 0 for steps that are controlled.
    rtol, atol : float
        Tolerances of controlled steps.
    event : tuple of str and float, optional
        A coordinate or velocity, and the value where it has a row of output.
    name, note : str, optional
        The name of the file, by default that of the system; and a remark for its header.

    Examples
    --------
    >>> from derive import Simulation
    >>> from solvers.runge_kutta import method_catalogue
    >>> rk4 = method_catalogue.load("rk4")
    >>> Simulation(rk4, (1.0, 2.0, 9.81), (0.1, 0.0), duration=10.0, steps=20).samples
    100
    """

    method: ExplicitMethod
    params: Sequence[float]
    y0: Sequence[float]
    duration: float
    samples: int = 100
    steps: int = 0
    rtol: float = 1e-9
    atol: float = 1e-9
    event: tuple[str, float] | None = None
    name: str = ""
    note: str = ""


class ExportedSystem:
    """The functions of a system, as programs in the subset of Python."""

    def __init__(self, derivation: Derivation) -> None:
        self.derivation, self.functions = derivation, Functions(derivation)
        self.system = derivation.system

    @property
    def form(self) -> Form:
        """The form of the equations that calls the fewest functions."""
        return "rational" if self.functions.fastest == "rhs_rational" else "lagrangian"

    def library(self, names: Iterable[str]) -> ExportedProgram:
        """A program of functions of these names."""
        texts = [_template(), *map(self._text, names)]
        return ExportedProgram(ast.parse("\n\n".join(texts)), [*names])

    def simulation(
        self, of: Simulation, entry: Sequence[str] = ("simulate",), also: Sequence[str] = ()
    ) -> ExportedProgram:
        """A program that integrates a motion, as far as functions called `entry` need it.

        Further functions of the library are `also` there.
        """
        suffix = "_rational" if self.form == "rational" else ""
        names = {f"rhs{suffix}": "rhs", f"energy{suffix}": "energy"}
        if self.system.conditions:
            names[f"correction{suffix}"] = "correction"
        texts = [re.sub(rf"\b{name}\b", new, self._text(name)) for name, new in names.items()]
        texts += map(self._text, also)
        texts += [self._project(), self._row(), self._follow(), *self._event(of)]
        tree = ast.parse(_template())
        own = ast.parse("\n\n".join(texts)).body
        replaced = {one.name for one in own if isinstance(one, ast.FunctionDef)}
        others = [one for one in tree.body if getattr(one, "name", "") not in replaced]
        tree.body = [*others, *self._constants(of), *own]
        names_of_all = [*names.values(), *also, "step", *entry]
        return ExportedProgram(Without(tree, self._absent(of)).visit(tree), names_of_all)

    @property
    def usual(self) -> list[str]:
        """Names of the functions of libraries: those of the first file of a module."""
        contents = self.functions.contents()
        return [one.name for one in split(contents.functions)[0]]

    def forms(self, names: Iterable[str]) -> set[Form]:
        """Forms of the equations whose states these functions take."""
        return {one.form for one in self.functions.part([*names]).functions if one.state}

    def columns(self, of: Simulation) -> tuple[str, ...]:
        """Names of the columns of rows of output, with units."""
        unit = units(self.system)
        names = [f"{s.name} [{unit[s.name]}]" for s in (*self.system.q, *self.system.qdot)]
        return ("t [s]", *names, "energy [J]", *(["event"] if of.event else []))

    def check(self, of: Simulation) -> None:
        """Raise `ValueError` if a simulation is not possible."""
        state = [s.name for s in (*self.system.q, *self.system.qdot)]
        method = of.method
        if method.is_splitting or any(a != 0 for i, row in enumerate(method.A) for a in row[i:]):
            kind = "a splitting" if method.is_splitting else "implicit"
            raise ValueError(
                f"the method {method.title!r} is {kind}: exports have explicit Runge-Kutta "
                "methods, such as verner853 or rk4"
            )
        if not of.steps and not method.error_weights:
            raise ValueError(
                f"the method {method.title!r} estimates no error, which step control needs: give "
                "the number of steps, or choose another method, such as verner853"
            )
        for name, number, least in (
            ("duration", of.duration, 0.0),
            ("samples", of.samples, 0.5),
            ("steps", of.steps, -0.5),
            *([] if of.steps else [("rtol", of.rtol, 0.0), ("atol", of.atol, 0.0)]),
        ):
            if not least < number < inf:
                allowed = "0 or more" if least < 0 else "finite and above 0"
                raise ValueError(f"{name} is {number}, but must be {allowed}")
        for name, values, names in (
            ("y0", of.y0, state),
            ("params", of.params, [s.name for s in self.system.params]),
        ):
            if len(values) != len(names) or not np.isfinite(values).all():
                raise ValueError(
                    f"{name} is {[*map(float, values)]}, not finite numbers for {', '.join(names)}"
                )
        if of.event and of.event[0] not in state:
            raise ValueError(
                f"no coordinate or velocity is called {of.event[0]!r}"
                f"{did_you_mean(of.event[0], state)}; known: {', '.join(state)}"
            )

    def _text(self, name: str) -> str:
        (function,) = self.functions.part([name]).functions
        return SubsetBackend().function(function)

    @property
    def angles(self) -> list[int]:
        """Numbers of the coordinates whose sine and cosine are in the state."""
        if self.form != "rational":
            return []
        state = self.functions.contents([]).states["rational"]
        return [k for k, q in enumerate(self.system.q) if f"sin_{q.name}" in state]

    @property
    def _places(self) -> list[str]:
        """The components of (q, q̇) by the state and the angles."""
        places, k = [], 0
        for n in range(len(self.system.q)):
            is_angle = n in self.angles
            places.append(f"angles[{self.angles.index(n)}]" if is_angle else f"y[{k}]")
            k += 1 + is_angle
        return [*places, *(f"y[{k + n}]" for n in range(len(self.system.q)))]

    def _sines(self) -> list[int]:
        """Places of the sines of angles in the state, before those of their cosines."""
        return [n + k for k, n in enumerate(self.angles)]

    def _project(self) -> str:
        lines = ["def project(t: float, y: Vector, params: Vector) -> None:"]
        lines.append('    "Restore constraints, and sin^2 + cos^2 = 1 of angles, by Newton steps."')
        if self.system.conditions:
            lines += [f"    change = [0.0]*{2 * len(self.system.q)}"]
            lines += [
                f"    for k in range({CORRECTIONS}):",
                "        correction(t, y, params, change)",
            ]
            lines += [f"        {line}" for line in self._corrected()]
        lines += [f"    {line}" for line in self._normalised()]
        return "\n".join(lines if lines[2:] else [])

    def _corrected(self) -> Iterator[str]:
        """Statements that add a change of coordinates and velocities to the state."""
        place = 0
        for n in range(2 * len(self.system.q)):
            if n in self.angles:
                sine, cosine = f"y[{place}]", f"y[{place + 1}]"
                yield f"before = {sine}"
                yield f"{sine} = {sine} + {cosine}*change[{n}]"
                yield f"{cosine} = {cosine} - before*change[{n}]"
                place += 2
            else:
                yield f"y[{place}] = y[{place}] + change[{n}]"
                place += 1
        yield from self._normalised()

    def _normalised(self) -> Iterator[str]:
        for k in self._sines():
            yield f"scale = 1.5 - 0.5*(y[{k}]*y[{k}] + y[{k + 1}]*y[{k + 1}])"
            yield f"y[{k}] = y[{k}]*scale"
            yield f"y[{k + 1}] = y[{k + 1}]*scale"

    def _row(self) -> str:
        head = (
            "def row(t: float, y: Vector, angles: Vector, params: Vector, values: Vector) -> None:"
        )
        places = [*self._places, "energy(t, y, params)"]
        about = '    "Values of a row of output: coordinates, velocities, energy."'
        return "\n".join([head, about, *stores("values", range(len(places)), places)])

    def _follow(self) -> str:
        lines = ["def follow(y: Vector, angles: Vector) -> None:"]
        lines.append('    "Let the angles follow the state, over whole turns."')
        for n, k in enumerate(self._sines()):
            lines.append(f"    angles[{n}] = angle(y[{k}], y[{k + 1}], angles[{n}])")
        return "\n".join(lines if self.angles else [])

    def event(self, of: Simulation) -> tuple[int, float] | None:
        """The number of the coordinate or velocity that has an event, and its value there."""
        names = [s.name for s in (*self.system.q, *self.system.qdot)]
        return (names.index(of.event[0]), of.event[1]) if of.event else None

    def _event(self, of: Simulation) -> list[str]:
        event = self.event(of)
        if event is None:
            return []
        k, value = event
        name = (*self.system.q, *self.system.qdot)[k].name
        formula, condition = f"{self._places[k]} - {_float(value)}", "True"
        about = f"{name} - {value:g}"
        if k in self.angles:
            sine = self._sines()[self.angles.index(k)]
            formula = f"{_float(cos(value))}*y[{sine}] - {_float(sin(value))}*y[{sine + 1}]"
            condition = f"abs({self._places[k]} - {_float(value)}) < 1.0"
            about = f"sine of {about}"
        return [
            "def event(t: float, y: Vector, params: Vector) -> float:\n"
            f'    "The {about}, which is 0 at events."\n    return {formula}',
            "def is_event(y: Vector, angles: Vector) -> bool:\n"
            f'    "Whether a zero of `event` is an event: an angle may differ by whole turns."\n'
            f"    return {condition}",
        ]

    def _absent(self, of: Simulation) -> set[str]:
        absent = {*(CONTROL if of.steps else FIXED)}
        absent |= set() if of.event else {*EVENT}
        absent |= set() if self.angles else {*ANGLES}
        if not (self.angles or self.system.conditions):
            absent.add("project")
        if not of.steps and len(of.method.error_weights) < 2:
            absent.add("E_LOW")
        return absent

    def values(self, of: Simulation) -> list[float]:
        """Parameters and inputs, then the values that integrals keep along the motion."""
        symbols = (*self.system.q, *self.system.qdot, *self.system.params, TIME)
        known = dict(zip(symbols, [*of.y0, *of.params, 0.0], strict=True))
        return [*map(float, of.params), *(float(f.subs(known)) for f in self.derivation.integrals)]

    def _constants(self, of: Simulation) -> list[ast.stmt]:
        q, method, params = len(self.system.q), of.method, self.values(of)
        state = [float(x) for x in of.y0]
        start = list[float]()
        for k, x in enumerate(state):
            start += [sin(x), cos(x)] if k in self.angles else [x]
        first = of.duration / of.samples / 100
        power = method.error_order + 1
        weights = [[*map(float, row)] for row in method.error_weights]
        values: dict[str, object] = {
            "SIZE": len(start),
            "PARAMETERS": len(params),
            "COLUMNS": 2 * q + 1 + (of.event is not None),
            "STAGES": len(method.b),
            "A": [float(a) for line in method.A for a in line],
            "B": [*map(float, method.b)],
            "C": [*map(float, method.c)],
            "E": weights[0] if weights else [],
            "E_LOW": weights[-1] if weights else [],
            "ERROR_ORDER": method.error_order,
            "DEFAULTS": params,
            "START_STATE": start,
            "START_ANGLES": [state[k] for k in self.angles],
            "ANGLE_COUNT": len(self.angles),
            "DURATION": float(of.duration),
            "SAMPLES": of.samples,
            "STEPS": of.steps,
            "RTOL": float(of.rtol),
            "ATOL": float(of.atol),
            "FIRST_STEP": first,
            "LEAST_STEP": 1e-14 * of.duration,
            "SAFETY_POWER": 0.9**power,
        }
        return [*ast.parse("\n".join(f"{name} = {value!r}" for name, value in values.items())).body]


def _float(value: float) -> str:
    return f"({value!r})"


def _template() -> str:
    path = resources.files(__package__ or "") / "integration_program.py"
    return path.read_text(encoding="utf-8")
