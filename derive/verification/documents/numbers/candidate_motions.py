"""The motion of a system in numbers, for many meanings of a document's letters at once.

Arrays have the shape (candidates, states), or (candidates, states, coordinates) in the document's
coordinates q' of q = A q' + c: M' = Aᵀ M A and f' = Aᵀ f.
"""

from collections.abc import Mapping, Sequence
from functools import cache, cached_property
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from derive.verification.documents.jets import Array, Jet, Value, evaluated
from derive.verification.documents.letters.candidates import Damped, SystemCandidate
from derive.verification.documents.letters.document_system import (
    derivation,
    drag,
    energies_of,
    mass_matrix,
    multiplier,
)
from derive.verification.documents.letters.letters import Letters
from derive.verification.documents.letters.stated_equations import is_reaction
from derive.verification.documents.numbers.conditions import Conditions, conditions

#: Number of states.
STATES = 3
#: Steps of Newton's method onto constraints, and residuals of order 1 that count as none.
NEWTON_STEPS, TINY = 20, 1e-14


class ArbitraryMotion:
    """Random values in place of those of a motion: formulas that hold with them say nothing."""

    are_of_positions = False

    def __init__(self, letters: Letters) -> None:
        self._random = np.random.default_rng(1)
        self.shape = (1, STATES)
        size = self.shape
        self.coordinates = letters.coordinates
        self.places = {q: self._random.uniform(0.3, 1.3, size) for q in letters.coordinates}
        self.speeds = {q: self._random.uniform(-1, 1, size) for q in letters.coordinates}
        self.parameters = {p: float(self._random.uniform(0.5, 1.5)) for p in letters.parameters}
        self.free_reactions = frozenset(filter(is_reaction, letters.parameters))
        self.accelerations = {q: self._array() for q in letters.coordinates}
        self._gradients: dict[tuple[str, str, int], Array] = {}
        energies = ("kinetic_energy", "potential_energy", "lagrangian", "energy", "hamiltonian")
        self.energies = {kind: self._array() for kind in energies}
        self.positions: Sequence[Array] = ()
        self.multipliers: Mapping[str, Array] = {}
        self.reactions: Mapping[str, Array] = {}
        self.time = Jet.of(self._array(), 1.0)

    def momentum(self, coordinate: str) -> Jet:
        """A random momentum, whose rate is ∂L/∂q: that is true of every system."""
        momentum, rate = (self.gradient("lagrangian", coordinate, order) for order in (1, 0))
        return Jet.of(momentum, rate, np.nan)

    def gradient(self, kind: str, coordinate: str, order: int) -> Array:
        """A random derivative."""
        return self._gradients.setdefault((kind, coordinate, order), self._array())

    def mass_matrix(self, order: Sequence[str]) -> Value:
        """A random matrix."""
        matrix = np.empty((len(order), len(order)), dtype=object)
        for index in np.ndindex(matrix.shape):
            matrix[index] = Jet.of(self._array(), np.nan, np.nan)
        return matrix

    def _array(self) -> Array:
        return self._random.uniform(0.5, 1.5, self.shape)


class CandidateMotions:
    """Motions of candidates of one system at random states of the document's coordinates."""

    def __init__(self, tried: Sequence[SystemCandidate], letters: Letters) -> None:
        self._system, self._tried = tried[0].system, tried
        self._derivation = derivation(self._system)
        self.shape = (len(tried), STATES)
        self.coordinates = tuple({q for one in tried for q in one.coordinates})
        random = np.random.default_rng(0)
        names = sorted({*letters.coordinates} | {q for one in tried for q in one.coordinates})
        #: Places and speeds of the document's coordinates, and values of its parameters. Those
        #: of candidates differ if these have constraints.
        self.places = {q: random.uniform(0.3, 1.3, (1, STATES)) for q in names}
        self.speeds = {q: random.uniform(-1, 1, (1, STATES)) for q in names}
        self.parameters = {p: float(random.uniform(0.5, 1.5)) for p in letters.parameters}
        own = {p.name: float(random.uniform(0.5, 1.5)) for p in self._system.params}
        #: Letters of reactions that stated energies leave to definitions.
        self.free_reactions = frozenset(filter(is_reaction, letters.parameters))
        if tried[0].basis in ("positions", "energies") and not tried[0].is_of_equations:
            self.free_reactions -= frozenset[str]().union(*(one.letters for one in tried))
        else:
            self.free_reactions = frozenset()
        self._signs = _table([one.signs for one in tried])
        #: Gradients of energies by coordinates (order 0) or velocities (1), as far as needed.
        self._gradients: dict[tuple[str, int], Mapping[str, Array]] = {}
        self._names = self._system_names(own)
        #: Whether the document states the positions.
        self.are_of_positions = tried[0].basis == "positions"
        if tried[0].condition_count:
            self._move(own)

    @property
    def time(self) -> Jet:
        """Time at all states."""
        jet: Jet = self._names["t"]
        return jet

    @cached_property
    def accelerations(self) -> Mapping[str, Array]:
        """The accelerations of each coordinate of the document; NaN where it is none."""
        return self._by_coordinate(self._solution[..., : len(self._system.q)])

    @cached_property
    def multipliers(self) -> Mapping[str, Array]:
        """The values of letters of multipliers."""
        reactions = self._solution[..., len(self._system.q) :]
        values: dict[str, Array] = {}
        number = cache(float)  # of the few factors, which many candidates share
        for b, one in enumerate(self._tried):
            for name, index, factor in one.multipliers:
                if name not in values:
                    values[name] = np.full(self.shape, np.nan)
                values[name][b] = number(factor) * reactions[b, :, index]
            for name, value in one.reactions.items():
                values.setdefault(name, np.full(self.shape, np.nan))[b] = self._numbers(value)[b]
        return values

    @cached_property
    def reactions(self) -> Mapping[str, Array]:
        """The multipliers of all constraints by their names."""
        names = [one.name for one in self._system.conditions]
        names += [multiplier(self._tried[0], k) for k in range(len(self._tried[0].constraints))]
        return dict(
            zip(names, np.moveaxis(self._solution, -1, 0)[len(self._system.q) :], strict=True)
        )

    @cached_property
    def _solution(self) -> Array:
        """Accelerations and multipliers of M q̈ - Gᵀ λ = f and G q̈ = γ."""
        M, f = self._mass_matrix, np.array([*map(self._numbers, self._derivation.forcing)])
        f = np.einsum("bji,jbk->bki", self._signs, f) + self._loads
        if self._tried[0].condition_count:
            now = self._conditions
            G = now.gradients
            zero = np.zeros((*self.shape, G.shape[2], G.shape[2]))
            M = np.block([[M, -G.transpose(0, 1, 3, 2)], [G, zero]])
            f = np.concatenate([f, now.forcing], axis=-1)
        with np.errstate(all="ignore"):
            try:
                return np.asarray(np.linalg.solve(M, f[..., None])[..., 0])
            except np.linalg.LinAlgError:
                return np.full_like(f, np.nan)

    @property
    def _conditions(self) -> Conditions:
        """The constraints at the states."""
        return conditions(self._tried, self._names, self._letters, self.shape)

    @property
    def _letters(self) -> dict[str, Value]:
        """Letters of the document at the states, without accelerations."""
        letters: dict[str, Value] = {name: self._names[name] for name in ("t", "pi")}
        letters |= {p: Jet.of(np.array([[value]])) for p, value in self.parameters.items()}
        for q, place in self.places.items():
            speed = self.speeds[q]
            letters |= {q: Jet.of(place, speed), f"{q}_dot": Jet.of(speed)}
        return letters

    def _move(self, own: Mapping[str, float]) -> None:
        """Move the states onto the constraints: coordinates by Newton's method, then velocities."""
        # constraints in letters are the same for all candidates
        tried = self._tried if self._system.conditions else self._tried[:1]
        shape = (len(tried), STATES)
        for _ in range(NEWTON_STEPS):
            now = conditions(tried, self._names, self._letters, shape)
            if not np.any(np.abs(now.residuals) > TINY):
                break
            self._shift(self.places, tried, _shortest(now.gradients, now.residuals))
            if self._system.conditions:
                self._names = self._system_names(own)
        now = conditions(tried, self._names, self._letters, shape)
        self._shift(self.speeds, tried, _shortest(now.gradients, now.rates))
        self._names = self._system_names(own)

    def _shift(
        self, table: dict[str, Array], tried: Sequence[SystemCandidate], change: Array
    ) -> None:
        """Subtract a change of the coordinates of candidates, or of velocities."""
        for q, values in table.items():
            table[q] = np.broadcast_to(values, change.shape[:2]).copy()
            for order, rows in self._orders.items():
                if q in order:
                    own = rows[rows < len(tried)]
                    table[q][own] -= change[own, :, order.index(q)]

    @cached_property
    def _orders(self) -> Mapping[tuple[str, ...], NDArray[np.intp]]:
        """The numbers of the candidates with each order of coordinates."""
        result: dict[tuple[str, ...], list[int]] = {}
        for b, one in enumerate(self._tried):
            result.setdefault(one.coordinates, []).append(b)
        return {order: np.array(rows) for order, rows in result.items()}

    @cached_property
    def _mass_matrix(self) -> Array:
        """M' of all candidates: candidates, states, rows, columns."""
        return self._transformed(mass_matrix(self._system))

    @cached_property
    def _drag(self) -> Array:
        return self._transformed(drag(self._system))

    def _transformed(self, matrix: sp.Matrix) -> Array:
        """Aᵀ M A of all candidates."""
        n = range(len(self._system.q))
        M = np.array([[self._numbers(matrix[i, j]) for j in n] for i in n])
        return np.asarray(np.einsum("bji,jlbk,blm->bkim", self._signs, M, self._signs))

    def mass_matrix(self, order: Sequence[str]) -> Value:
        """The mass matrix with rows and columns in an order of the document's coordinates."""
        names = [q for q in order if q in self._tried[0].coordinates]
        matrix = np.empty((len(names), len(names)), dtype=object)
        for i, j in np.ndindex(matrix.shape):
            entry = np.full(self.shape, np.nan)
            for b, one in enumerate(self._tried):
                if names[i] in one.coordinates and names[j] in one.coordinates:
                    row, column = (one.coordinates.index(names[k]) for k in (i, j))
                    entry[b] = self._mass_matrix[b, :, row, column]
            matrix[i, j] = Jet.of(entry, np.nan, np.nan)
        return matrix

    @cached_property
    def energies(self) -> Mapping[str, Array]:
        """Kinetic and potential energy, Lagrangian and energy."""
        T, V, E = map(self._numbers, (*energies_of(self._derivation), self._derivation.energy))
        return {
            "kinetic_energy": T,
            "potential_energy": V,
            "lagrangian": T - V,
            "energy": E,
            "hamiltonian": E,
        }

    @cached_property
    def positions(self) -> Sequence[Array]:
        """The components of the positions of all masses."""
        return [self._numbers(r) for mass in self._system.masses for r in mass.position]

    def momentum(self, coordinate: str) -> Jet:
        """∂L/∂q̇ and its rate ∂L/∂q + Q."""
        rate = self.gradient("lagrangian", coordinate, 0) + self._forces[coordinate]
        return Jet.of(self.gradient("lagrangian", coordinate, 1), rate, np.nan)

    def gradient(self, kind: str, coordinate: str, order: int) -> Array:
        """The derivative of an energy by a coordinate (order 0) or its velocity (1)."""
        known = self._gradients.get((kind, order))
        if known is None:
            symbols = self._system.qdot if order else self._system.q
            known = self._gradient(getattr(self._derivation, kind), symbols)
            self._gradients[kind, order] = known
        return known[coordinate]

    def _gradient(self, value: sp.Expr, symbols: Sequence[sp.Symbol]) -> Mapping[str, Array]:
        own = np.array([self._numbers(value.diff(symbol)) for symbol in symbols])
        return self._by_coordinate(np.einsum("bji,jbk->bki", self._signs, own))

    @cached_property
    def _forces(self) -> Mapping[str, Array]:
        """Forces of the document on its coordinates."""
        return self._by_coordinate(self._loads)

    @cached_property
    def _loads(self) -> Array:
        """Forces and friction that candidates add to their system."""
        loads = np.zeros((*self.shape, len(self._system.q)))
        alike: dict[tuple[object, ...], list[int]] = {}
        for b, one in enumerate(self._tried):
            if one.forces or one.friction:
                alike.setdefault((one.forces, one.friction), []).append(b)
        speeds = self._by_order(self.speeds).transpose(0, 2, 1)
        for rows in alike.values():
            one = self._tried[rows[0]]
            for name, i in one.forces:
                loads[rows, :, i] += self.parameters[name]
            for name, damped in one.friction:
                loads[rows] -= self.parameters[name] * self._damped(damped, rows, speeds[rows])
        return loads

    def _damped(self, damped: Damped, rows: Sequence[int], speeds: Array) -> Array:
        """What friction is in proportion to, for some of the candidates."""
        if isinstance(damped, int):
            return np.asarray(speeds * (np.arange(speeds.shape[-1]) == damped))
        if damped == "coordinates":
            return speeds
        matrix = self._mass_matrix if damped == "motion" else self._drag
        return np.einsum("bkij,bkj->bki", matrix[rows], speeds)

    def _by_order(self, table: Mapping[str, Array]) -> Array:
        """The values of the coordinates of each candidate in its order."""
        result = np.empty((len(self._tried), len(self._system.q), STATES))
        for order, rows in self._orders.items():
            for i, q in enumerate(order):
                result[rows, i] = np.broadcast_to(table[q], self.shape)[rows]
        return result

    def _by_coordinate(self, table: Array) -> Mapping[str, Array]:
        result = {q: np.full(self.shape, np.nan) for q in self.places}
        for order, rows in self._orders.items():
            for i, q in enumerate(order):
                result[q][rows] = table[rows, :, i]
        return result

    def _numbers(self, expression: sp.Expr) -> Array:
        names = {name: one.constant for name, one in self._names.items()}
        value = evaluated(_text(expression), names).value
        return np.asarray(np.broadcast_to(value, self.shape))

    def _parameter(self, candidate: SystemCandidate, name: str, default: float) -> float:
        """The value of a parameter of the system."""
        if name in candidate.numbers:
            return float(candidate.numbers[name])
        return self.parameters.get(candidate.parameters.get(name, ""), default)

    def _system_names(self, own: Mapping[str, float]) -> dict[str, Value]:
        """Coordinates, velocities and parameters of the system."""
        place, speed = (self._by_order(table) for table in (self.places, self.speeds))
        known = {
            own: [self.parameters[x] if isinstance(x, str) else x * np.pi / 2 for x in own]
            for own in {one.offsets for one in self._tried}
        }
        offsets = _table([one.offsets for one in self._tried], known)
        q = np.einsum("bij,bjk->bik", self._signs, place) + offsets[:, :, None]
        qdot = np.einsum("bij,bjk->bik", self._signs, speed)
        time = np.linspace(0.4, 0.9, STATES)[np.newaxis]  # the same for all candidates
        names: dict[str, Value] = {"t": Jet.of(time, 1.0), "pi": Jet.of(np.array([[np.pi]]))}
        for i, (symbol, rate) in enumerate(zip(self._system.q, self._system.qdot, strict=True)):
            names[symbol.name], names[rate.name] = Jet.of(q[:, i]), Jet.of(qdot[:, i])
        # many candidates share their parameters
        shared = {(id(one.parameters), id(one.numbers)): one for one in self._tried}
        numbers = {key: k for k, key in enumerate(shared)}
        rows = [numbers[id(one.parameters), id(one.numbers)] for one in self._tried]
        for p in own:
            values = np.array([self._parameter(one, p, own[p]) for one in shared.values()])
            names[p] = Jet.of(np.broadcast_to(values[rows, np.newaxis], self.shape))
        return names


@cache
def _text(expression: sp.Expr) -> str:
    """The text of an expression; those of known systems are the same for all documents."""
    return str(sp.sstr(expression))


def _table(
    rows: Sequence[tuple[Any, ...]], values: Mapping[tuple[Any, ...], Any] | None = None
) -> Array:
    """An array of rows, or of their values; many candidates share them."""
    numbers = {row: k for k, row in enumerate(dict.fromkeys(rows))}
    table = np.array([values[row] if values else row for row in numbers], float)
    return np.asarray(table[[numbers[row] for row in rows]])


def _shortest(gradients: Array, residuals: Array) -> Array:
    """The shortest solutions x of G x = r; zeros where constraints depend on each other."""
    rows = np.einsum("bkci,bkdi->bkcd", gradients, gradients)
    try:
        factors = np.linalg.solve(rows, residuals[..., None])[..., 0]
    except np.linalg.LinAlgError:
        return np.zeros((*gradients.shape[:2], gradients.shape[3]))
    return np.nan_to_num(np.einsum("bkci,bkc->bki", gradients, factors))
