"""From positions to equations of motion, in the steps of a textbook.

Every step is a SymPy value that can be printed, compared, or typeset in a
notebook. Time is an additional coordinate whose velocity is 1: M̄ = Σ m J̄ᵀJ̄ with
J̄ = ∂r/∂(q, t) contains the mass matrix and the terms of moving pivots. All other
results follow from M̄, the potential and the applied forces (L. D. Landau, E. M.
Lifshitz, Mechanics, § 5 and § 40; C. Lanczos, The Variational Principles of
Mechanics, chapter VI, for time as a coordinate).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING

import sympy as sp

from derive.mechanics.constraints.differentiated_constraints import Constraints
from derive.mechanics.energies.kinetics import Matrix
from derive.mechanics.independence import check_independence, is_singular
from derive.mechanics.linearisation.closed_form_equilibria import equilibria
from derive.mechanics.linearisation.point import Formula, OperatingPoint
from derive.mechanics.linearisation.point import outputs as output_formulas
from derive.mechanics.linearisation.small_oscillations import Linearisation, SmallOscillations
from derive.mechanics.linearisation.state_space import StateSpace, state_space
from derive.mechanics.regressor import Regressor, regressor
from derive.mechanics.steps import StepByStep
from derive.system.constraints import Constraint
from derive.system.parts import PointMass, SystemDefinitionError, formula
from derive.system.rigid_body import RigidBody
from derive.system.symbols import prescribed_symbols
from derive.system.system import System, as_system
from solvers.io.suggestion import did_you_mean, warn_caller

if TYPE_CHECKING:
    from derive.mechanics.identifiability import Identifiability


class RedundancyWarning(UserWarning):
    """Constraints follow from others, and are left out."""


def _with_conditions(mass: PointMass, kept: Sequence[Constraint]) -> PointMass:
    """The body without conditions of its orientation that are left out of the constraints."""
    if not isinstance(mass, RigidBody) or not mass.axes:
        return mass
    conditions = tuple(one for one in mass.conditions if any(c.is_multiple(one) for c in kept))
    return replace(mass, orientation=replace(mass.axes, conditions=conditions))


def warn_of_redundancy(system: System, redundant: Sequence[Constraint]) -> None:
    """Warn that constraints are left out."""
    names = ", ".join(one.name for one in redundant)
    warn_caller(
        f"constraints of system {system.name!r} are redundant and left out: {names}; they follow "
        "from the others, so that their reactions are not determined",
        RedundancyWarning,
    )


@dataclass(frozen=True)
class Derivation(StepByStep):
    """The mechanics of `system`; each result is derived when it is first used.

    Notebooks display its steps as mathematics.

    Parameters
    ----------
    system : System
        A system.

    Attributes
    ----------
    system : System
        The system, without redundant constraints.
    redundant : tuple of Constraint
        Constraints that follow from the others, with the default values of parameters.

    Raises
    ------
    SystemDefinitionError
        When `system` is not a `System`; when positions contain an input that is no motion; when a
        coordinate moves no mass, or moves the masses only
        as others do, or has no inertia that is a positive number; when no configuration satisfies
        the constraints, with default parameters, or none at which they are independent.

    Warns
    -----
    derive.mechanics.derivation.RedundancyWarning
        When constraints are redundant.

    Notes
    -----
    Velocities, accelerations and momenta are symbols (``system.qdot``,
    ``system.qddot``, ``system.p``), not functions of time.

    Examples
    --------
    >>> from derive import load
    >>> single = Derivation(load("single_pendulum"))
    >>> single.lagrangian
    g*l*m*cos(theta) + l**2*m*theta_dot**2/2
    >>> single.accelerations[0]
    -g*sin(theta)/l
    """

    redundant: tuple[Constraint, ...] = field(init=False, default=(), repr=False, compare=False)

    def __post_init__(self) -> None:
        as_system(self.system)
        self._check_inputs()
        if self.system.conditions:
            self._leave_out_redundant()
        if self.has_singular_mass_matrix:
            inertia, G = self.mass_matrix, self.constraint_jacobian
            check_independence(self.system, inertia + G.T * G)
        elif not self.system.conditions and not self._has_regular_tree:
            check_independence(self.system, self.mass_matrix)

    def _leave_out_redundant(self) -> None:
        # loads NumPy, which derivations without constraints do not need
        from derive.mechanics.constraints.redundancy import independent

        kept, redundant = independent(Constraints(self.system))
        if redundant:
            warn_of_redundancy(self.system, redundant)
            masses = [_with_conditions(mass, kept) for mass in self.system.masses]
            system = replace(self.system, masses=masses, constraints=kept)
            object.__setattr__(self, "system", system)
            object.__setattr__(self, "redundant", redundant)

    def _check_inputs(self) -> None:
        system = self.system
        positions = sp.Tuple(*(r for mass in system.masses for r in mass.placement))
        prescribed = prescribed_symbols(system.inputs)
        if others := positions.free_symbols & {*system.u} - prescribed:
            names = ", ".join(sorted(symbol.name for symbol in others))
            raise SystemDefinitionError(
                f"positions of system {system.name!r} depend on {names}, whose derivatives are not "
                "known: declare a prescribed motion, Input(..., motion=True), replace the input by "
                "a function of time, with derive.with_inputs, or let forces depend on it"
            )

    @cached_property
    def has_singular_mass_matrix(self) -> bool:
        """Whether some motions of the coordinates, which constraints prevent, move no mass."""
        inertia = self.tree.inertia if self.tree else self.mass_matrix
        return bool(self.system.conditions) and is_singular(self.system, inertia)

    @property
    def _has_regular_tree(self) -> bool:
        return bool(self.tree and not is_singular(self.system, self.tree.inertia))

    @property
    def has_tree(self) -> bool:
        """Whether equations are sums along the branches of a kinematic tree."""
        return bool(self.tree and not self.has_singular_mass_matrix and not self.integrals)

    def linearisation(self, equilibrium: Sequence[sp.Expr] | None = None) -> Linearisation:
        """Small oscillations about an equilibrium, by default the system's own, or zeros.

        With constraints, displacements are those of independent coordinates. A
        `SystemDefinitionError` states that a force or a constraint is not 0 there, or that small
        motions depend on time, have applied or gyroscopic forces, constraints of velocities, or no
        finite mass and stiffness matrix.
        """
        if equilibrium is None:
            return self._default_linearisation
        return self._small_oscillations.linearised(tuple(map(formula, equilibrium)))

    def state_space(
        self,
        at: Mapping[str, Formula] | None = None,
        outputs: Sequence[Formula] | None = None,
    ) -> StateSpace:
        """A, B, C and D about any point, as functions of parameters.

        With constraints, these are matrices of independent components of the state, as those of
        `solvers.linearise`.

        Parameters
        ----------
        at : mapping of str to sympy.Expr, number or str, optional
            Coordinates, velocities, inputs and the time ``t`` of the point, by name. Coordinates
            that are left out are those of the system's equilibrium, or 0, others are 0.
        outputs : sequence of sympy.Expr, number or str, optional
            Functions of state, inputs, parameters and time; by default the components of the state.

        Returns
        -------
        StateSpace

        Raises
        ------
        SystemDefinitionError
            When a name is unknown, when the equations are not finite there, or when a constraint or
            its rate is not 0 there, or constraints depend on each other.

        Examples
        --------
        >>> from derive import load
        >>> hanging = Derivation(load("single_pendulum")).state_space(outputs=["l*sin(theta)"])
        >>> hanging.C
        Matrix([[l, 0]])
        """
        point = OperatingPoint.of(self.system, at or {})
        return state_space(point, self, outputs)

    def identifiable(
        self,
        unknown: Sequence[str] | None = None,
        outputs: Sequence[Formula] | None = None,
    ) -> "Identifiability":
        """Which parameters a measurement of outputs determines, decided from the equations.

        Parameters
        ----------
        unknown : sequence of str, optional
            Names of the unknown parameters; by default all. The start of a motion is unknown, too;
            inputs are known functions of time.
        outputs : sequence of sympy.Expr, number or str, optional
            Measured functions of state, parameters and time, or names: components of the state,
            ``energy``, and positions of the masses, ``x1``, ``y1``, ``x2`` ...; by default the
            coordinates.

        Returns
        -------
        Identifiability

        Raises
        ------
        SystemDefinitionError
            When a name is unknown, or the system has constraints.

        Examples
        --------
        >>> from derive import load
        >>> print(Derivation(load("double_pendulum")).identifiable(outputs=["x1", "y1"]))
        l1, l2, g: determined
        m1, m2: only as m2/m1; give one of them a value
        """
        if self.system.conditions:
            names = ", ".join(one.name for one in self.system.conditions)
            raise SystemDefinitionError(
                f"system {self.system.name!r} has constraints, {names}: identifiable parameters, "
                "and thus fits, need independent coordinates; write positions as functions of "
                "these, declare those coordinates positive that are, or use "
                "Derivation(derive.reduced(system)) if no constraint remains there"
            )
        known = {part.symbol.name: part.symbol for part in self.system.parameters}
        for name in unknown or ():
            if name not in known:
                raise SystemDefinitionError(
                    f"system {self.system.name!r} has no parameter {name[:50]!r}"
                    f"{did_you_mean(name, known)}; known are {', '.join(known)}"
                )
        symbols = [known[name] for name in (known if unknown is None else unknown)]
        formulas = self.system.q if outputs is None else output_formulas(self, outputs)
        # loads NumPy, which derivations do not need
        from derive.mechanics.identifiability import identifiability

        return identifiability(self.system, self.mass_matrix, self.forcing, formulas, symbols)

    @cached_property
    def regressor(self) -> Regressor:
        """Y and base parameters π of the forces M q̈ - f = Y π, with inputs 0.

        Inputs of prescribed motions keep their values. With constraints, the forces include those
        of the constraints.
        """
        prescribed = prescribed_symbols(self.system.inputs)
        at_rest = {u: sp.S.Zero for u in self.system.u if u not in prescribed}
        rows = range(len(self.system.q))
        accelerations = Matrix(self.system.qddot)
        forces = [(self.mass_matrix.row(i) * accelerations)[0] - self.forcing[i] for i in rows]
        parameters = [part.symbol for part in self.system.parameters]
        return regressor([force.subs(at_rest) for force in forces], parameters)

    def equilibria(self, at: Mapping[str, Formula] | None = None) -> list[dict[sp.Symbol, sp.Expr]]:
        """All equilibria in closed form, as functions of parameters and inputs.

        Parameters
        ----------
        at : mapping of str to sympy.Expr, number or str, optional
            Inputs, by name, that have values; the others remain symbols. Velocities of a steady
            motion, of coordinates on which no force depends; other velocities are 0.

        Returns
        -------
        list of dict of sympy.Symbol to sympy.Expr
            Coordinates, angles within one turn; they exist where they are real. A coordinate on
            which no force depends is its own symbol.

        Raises
        ------
        SystemDefinitionError
            When no closed form is found; `solvers.equilibria` finds equilibria in numbers.

        Examples
        --------
        >>> from derive import load
        >>> for equilibrium in Derivation(load("rotating_hoop")).equilibria():
        ...     print(equilibrium)
        {theta: 0}
        {theta: pi}
        {theta: -acos(g/(Omega**2*R)) + 2*pi}
        {theta: acos(g/(Omega**2*R))}
        """
        point = OperatingPoint.of(self.system, at or {})
        moving = {*self.system.qdot}
        values = {s: x for s, x in point.values.items() if s in moving or s.name in (at or {})}
        return equilibria(OperatingPoint(self.system, values), self)

    @cached_property
    def _default_linearisation(self) -> Linearisation:
        return self._small_oscillations.linearised(self._default_equilibrium)

    @cached_property
    def is_linearisable(self) -> bool:
        """Whether masses and springs describe small motions of all coordinates."""
        if self.system.conditions:
            return False
        try:
            self.linearisation()
        except SystemDefinitionError:
            return False
        return True

    @cached_property
    def equilibrium(self) -> tuple[sp.Expr, ...] | None:
        """The system's equilibrium, or zeros if they are one; None if none is known.

        None for systems with constraints, whose equilibria `solvers.equilibria` finds in numbers.
        """
        if self.system.conditions:
            return None
        try:
            self._small_oscillations.check_equilibrium(self._default_equilibrium)
        except SystemDefinitionError:
            if self.system.equilibrium is not None:
                raise
            return None
        return self._default_equilibrium

    @property
    def _small_oscillations(self) -> SmallOscillations:
        return SmallOscillations(self)

    @property
    def _default_equilibrium(self) -> tuple[sp.Expr, ...]:
        given = self.system.equilibrium
        return (sp.S.Zero,) * len(self.system.q) if given is None else tuple(given)
