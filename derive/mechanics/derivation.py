"""From positions to equations of motion, in the steps of a textbook.

Every step is a SymPy value that can be printed, compared, or typeset in a
notebook. Time is an additional coordinate whose velocity is 1: M̄ = Σ m J̄ᵀJ̄ with
J̄ = ∂r/∂(q, t) contains the mass matrix and the terms of moving pivots. All other
results follow from M̄, the potential and the applied forces (L. D. Landau, E. M.
Lifshitz, Mechanics, § 5 and § 40; C. Lanczos, The Variational Principles of
Mechanics, chapter VI, for time as a coordinate).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from typing import TypeAlias

import sympy as sp

from derive.formulas.switching import decisive_numbers, switching_functions
from derive.mechanics.equilibria import equilibria
from derive.mechanics.identifiability import Identifiability, identifiability
from derive.mechanics.independence import check_independence
from derive.mechanics.linearisation import Energies, Linearisation
from derive.mechanics.outputs import outputs as output_formulas
from derive.mechanics.reduction import collected, gathered, reduced
from derive.mechanics.state_space import Formula, Point, StateSpace, state_space
from derive.system.parts import SystemDefinitionError, formula
from derive.system.prescribed import motions
from derive.system.symbols import TIME
from derive.system.system import System, as_system
from solvers.io.suggestion import did_you_mean

Matrix: TypeAlias = sp.ImmutableDenseMatrix
HALF = sp.Rational(1, 2)


@dataclass(frozen=True)
class Derivation:
    """The mechanics of `system`; each result is derived when it is first used.

    Parameters
    ----------
    system : System
        A system.

    Raises
    ------
    SystemDefinitionError
        When `system` is not a `System`; when positions contain an input that is no motion; when a
        coordinate moves no mass, or moves the masses only
        as others do, or has no inertia that is a positive number.

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

    system: System

    def __post_init__(self) -> None:
        as_system(self.system)
        self._check_inputs()
        check_independence(self.system, self.mass_matrix)

    def _check_inputs(self) -> None:
        system = self.system
        positions = sp.Tuple(*(r for m in system.masses for _, r in m.motions))
        prescribed = {s for parts in motions(system.inputs).values() for s in parts}
        if others := positions.free_symbols & {*system.u} - prescribed:
            names = ", ".join(sorted(symbol.name for symbol in others))
            raise SystemDefinitionError(
                f"positions of system {system.name!r} depend on {names}, whose derivatives are not "
                "known: declare a prescribed motion, Input(..., motion=True), replace the input by "
                "a function of time, with derive.with_inputs, or let forces depend on it"
            )

    @cached_property
    def position_jacobians(self) -> tuple[Matrix, ...]:
        """J = ∂r/∂q of each mass, one row a component, one column a coordinate."""
        q = self.system.q
        return tuple(Matrix(mass.position).jacobian(q) for mass in self.system.masses)

    @cached_property
    def velocities(self) -> tuple[Matrix, ...]:
        """Velocity J q̇ + ∂r/∂t of each mass, a column of two or three components."""
        qdot = Matrix(self.system.qdot)
        return tuple(
            jacobian * qdot + Matrix(mass.position).diff(TIME)
            for jacobian, mass in zip(self.position_jacobians, self.system.masses, strict=True)
        )

    @cached_property
    def variables(self) -> tuple[sp.Symbol, ...]:
        """Coordinates, time if positions depend on it, and lengths with requested reactions."""
        positions = sp.Tuple(*(r for m in self.system.masses for _, r in m.motions))
        time = (TIME,) if TIME in positions.free_symbols else ()
        return (*self.system.q, *time, *self.system.reactions)

    @cached_property
    def rates(self) -> tuple[sp.Expr, ...]:
        """Rates of change of the variables: q̇, 1 for time, 0 for constant lengths."""
        n = len(self.system.q)
        others = (sp.S.One if variable == TIME else sp.S.Zero for variable in self.variables[n:])
        return (*self.system.qdot, *others)

    @cached_property
    def inertia(self) -> Matrix:
        """M̄ = Σ m J̄ᵀJ̄ over all variables, symmetric; the mass matrix is its upper left part."""
        motions = [motion for mass in self.system.masses for motion in mass.motions]

        @cache
        def derivative(position: sp.Expr, variable: sp.Symbol) -> sp.Expr:
            # the positions of a chain share most of their terms
            if position.is_Add:
                return sp.Add(*(derivative(term, variable) for term in position.args))
            return _derivative(position, variable)

        tangents = [
            [tuple(derivative(r, v) for r in position) for v in self.variables]
            for _, position in motions
        ]
        dots: dict[object, sp.Expr] = {}

        def entry(i: int, j: int) -> sp.Expr:
            # masses below a joint share their dot products, which are reduced once
            inertias: dict[sp.Expr, sp.Expr] = {}
            for (inertia, _), tangent in zip(motions, tangents, strict=True):
                pair = (tangent[i], tangent[j])
                if pair not in dots:
                    products = (a * b for a, b in zip(*pair, strict=True))
                    dots[pair] = sp.factor_terms(reduced(sp.Add(*products)))
                inertias[dots[pair]] = inertias.get(dots[pair], sp.S.Zero) + inertia
            return sp.Add(*(total * dot for dot, total in inertias.items()))

        n = len(self.variables)
        upper = {(i, j): entry(i, j) for i in range(n) for j in range(i, n)}
        return Matrix(n, n, lambda i, j: upper[min(i, j), max(i, j)])

    @cached_property
    def mass_matrix(self) -> Matrix:
        """M(q, t), symmetric, n × n."""
        n = len(self.system.q)
        return self.inertia[:n, :n]

    @cached_property
    def kinetic_energy(self) -> sp.Expr:
        """T = ½ q̇ᵀ M q̇; with moving pivots also terms that are linear in q̇ or independent of it."""
        return self._quadratic(range(len(self.variables)))

    def _quadratic(self, variables: range) -> sp.Expr:
        """½ vᵀ M̄ v of some of the variables."""
        v, M = self.rates, self.inertia
        squares = [M[i, i] * v[i] ** 2 / 2 for i in variables]
        pairs = ((i, j) for j in variables for i in variables if i < j)
        return sp.Add(*squares, *(M[i, j] * v[i] * v[j] for i, j in pairs))

    @cached_property
    def potential_energy(self) -> sp.Expr:
        """V(q, t), one term for each function of the coordinates."""
        return gathered(self.system.potential_energy, *self.system.q)

    @cached_property
    def switching_functions(self) -> tuple[sp.Expr, ...]:
        """Functions of (q, q̇, t) at whose zeros forces have a kink or a jump."""
        return switching_functions(self._formulas, (*self.system.q, *self.system.qdot, TIME))

    @cached_property
    def decisive_numbers(self) -> tuple[sp.Expr, ...]:
        """Switching functions, and others on which roots, powers and logarithms depend."""
        return decisive_numbers(self._formulas, (*self.system.q, *self.system.qdot, TIME))

    @property
    def _formulas(self) -> tuple[sp.Expr, ...]:
        masses = self.system.masses
        positions = (r for mass in masses for _, motion in mass.motions for r in motion)
        return (*positions, self.potential_energy, *self.system.applied)

    @cached_property
    def lagrangian(self) -> sp.Expr:
        """L = T - V."""
        return self.kinetic_energy - self.potential_energy

    @cached_property
    def effective_potential(self) -> sp.Expr:
        """U(q, t) = V - T₀, with T₀ the kinetic energy at q̇ = 0."""
        others = range(len(self.system.q), len(self.variables))
        return self.potential_energy - self._quadratic(others)

    @cached_property
    def energy(self) -> sp.Expr:
        """Jacobi's integral q̇·∂L/∂q̇ - L: T + V where no position depends on time."""
        return self._quadratic(range(len(self.system.q))) + self.effective_potential

    @cached_property
    def power(self) -> sp.Expr:
        """Rate of the energy: work of the applied forces, and -∂L/∂t."""
        work = (f * v for f, v in zip(self.system.applied, self.system.qdot, strict=True))
        return sp.Add(*work) - self.lagrangian.diff(TIME)

    @cached_property
    def momenta(self) -> Matrix:
        """Momenta p = ∂L/∂q̇ = M q̇ + b, a column."""
        return _product(self.mass_matrix, self.system.qdot) + self.drift

    @cached_property
    def drift(self) -> Matrix:
        """Momenta b at q̇ = 0, a column: Σ m Jᵀ ∂r/∂t, 0 if positions do not depend on time."""
        n = len(self.system.q)
        return _product(self.inertia[:n, n:], self.rates[n:])

    @cached_property
    def forcing(self) -> Matrix:
        """Right side f(q, q̇, t) of M q̈ = f, a column.

        f_i = -Σ_jk Γ_ijk v_j v_k - ∂V/∂q_i + Q_i, with v the rates of all variables and
        Γ_ijk Christoffel's symbols of the first kind of M̄.
        """
        state, forces = self.system.q + self.system.qdot, []
        for i, (q, applied) in enumerate(zip(self.system.q, self.system.applied, strict=True)):
            force = applied - self._inertial(i) - self.potential_energy.diff(q)
            forces.append(collected(force, *state))
        return Matrix(forces)

    def _inertial(self, i: int) -> sp.Expr:
        """Σ Γ_ijk v_j v_k for the variable i."""
        v, n = self.rates, range(len(self.variables))
        pairs = ((j, k, 1 if j == k else 2) for j in n for k in n[j:])
        terms = (self._christoffel(i, j, k) * v[j] * v[k] * count for j, k, count in pairs)
        return sp.Add(*terms)

    def _christoffel(self, i: int, j: int, k: int) -> sp.Expr:
        """½ (∂M̄_ij/∂q_k + ∂M̄_ik/∂q_j - ∂M̄_jk/∂q_i)."""
        q, M = self.variables, self.inertia
        return HALF * (
            _derivative(M[i, j], q[k]) + _derivative(M[i, k], q[j]) - _derivative(M[j, k], q[i])
        )

    @cached_property
    def euler_lagrange(self) -> Matrix:
        """Residuals d/dt ∂L/∂q̇ - ∂L/∂q - Q, a column, which are zero along a motion."""
        return _product(self.mass_matrix, self.system.qddot) - self.forcing

    @cached_property
    def reactions(self) -> Matrix:
        """Forces that hold the given lengths constant, a column: a rod's tension is positive.

        The multiplier of the constraint that a length l is constant is the force that is
        required if l is free: -(d/dt ∂L/∂l̇ - ∂L/∂l) at l̇ = l̈ = 0, a function of q, q̇ and q̈.
        """
        first, qddot = len(self.variables) - len(self.system.reactions), Matrix(self.system.qddot)
        forces = []
        for i, length in enumerate(self.variables[first:], first):
            inertial = -(self.inertia[i, : len(qddot)] * qddot)[0] - self._inertial(i)
            forces.append(inertial - self.potential_energy.diff(length))
        return Matrix(forces)

    @cached_property
    def _adjugate_and_determinant(self) -> tuple[Matrix, sp.Expr]:
        # not for generated code, which solves M w = p: the adjugate grows as n!
        return self.mass_matrix.adjugate(), sp.factor_terms(reduced(self.mass_matrix.det()))

    def _divided_by_mass(self, column: Matrix) -> Matrix:
        adjugate, determinant = self._adjugate_and_determinant
        state = self.system.q + self.system.qdot + self.system.p
        return (adjugate * column).applyfunc(
            lambda entry: sp.factor_terms(collected(entry, *state)) / determinant
        )

    @cached_property
    def accelerations(self) -> Matrix:
        """q̈ = M⁻¹ f, a column."""
        return self._divided_by_mass(self.forcing)

    @cached_property
    def hamiltonian(self) -> sp.Expr:
        """H(q, p, t) = ½ (p - b)ᵀ M⁻¹ (p - b) + U, the energy as a function of the momenta."""
        adjugate, determinant = self._adjugate_and_determinant
        p = Matrix(self.system.p) - self.drift
        numerator = collected((p.T * adjugate * p)[0, 0], *self.system.q, *self.system.p)
        return sp.factor_terms(numerator) / (2 * determinant) + self.effective_potential

    @cached_property
    def hamilton_equations(self) -> tuple[Matrix, Matrix]:
        """(q̇, ṗ) = (∂H/∂p, -∂H/∂q + Q), two columns; canonical without applied forces."""
        velocities = self._divided_by_mass(Matrix(self.system.p) - self.drift)
        known = dict(zip(self.system.qdot, velocities, strict=True))
        pairs = zip(self.system.q, self.system.applied, strict=True)
        rates = [force.subs(known) - self.hamiltonian.diff(q) for q, force in pairs]
        return velocities, Matrix(rates)

    def linearisation(self, equilibrium: Sequence[sp.Expr] | None = None) -> Linearisation:
        """Small oscillations about an equilibrium, by default the system's own, or zeros.

        A `SystemDefinitionError` states that a force is not 0 there, or that small motions depend
        on time, have applied or gyroscopic forces, or no finite mass and stiffness matrix.
        """
        if equilibrium is None:
            return self._default_linearisation
        return self._energies.linearised(tuple(map(formula, equilibrium)))

    def state_space(
        self,
        at: Mapping[str, Formula] | None = None,
        outputs: Sequence[Formula] | None = None,
    ) -> StateSpace:
        """A, B, C and D about any point, as functions of parameters.

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
            When a name is unknown, or the equations are not finite there.

        Examples
        --------
        >>> from derive import load
        >>> hanging = Derivation(load("single_pendulum")).state_space(outputs=["l*sin(theta)"])
        >>> hanging.C
        Matrix([[l, 0]])
        """
        point = Point.of(self.system, at or {})
        return state_space(point, self.mass_matrix, self.forcing, outputs)

    def identifiable(
        self,
        unknown: Sequence[str] | None = None,
        outputs: Sequence[Formula] | None = None,
    ) -> Identifiability:
        """Which parameters a measurement of outputs determines, decided from the equations.

        Parameters
        ----------
        unknown : sequence of str, optional
            Names of the unknown parameters; by default all. The start of a motion is unknown, too.
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
            When a name is unknown.

        Examples
        --------
        >>> from derive import load
        >>> print(Derivation(load("double_pendulum")).identifiable(outputs=["x1", "y1"]))
        l1, l2, g: determined
        m1, m2: only as m2/m1; give one of them a value
        """
        known = {part.symbol.name: part.symbol for part in self.system.parameters}
        for name in unknown or ():
            if name not in known:
                raise SystemDefinitionError(
                    f"system {self.system.name!r} has no parameter {name[:50]!r}"
                    f"{did_you_mean(name, known)}; known are {', '.join(known)}"
                )
        symbols = [known[name] for name in (known if unknown is None else unknown)]
        formulas = self.system.q if outputs is None else output_formulas(self, outputs)
        return identifiability(self.system, self.mass_matrix, self.forcing, formulas, symbols)

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
        point = Point.of(self.system, at or {})
        moving = {*self.system.qdot}
        values = {s: x for s, x in point.values.items() if s in moving or s.name in (at or {})}
        return equilibria(Point(self.system, values), self.forcing)

    @cached_property
    def _default_linearisation(self) -> Linearisation:
        return self._energies.linearised(self._default_equilibrium)

    @cached_property
    def is_linearisable(self) -> bool:
        """Whether masses and springs alone describe small motions."""
        try:
            self.linearisation()
        except SystemDefinitionError:
            return False
        return True

    @cached_property
    def equilibrium(self) -> tuple[sp.Expr, ...] | None:
        """The system's equilibrium, or zeros if they are one; None if none is known."""
        try:
            self._energies.check_equilibrium(self._default_equilibrium)
        except SystemDefinitionError:
            if self.system.equilibrium is not None:
                raise
            return None
        return self._default_equilibrium

    @property
    def _energies(self) -> Energies:
        return Energies(self.system, self.mass_matrix, self.effective_potential, self.drift)

    @property
    def _default_equilibrium(self) -> tuple[sp.Expr, ...]:
        given = self.system.equilibrium
        return (sp.S.Zero,) * len(self.system.q) if given is None else tuple(given)


def _product(matrix: Matrix, column: Sequence[sp.Expr]) -> Matrix:
    """The product of both; SymPy's own examines at length whether all entries are finite."""
    rows = (zip(matrix.row(i), column, strict=True) for i in range(matrix.rows))
    return Matrix([sp.Add(*(a * x for a, x in row)) for row in rows])


def _derivative(expression: sp.Expr, symbol: sp.Symbol) -> sp.Expr:
    """∂expression/∂symbol, at once where the symbol is not in it."""
    return expression.diff(symbol) if symbol in expression.free_symbols else sp.S.Zero
