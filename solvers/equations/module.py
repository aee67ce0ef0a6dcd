"""Generated modules whose functions are generated when they are first used."""

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any, Protocol, cast

from numpy.typing import ArrayLike, NDArray

#: Attributes that depend on the content of all functions.
OF_ALL = ("DIGEST", "VARIABLES", "TIMED", "CALLS_FUNCTIONS", "OPERATIONS", "__file__")


class LazyModule(ModuleType):
    """A generated module that takes each function from a part, when it is first used.

    ``part(names)`` returns a module of the same system with the functions of these names, or with
    some if there are no names; its table ``FUNCTIONS`` names those of all parts. Attributes that
    depend on all functions, such as ``OPERATIONS`` and ``__file__``, are those of a part with all,
    which is generated for them.
    """

    SYSTEM = ""
    FUNCTIONS: tuple[str, ...] = ()

    def __init__(self, part: Callable[[tuple[str, ...]], Any]) -> None:
        first = part(())
        super().__init__(first.__name__, first.__doc__)
        self._part = part
        self._adopt(first)

    def part(self, names: Sequence[str]) -> Any:
        """A module with the functions of these names."""
        return self._part(tuple(name for name in self.FUNCTIONS if name in names))

    def __getattr__(self, name: str) -> Any:
        function = name.removesuffix("_many")
        if function in self.FUNCTIONS:
            self._adopt(self.part([function]))
            return vars(self)[name]
        if name in OF_ALL:
            return getattr(self.part(self.FUNCTIONS), name)
        raise AttributeError(f"the module of {self.SYSTEM} has no attribute {name!r}")

    def _adopt(self, part: Any) -> None:
        """Take the tables and functions of a part."""
        public = (name for name in vars(part) if not name.startswith("_") and name not in OF_ALL)
        vars(self).update({name: getattr(part, name) for name in public})

    def __dir__(self) -> list[str]:
        functions = (f"{name}{kind}" for name in self.FUNCTIONS for kind in ("", "_many"))
        return sorted({*super().__dir__(), *OF_ALL, *functions})

    def __repr__(self) -> str:
        return f"<module {self.__name__!r}, generated as used>"


Numbers = Iterable[float]
Arrays = Sequence[Any] | NDArray[Any]
Array = NDArray[Any]
Links = tuple[tuple[str, tuple[int, ...]], ...]
Rows = tuple[tuple[float, ...], ...]

#: The functions of `math` that generated functions call, of one argument and of two.
ELEMENTARY = ("sin", "cos", "tan", "exp", "log", "sqrt", "sinh", "cosh", "tanh", "atan")
BINARY = ("atan2", "pow")


class GeneratedModule(Protocol):
    """A module written by ``holonomic derive``, such as ``generated.double_pendulum``.

    Functions take ``(t, y, params)``; those of the parameters alone take ``(params)``, and
    ``inverse_dynamics`` and ``regressor`` take ``(t, y, qddot, params)``. With ``_many`` after its
    name a function takes arrays whose first axis is the state. The functions below exist for every
    system, those of momenta for systems without constraints; others where they are keys of
    ``OPERATIONS``.
    """

    __name__: str

    @property
    def __file__(self) -> str | None: ...
    @property
    def SYSTEM(self) -> str: ...
    @property
    def DIGEST(self) -> str: ...  # of the files of the system, which its header states, too
    @property
    def COORDINATES(self) -> tuple[str, ...]: ...
    @property
    def STATE(self) -> tuple[str, ...]: ...  # names of the components of (q, q̇)
    @property
    def STATES(self) -> Mapping[str, tuple[str, ...]]: ...  # of ``y`` in each form
    @property
    def FORMS(self) -> tuple[str, ...]: ...  # of the equations of motion
    @property
    def PARAMETERS(self) -> tuple[str, ...]: ...
    @property
    def SWITCHES(self) -> tuple[str, ...]: ...  # if forces have kinks or jumps
    @property
    def MULTIPLIERS(self) -> tuple[str, ...]: ...  # of constraints, if the system has any
    @property
    def RESIDUALS(self) -> tuple[str, ...]: ...  # of ``constraints``: those of rates end in _dot
    @property
    def INTEGRALS(self) -> tuple[str, ...]: ...  # functions that constraints keep at their values
    @property
    def LINKS(self) -> Links: ...  # kinds and numbers of ``points``, if the system has links
    @property
    def INPUTS(self) -> tuple[str, ...]: ...  # the last parameters, if the system has inputs
    @property
    def OUTPUTS(self) -> tuple[str, ...]: ...  # if the system has outputs
    @property
    def DEFAULTS(self) -> tuple[float, ...]: ...
    @property
    def POSITIVE(self) -> tuple[str, ...]: ...  # parameters and coordinates that must be
    @property
    def UNITS(self) -> Mapping[str, str]: ...
    @property
    def OPERATIONS(self) -> Mapping[str, tuple[int, int]]: ...  # of a call, and on parameters alone
    @property
    def CALLS_FUNCTIONS(self) -> tuple[str, ...]: ...  # that call the mathematical library
    @property
    def VARIABLES(self) -> Mapping[str, tuple[str, ...]]: ...  # of accelerations and mass_matrix
    @property
    def TIMED(self) -> tuple[str, ...]: ...  # functions that depend on time

    def rhs(self, t: float, y: Numbers, params: Numbers) -> tuple[float, ...]: ...
    def rhs_many(self, t: ArrayLike, y: Arrays, params: Arrays) -> Array: ...
    def jacobian(self, t: float, y: Numbers, params: Numbers) -> Rows: ...
    def jacobian_many(self, t: ArrayLike, y: Arrays, params: Arrays) -> Array: ...
    def energy(self, t: float, y: Numbers, params: Numbers) -> float: ...
    def energy_many(self, t: ArrayLike, y: Arrays, params: Arrays) -> Array: ...
    def mass_matrix(self, t: float, y: Numbers, params: Numbers) -> Rows: ...
    def mass_matrix_many(self, t: ArrayLike, y: Arrays, params: Arrays) -> Array: ...
    def positions(self, t: float, y: Numbers, params: Numbers) -> Rows: ...
    def positions_many(self, t: ArrayLike, y: Arrays, params: Arrays) -> Array: ...
    def hamiltonian_state(self, t: float, y: Numbers, params: Numbers) -> tuple[float, ...]: ...
    def hamiltonian_state_many(self, t: ArrayLike, y: Arrays, params: Arrays) -> Array: ...
    def rhs_hamiltonian(self, t: float, y: Numbers, params: Numbers) -> tuple[float, ...]: ...
    def rhs_hamiltonian_many(self, t: ArrayLike, y: Arrays, params: Arrays) -> Array: ...
    def lagrangian_state(self, t: float, y: Numbers, params: Numbers) -> tuple[float, ...]: ...
    def lagrangian_state_many(self, t: ArrayLike, y: Arrays, params: Arrays) -> Array: ...
    def params(self, **values: float) -> tuple[float, ...]: ...
    def __hash__(self) -> int: ...


def title(module: GeneratedModule) -> str:
    """The title of the system: the first line of the docstring, without its full stop."""
    return str(module.__doc__).partition("\n")[0].removesuffix(".")


def equations_of_motion(module: GeneratedModule) -> tuple[str, ...]:
    """Equations of motion and of constraints, from the docstring; none if they are long."""
    rows: dict[str, list[str]] = {}
    for section in str(module.__doc__).split("\n\n"):
        heading, *lines = section.splitlines()
        parts = rows.setdefault(heading.partition(",")[0].rstrip(":"), [])
        for line in lines:
            if line.startswith(" " * 8):  # the rest of a long formula
                parts[-1] += f" {line.strip()}"
            else:
                parts.append(line.strip())
    motion = rows.get("Equations of motion", [])
    constraints = [row.partition(": ")[0] for row in rows.get("Constraints", [])]
    return (*motion, *constraints) if motion else ()


def functions(module: GeneratedModule) -> Collection[str]:
    """Names of the functions of a generated module."""
    return module.FUNCTIONS if isinstance(module, LazyModule) else module.OPERATIONS


def part(module: GeneratedModule, *names: str) -> GeneratedModule:
    """The module, or one of the same system with at least these functions."""
    return module.part(names) if isinstance(module, LazyModule) else module


def has_function(module: GeneratedModule, name: str) -> bool:
    """Whether a generated module has the function `name`, and so ``name_many``."""
    return name in functions(module)


def function(module: GeneratedModule, name: str) -> Callable[..., Any]:
    """The function `name`, or ``name_many``, of a generated module; ValueError without it."""
    if not has_function(module, name.removesuffix("_many")):
        known = ", ".join(functions(module))
        raise ValueError(f"{module.SYSTEM} has no function {name!r}; it has {known}")
    return cast("Callable[..., Any]", getattr(module, name))


def with_functions(
    function: Callable[..., Any], functions: Mapping[str, Callable[..., Any]]
) -> Callable[..., Any]:
    """A generated function that calls these functions in place of those of `math`, by name."""
    # the same code in another namespace, so that the function takes numbers of any kind
    original = cast("FunctionType", function)
    return FunctionType(original.__code__, {**original.__globals__, **functions})


def named(stem: str, form: str) -> str:
    """The name of a function in a form: ``rhs`` in Lagrange's form, else ``rhs_rational`` etc."""
    return stem if form == "lagrangian" else f"{stem}_{form}"


def switching_functions(module: GeneratedModule) -> tuple[str, ...]:
    """The functions at whose zeros forces have kinks or jumps."""
    return module.SWITCHES if has_function(module, "switches") else ()


def has_constraints(module: GeneratedModule) -> bool:
    """Whether motions have constraints."""
    return has_function(module, "constraints")


def position_constraints(module: GeneratedModule) -> int:
    """Number of constraints of coordinates, whose residuals are the first of `constraints`."""
    names = module.RESIDUALS if has_constraints(module) else ()
    return sum(f"{name}_dot" in names for name in names)


def integrals(module: GeneratedModule) -> tuple[str, ...]:
    """Functions that constraints of velocities keep at their values at the start."""
    return module.INTEGRALS if has_function(module, "integrals") else ()


def inputs(module: GeneratedModule) -> tuple[str, ...]:
    """Names of the inputs, which are the last parameters of systems that have inputs."""
    return module.INPUTS if has_function(module, "input_jacobian") else ()


def outputs(module: GeneratedModule) -> tuple[str, ...]:
    """Names of the outputs."""
    return module.OUTPUTS if has_function(module, "outputs") else ()


def motion_times(module: GeneratedModule) -> tuple[str, ...]:
    """Inputs that are the times of prescribed motions: ``s_time`` beside ``s`` and its rates."""
    names = inputs(module)
    parts = {s: (f"{s}_dot", f"{s}_ddot", f"{s}_time") for s in names}
    return tuple(time for *rates, time in parts.values() if {*rates, time} <= {*names})


def links(module: GeneratedModule) -> Links:
    """How pictures join the points of a system: kinds, and numbers of points."""
    return module.LINKS if has_function(module, "points") else ()


def operations_on_state(module: GeneratedModule, name: str) -> int:
    """Operations of a call, without those on parameters alone, which are done once a run."""
    total, on_parameters = part(module, name).OPERATIONS[name]
    return total - on_parameters


def depends_on_time(module: GeneratedModule, name: str = "rhs") -> bool:
    """Whether a function does; by default the equations of motion."""
    return name in part(module, name).TIMED


def header(module: GeneratedModule) -> Path | None:
    """The C header beside a generated module; None where there is no such file."""
    if module.__file__ is None:
        return None
    path = Path(module.__file__).with_suffix(".h")
    return path if path.is_file() else None


def has_header(module: GeneratedModule) -> bool:
    """Whether the functions of a generated module have C headers."""
    return header(part(module)) is not None


def has_perturbation(form: str) -> bool:
    """Whether states in a form contain a linear perturbation."""
    return form in ("variational", "sensitivity")


def state_names(module: GeneratedModule, form: str) -> tuple[str, ...]:
    """Names of an ordinary state: (q, q̇), and in some forms those of a perturbation."""
    return (*module.STATE, *(perturbations(module.STATE) if has_perturbation(form) else ()))


def independent_perturbations(module: GeneratedModule) -> int:
    """Number of independent perturbations of a state that keep the constraints."""
    return len(module.STATE) - len(module.RESIDUALS if has_constraints(module) else ())


def parameter_names(module: GeneratedModule, form: str) -> tuple[str, ...]:
    """Names of the parameters of a form, in the sensitivity form after their perturbations."""
    changes = perturbations(module.PARAMETERS) if form == "sensitivity" else ()
    return (*changes, *module.PARAMETERS)


def perturbations(names: Iterable[str]) -> tuple[str, ...]:
    """Names of perturbations."""
    return tuple(f"delta_{name}" for name in names)
