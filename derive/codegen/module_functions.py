"""The functions of a generated module, each with its operations."""

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cache

from derive.codegen.expression_graph.rational import with_fewest_calls
from derive.codegen.forms.equations_of_motion import EquationsOfMotion, OutputForm
from derive.codegen.forms.jacobians import HamiltonianJacobian, LagrangianJacobians
from derive.codegen.forms.kinematic_tree_form import TreeForm
from derive.codegen.forms.projection_form import ProjectionForm
from derive.codegen.forms.quaternion_form import QuaternionForm
from derive.codegen.function_specs import FORCES, OF_EXPORTS, SPECS, Form, FunctionSpec, is_small
from derive.codegen.operations.lowering import Lowering
from derive.mechanics.derivation import Derivation
from derive.system.symbols import TIME
from derive.system.system import System

#: The axis of base parameters, whose length is derived when it is needed.
BASE = "base"


@dataclass(frozen=True)
class Function:
    """A function of the generated module of a system."""

    system: System
    name: str
    summary: str  # first line of its docstring
    returns: str
    form: Form
    state: tuple[str, ...]  # components of the state that it takes, in order
    shape: tuple[int, ...]  # of the result; () is a single number
    lowering: Lowering  # its outputs are the result, flat in C order
    accelerations: tuple[str, ...] = ()  # that it takes after the state
    takes_signs: bool = False  # of switching functions, after the parameters
    constants: tuple[str, ...] = ()  # values of integrals, after the parameters

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of the parameters, in order, in the sensitivity form after perturbations."""
        changes = self.system.parameter_variations if self.form == "sensitivity" else ()
        names = (symbol.name for symbol in (*changes, *self.system.params))
        return (*names, *self.constants)

    def arguments(self, state: str) -> dict[str, tuple[str, ...]]:
        """Names of the components of the arguments, of which the state is called `state`."""
        rates = {"qddot": self.accelerations} if self.accelerations else {}
        return {state: self.state, **rates, "params": self.parameters}

    @property
    def is_derivative(self) -> bool:
        """Whether it is of perturbations, about an equilibrium, a rare derivative or of forces."""
        is_jacobian = "jacobian" in self.name and self.name != "jacobian"
        is_of_forces = self.name in FORCES
        of_few = ("variational", "sensitivity", "parameters")
        return is_jacobian or is_of_forces or self.form in of_few

    @property
    def depends_on_time(self) -> bool:
        """Whether the result depends on time."""
        return TIME.name in self.lowering.inputs

    def variables_of(self, outputs: slice) -> tuple[str, ...]:
        """Names of the components of the state that some entries of the result depend on."""
        inputs = self.lowering.inputs_of(self.lowering.outputs[outputs])
        return tuple(name for name in self.state if name in inputs)

    @property
    def cost(self) -> str:
        """The number of operations, in words."""
        operations, constant = self.lowering.cost
        return f"{operations} operations, {constant} of them on parameters alone."


@dataclass(frozen=True)
class Contents:
    """The contents of generated files of a system, in any language."""

    derivation: Derivation
    names: tuple[str, ...]  # of the functions of the system, in these files or in others
    states: dict[Form, tuple[str, ...]]  # components of the state in each form that exists
    functions: tuple[Function, ...]
    is_complete: bool = False  # whether these are all files of a system

    @property
    def system(self) -> System:
        """The system."""
        return self.derivation.system

    @property
    def forms(self) -> tuple[Form, ...]:
        """Forms of the equations of motion: those that have a right-hand side."""
        names = ((spec.name, spec.form) for spec in SPECS if spec.name in self.names)
        forms = {form for name, form in names if name.startswith("rhs")}
        return tuple(form for form in self.states if form in forms)


def split(functions: Iterable[Function]) -> tuple[list[Function], list[Function]]:
    """The functions that every motion may need, and the derivatives that few need."""
    first, derivatives = list[Function](), list[Function]()
    for function in functions:
        (derivatives if function.is_derivative else first).append(function)
    return first, derivatives


class Functions:
    """The functions that exist for a derivation; each is generated when it is first requested.

    `names` are their names, in the order of generated files; `fastest` is that of the right-hand
    side of fewest calls of functions.
    """

    def __init__(self, derivation: Derivation) -> None:
        self._derivation, self._states = derivation, _states(derivation)
        self._sizes = _sizes(derivation, self._states)
        self._specs = {spec.name: spec for spec in SPECS if self._exists(spec)}
        self.names = tuple(self._specs)
        self.fastest = "rhs_rational" if "rhs_rational" in self.names else "rhs"
        self._function = cache(self._generated)

    def contents(self, only: Collection[str] | None = None) -> Contents:
        """The contents of files of all `usual` functions, or of a system with `only` some."""
        usual = self.usual if only is None else only
        names = tuple(name for name in self.names if name in usual)
        return replace(self._contents(names, names), is_complete=only is None)

    @property
    def usual(self) -> list[str]:
        """Names of the functions in files: of forces only if there are inputs to produce them.

        Others are generated when they are first used, of modules that are built.
        """
        is_driven = bool(self._derivation.system.inputs)
        left_out = OF_EXPORTS if is_driven else (*OF_EXPORTS, *FORCES)
        return [name for name in self.names if name not in left_out]

    def part(self, names: Collection[str]) -> Contents:
        """The contents of files of some functions of a system that has all."""
        return self._contents(self.names, names)

    def _contents(self, names: tuple[str, ...], generated: Collection[str]) -> Contents:
        functions = tuple(self._function(name) for name in names if name in generated)
        return Contents(self._derivation, names, self._states, functions)

    def _exists(self, spec: FunctionSpec) -> bool:
        has_state = spec.form == "parameters" or spec.form in self._states
        axes = {*spec.shape.split()} - {BASE}
        return has_state and axes <= {*self._sizes} and spec.exists(self._derivation)

    def _length(self, axis: str) -> int:
        if axis == BASE:
            return len(self._derivation.regressor.parameters)
        return self._sizes[axis]

    def _generated(self, name: str) -> Function:
        spec, derivation = self._specs[name], self._derivation
        detail, lowering = spec.detail(derivation), _lowering(spec, derivation)
        values = derivation.integral_values if name.startswith("correction") else ()
        return Function(
            derivation.system,
            name,
            spec.summary.format(detail),
            spec.returns.format(detail),
            spec.form,
            self._states.get(spec.form, ()),
            tuple(map(self._length, spec.shape.split())),
            lowering,
            tuple(s.name for s in derivation.system.qddot) if spec.takes_accelerations else (),
            takes_signs=bool(derivation.switching_functions),
            constants=tuple(symbol.name for symbol in values),
        )


def contents(derivation: Derivation, only: Collection[str] | None = None) -> Contents:
    """Everything that is generated for a derivation, or `only` the functions of these names."""
    return Functions(derivation).contents(only)


def _sizes(derivation: Derivation, states: Mapping[Form, tuple[str, ...]]) -> dict[str, int]:
    """Lengths of axes by name; a function whose result has an axis of no entries does not exist."""
    system = derivation.system
    lengths = {
        "q": len(system.q),
        "state": 2 * len(system.q),
        "2": 2,
        "4": 4,
        "axes": system.dimension,
        "masses": len(system.masses),
        "points": len(system.points),
        "inputs": len(system.inputs),
        "outputs": len(system.measured),
        "parameters": len(system.parameters),
        "params": len(system.params),
        "reactions": len(system.reactions),
        "switches": len(derivation.switching_functions),
        "multipliers": len(system.all_conditions),
        "residuals": len(system.conditions) + len(derivation.holonomic),
        "redundant": len(derivation.redundant),
        "integrals": len(derivation.integrals),
    }
    named = {name: length for name, length in lengths.items() if length}
    return named | {form: len(state) for form, state in states.items()}


def _lowering(spec: FunctionSpec, derivation: Derivation) -> Lowering:
    # The order of nodes in a graph determines the order of terms. With one graph for each function,
    # the code of a function does not depend on which others are generated.
    form: type[EquationsOfMotion] = LagrangianJacobians
    if spec.form == "hamiltonian":
        form = HamiltonianJacobian
    elif spec.name.startswith("outputs"):
        form = OutputForm
    elif derivation.has_tree:
        form = TreeForm
    elif derivation.has_quaternions and is_small(derivation):
        form = QuaternionForm
    elif spec.name.startswith("correction"):
        form = ProjectionForm
    outputs = getattr(form(derivation), spec.name)
    angles = [q.name for q in derivation.system.q]
    system = derivation.system
    constants = (*system.params, *system.parameter_variations, *derivation.integral_values)
    parameters = {s.name for s in constants}
    return Lowering(with_fewest_calls(outputs, angles), parameters)


def _states(derivation: Derivation) -> dict[Form, tuple[str, ...]]:
    form = TreeForm if derivation.has_tree else EquationsOfMotion
    system, angles = derivation.system, form(derivation).angles
    positions: list[str] = []
    for q in system.q:
        positions += [f"sin_{q.name}", f"cos_{q.name}"] if q in angles else [q.name]
    rational = (*positions, *(s.name for s in system.qdot))
    states: dict[Form, tuple[str, ...]] = {
        "lagrangian": tuple(s.name for s in system.q + system.qdot),
    }
    if not system.conditions:
        states["hamiltonian"] = tuple(s.name for s in system.q + system.p)
    if angles:
        states["rational"] = rational
    states["variational"] = (*rational, *(s.name for s in system.variations))
    states["sensitivity"] = states["variational"]
    return states
