"""A mechanical system: positions of masses as functions of generalized coordinates."""

from collections.abc import Mapping
from dataclasses import dataclass
from html import escape
from itertools import chain

import sympy as sp

from derive.formulas.typeset.typesetting import Formula
from derive.system.constraints import Eliminated, constraints
from derive.system.declaration import Declaration
from derive.system.line_links import Link
from derive.system.naming import check_module_name, check_name, check_unique
from derive.system.parts import (
    Coordinate,
    Input,
    Parameter,
    PointMass,
    SystemDefinitionError,
    check_text,
    formula,
    formulas,
    items,
)
from derive.system.symbols import as_functions_of_time, parts
from derive.system.system_checks import check
from solvers.io.suggestion import shortened

#: Types of the parts of a system.
KINDS = {
    "coordinates": Coordinate,
    "parameters": Parameter,
    "inputs": Input,
    "masses": PointMass,
    "reactions": sp.Symbol,
    "links": Link,
    "eliminated": Eliminated,
}


@dataclass(frozen=True)
class System(Declaration):
    """A holonomic system: coordinates, parameters, masses and forces.

    Parameters
    ----------
    name : str
        Identifier, also the name of the generated module.
    title : str
        A description of one line.
    coordinates : sequence of Coordinate
        Generalized coordinates q, in the order of the state.
    parameters : sequence of Parameter
        Constants, in the order of ``params``.
    masses : sequence of PointMass and RigidBody
        Masses and bodies, with positions r(q, t) in m; time is ``derive.TIME``.
    potential : sympy.Expr, optional
        Potential energy V(q, t) in J without that of `gravity`. If neither is given, there is
        uniform gravity along the last axis, downwards, with the parameter named ``g``.
    gravity : sequence of sympy.Expr, optional
        Acceleration of free fall, one component for each of a position's, in m/s².
    dissipation : sympy.Expr, optional
        Rayleigh's function R(q, q̇, t) in W: the force is -∂R/∂q̇. If it is quadratic in the
        velocities (``derive.velocity(theta)``), it is half the dissipated power.
    forces : sequence of sympy.Expr, optional
        Further generalized forces Q(q, q̇, t), one for each coordinate: in N along a length,
        in N m about an angle.
    equilibrium : sequence of sympy.Expr, optional
        Coordinates of the equilibrium about which ``linear`` describes small motions. By
        default zeros if they are an equilibrium; otherwise there is no ``linear``.
    reactions : sequence of sympy.Symbol, optional
        Parameters, such as lengths of rods, whose constraint forces are requested: a rod's
        tension.
    inputs : sequence of Input, optional
        Quantities in `forces`, `dissipation` and `potential` that may change during a motion.
        Positions may contain those that are prescribed motions, or that `derive.with_inputs`
        replaces.
    outputs : mapping of str to sympy.Expr, optional
        Measured quantities, by name, as functions of coordinates, velocities, parameters, inputs
        and time; the module has them and their derivatives as functions.
    constraints : sequence of sympy.Expr and Constraint, optional
        Functions that remain 0 along a motion: of coordinates, parameters and time, or affine in
        the velocities.
    coincide : sequence of pairs of points, optional
        Points, each a sequence of components in m, that remain together, such as the ends of two
        rods at a pin. They become `constraints`.
    links : sequence of Rod, Thread, Spring, Rail, Plate, Wheel, Block, Cart and Box, optional
        How pictures join the masses and other points; by default rods between masses at a constant
        distance.
    keep_coordinates : bool, optional
        Whether generated modules keep coordinates that constraints determine (`derive.reduced`).
    eliminated : sequence of Eliminated, optional
        Coordinates that were eliminated, with their constraints, as `derive.reduced` states them.

    Raises
    ------
    SystemDefinitionError
        When coordinates, parameters, inputs or masses are not a list of these, or there is no
        coordinate or no mass; when `title` is not one line that generated files can contain; when a
        name is no identifier, reserved or used twice; when a value is neither a real expression nor
        a finite number, or contains an unknown symbol; when positions do not all have two or all
        three components; when `gravity` or `forces` has a wrong number of components, or weight
        needs a parameter named ``g``; when `dissipation` depends on no velocity; when `reactions`
        are combined with applied forces or constraints; when a constraint depends on no coordinate
        or velocity, or is not affine in the velocities.

    Examples
    --------
    >>> from sympy import symbols
    >>> from derive import Coordinate, Derivation, Parameter, PointMass
    >>> x, g = symbols("x g", real=True)
    >>> m = symbols("m", positive=True)
    >>> ball = System(
    ...     "ball", "A ball on a ramp of 45 degrees", [Coordinate(x, "m", "along the ground")],
    ...     [Parameter(m, "kg", 1.0, "mass"), Parameter(g, "m/s^2", 9.81, "gravity")],
    ...     [PointMass(m, (x, -x))],
    ... )
    >>> Derivation(ball).accelerations[0]
    g/2
    """

    def __post_init__(self) -> None:
        for field, kind in KINDS.items():
            contents = f"a list of {kind.__name__} objects"
            object.__setattr__(self, field, items(field, getattr(self, field), contents, kind))
        for field in ("gravity", "forces", "equilibrium"):
            if getattr(self, field) is not None:
                contents = "one formula for each component"
                object.__setattr__(self, field, formulas(field, getattr(self, field), contents))
        for field in ("potential", "dissipation"):
            if getattr(self, field) is not None:
                object.__setattr__(self, field, formula(getattr(self, field)))
        pairs = self.outputs.items() if isinstance(self.outputs, Mapping) else self.outputs
        pairs = items("outputs", pairs, "a mapping of names to formulas", tuple)
        measured = tuple((str(name), formula(value)) for name, value in pairs)
        object.__setattr__(self, "outputs", measured)
        of_bodies = [one for mass in self.masses for one in mass.conditions]
        all_constraints = constraints(self.constraints, self.coincide, of_bodies)
        object.__setattr__(self, "constraints", all_constraints)
        object.__setattr__(self, "coincide", ())  # now among the constraints
        if not self.coordinates or not self.masses:
            raise SystemDefinitionError(
                f"system {self.name!r} needs at least one coordinate and one mass, "
                f"got {len(self.coordinates)} and {len(self.masses)}"
            )
        check_text(f"the title of system {self.name!r}", self.title)
        self._prescribe()
        self._check_names()
        check(self)

    def _repr_html_(self) -> str:
        """Title, positions and symbols with their units, for notebooks."""
        positions = (
            Formula.of(f"r{k}", sp.Matrix(mass.position)).html
            for k, mass in enumerate(self.masses, 1)
        )
        symbols: list[Coordinate | Parameter | Input] = [*self.coordinates, *self.parameters]
        rows = "".join(
            f"<tr><td>{Formula(part.symbol.name).html}</td><td>{escape(part.unit)}</td>"
            f"<td>{escape(part.meaning)}</td></tr>"
            for part in [*symbols, *self.inputs]
        )
        head = f"<h3>{escape(self.title)}</h3>{''.join(positions)}"
        return f"{head}<table><tr><th>symbol</th><th>unit</th><th>meaning</th></tr>{rows}</table>"

    def _prescribe(self) -> None:
        """Let motions among the inputs be functions of time with a constant acceleration."""
        known = {part.symbol for part in self.inputs}
        values = as_functions_of_time(
            part
            for part in self.inputs
            if not {other.symbol for other in parts(part)} <= known  # or else it is one already
        )
        if not values:
            return

        def at_any_time(expression: sp.Expr) -> sp.Expr:
            return expression.xreplace(values)

        inputs = [parts(part) if part.symbol in values else (part,) for part in self.inputs]
        changes: dict[str, object] = {
            "inputs": tuple(chain(*inputs)),
            "masses": tuple(mass.mapped(at_any_time) for mass in self.masses),
            "forces": tuple(map(at_any_time, self.forces)),
            "dissipation": at_any_time(self.dissipation),
            "outputs": tuple((name, at_any_time(value)) for name, value in self.measured),
            "constraints": tuple(
                one.with_formula(at_any_time(one.formula)) for one in self.conditions
            ),
        }
        changes["links"] = tuple(link.mapped(at_any_time) for link in self.links)
        if self.potential is not None:
            changes["potential"] = at_any_time(self.potential)
        for field, value in changes.items():
            object.__setattr__(self, field, value)

    def _check_names(self) -> None:
        check_module_name(self.name)
        declared = [s.name for s in (*self.q, *self.params)]
        measured = [name for name, _ in self.measured]
        reactions = [one.name for one in self.conditions]
        for name in [self.name, *declared, *measured, *reactions]:
            check_name(name, self.name)
        check_unique(measured, self.name)
        check_unique(declared, self.name)
        derived = self.qdot + self.qddot + self.p + self.variations + self.parameter_variations
        waves = (f"{wave}_{q.name}" for q in self.q for wave in ("sin", "cos"))
        check_unique([*declared, *reactions, *(s.name for s in derived), *waves], self.name)


def as_system(value: object) -> System:
    """`value`, refused if it is not a `System`, such as the name of one."""
    if isinstance(value, System):
        return value
    raise SystemDefinitionError(
        f"{shortened(value)} is not a System: derive.load returns that of a name or a system file"
    )
