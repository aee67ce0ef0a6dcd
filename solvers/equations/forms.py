"""Forms of the equations of motion, and conversion of their states.

An ordinary state is (q, q̇); the state of a form may differ. In the variational and the sensitivity
form, both also contain a linear perturbation of the state. In the sensitivity form parameters are
preceded by their perturbations.
"""

from collections.abc import Callable, Sequence
from copy import copy
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from solvers.equations.module import (
    GeneratedModule,
    function,
    has_constraints,
    has_function,
    has_perturbation,
    integrals,
    named,
    parameter_names,
    state_names,
    switching_functions,
)
from solvers.equations.sliding import Evaluate, Sliding, slide

Array = NDArray[np.float64]

#: Relative step of differences, near the cube root of the rounding error.
STEP = 1e-5


class Form:
    """One form of a generated module's equations, with fixed parameters.

    `params` may be arrays that differ between motions. `state` and `ordinary` are names of
    components, of the form's state and of an ordinary state. `angle_columns` and `shared_columns`
    are pairs of indices, in an ordinary state and the form's: of each angle and its sine, which its
    cosine follows; and of each component that both share. In Lagrange's form `feedback` may be a
    function of time and state that returns the inputs, the last parameters.
    """

    def __init__(
        self,
        module: GeneratedModule,
        name: str,
        params: Sequence[Any],
        feedback: Callable[[float, Array], Array] | None = None,
        signs: Sequence[float] = (),
    ) -> None:
        if name not in module.FORMS:
            reason = ""
            if name == "hamiltonian" and has_function(module, "multipliers"):
                reason = "; constraints leave its coordinates and momenta not independent"
            raise ValueError(
                f"form {name!r}: {module.SYSTEM} has {', '.join(module.FORMS)}{reason}"
            )
        self.name, self.module, self.params = name, module, tuple(params)
        self.feedback, self.signs = feedback, tuple(signs)
        self.integrals: tuple[Any, ...] = ()  # their values, which are kept
        self.state: tuple[str, ...] = module.STATES[name]
        self.ordinary = state_names(module, name)
        index = {part: i for i, part in enumerate(self.state)}
        sines = [(k, f"sin_{q}") for k, q in enumerate(module.COORDINATES)]
        self.angle_columns = [(k, index[sine]) for k, sine in sines if sine in index]
        parts = enumerate(self.ordinary)
        self.shared_columns = [(k, index[part]) for k, part in parts if part in index]

    def with_params(self, params: Sequence[Any]) -> "Form":
        """The same form with other parameters."""
        form = copy(self)
        form.params = tuple(params)
        return form

    def in_form(self, name: str) -> "Form":
        """The same equations in another form; parameters are not perturbed there."""
        n = len(parameter_names(self.module, name)) - len(self.constants)
        form = Form(self.module, name, (*[0.0] * n, *self.constants), self.feedback, self.signs)
        form.integrals = self.integrals
        return form

    def starting(self, t: float, y: Array) -> "Form":
        """The form that keeps integrals at their values at an ordinary state."""
        if not integrals(self.module):
            return self
        form, state = copy(self), y[: len(self.module.STATE)]
        values = self.value(function(self.module, "integrals"), t, state, self.constants)
        form.integrals = tuple(values.tolist())
        return form

    @property
    def constants(self) -> tuple[Any, ...]:
        """The parameters without their perturbations."""
        return self.params[len(self.params) - len(self.module.PARAMETERS) :]

    @property
    def angles(self) -> list[tuple[int, int]]:
        """Index of the sine and of the velocity of each angle known by sine and cosine."""
        n, columns = len(self.module.COORDINATES), dict(self.shared_columns)
        return [(i, columns[n + k]) for k, i in self.angle_columns]

    def locate(self, component: str) -> tuple[bool, int] | None:
        """Whether an ordinary component is an angle known by its sine, and its index."""
        k, columns = self.ordinary.index(component), dict(self.shared_columns)
        angles = [angle for angle, _ in self.angle_columns]
        if k in angles:
            return True, angles.index(k)
        return (False, columns[k]) if k in columns else None

    @cached_property
    def function(self) -> Callable[..., Any]:
        """The generated right-hand side."""
        return function(self.module, named("rhs", self.name))

    @property
    def has_jacobian(self) -> bool:
        """Whether implicit methods can integrate this form."""
        return has_function(self.module, named("jacobian", self.name))

    @cached_property
    def _jacobian(self) -> Callable[..., Any]:
        return function(self.module, named("jacobian", self.name))

    def rhs(self, t: float, z: Array) -> Array:
        """The right-hand side; `ArithmeticError` where it has no finite value."""
        if 0.0 in self.signs:
            return self.switching(t, z).derivative
        return self.value(self.function, t, z, self._params_at(t, z))

    def jacobian(self, t: float, z: Array) -> Array:
        """Its Jacobian; `ArithmeticError` where it has no finite value."""
        if 0.0 in self.signs:
            return _differences(lambda y: self.rhs(t, y), z)
        params = self._params_at(t, z)
        matrix = self.value(self._jacobian, t, z, params)
        if self.feedback is None:
            return matrix
        by_inputs = self.value(function(self.module, "input_jacobian"), t, z, params)
        return np.asarray(matrix + by_inputs @ self._feedback_jacobian(t, z))

    @staticmethod
    def value(function: Callable[..., Any], t: float, z: Array, params: Sequence[Any]) -> Array:
        """The value of a generated function; `ArithmeticError` where it has none."""
        try:
            return np.array(function(t, z, params))
        except ValueError as error:  # of a function of `math`, such as a root of a negative number
            raise FloatingPointError(f"{error} in {function.__name__}") from error

    def _params_at(self, t: float, z: Array) -> Sequence[Any]:
        """The parameters, the last of which may be inputs that depend on time and state."""
        if self.feedback is None:
            return (*self.params, *self.signs)
        values = self.feedback(t, z)
        return (*self.params[: -len(values)], *values, *self.signs)

    @property
    def switching_count(self) -> int:
        """Number of functions at whose zeros forces have kinks or jumps."""
        return len(switching_functions(self.module))

    def with_signs(self, signs: Sequence[float] | Array) -> "Form":
        """The form with the signs of switching functions held; their values decide if empty.

        A sign of 0 keeps its function at 0.
        """
        form = copy(self)
        form.signs = tuple(map(float, signs))
        return form

    def values(self, t: float, y: Array) -> Array:
        """Switching functions at a state of Lagrange's form."""
        switches = function(self.module, "switches")
        return np.asarray(self.value(switches, t, y, self._params_at(t, y))[0])

    def switching(self, t: float, z: Array) -> Sliding:
        """The motion with the held signs, and its switching functions.

        A sign of 0 keeps its function at 0.
        """
        return slide(self.by_signs(t, z), self.signs, self.perturbed)

    def by_signs(self, t: float, z: Array) -> Evaluate:
        """The right-hand side and the switching functions at a state, by their signs."""
        form = self.name if self.name != "hamiltonian" else "lagrangian"
        params, signs = self._params_at(t, z), len(self.signs)
        plain = params[: len(params) - signs]
        switches, y = function(self.module, named("switches", form)), z
        if form != self.name:
            y = self.value(function(self.module, "lagrangian_state"), t, z, params)

        def evaluate(signs: Sequence[float]) -> tuple[Array, Array]:
            held = (*plain, *signs)
            return self.value(self.function, t, z, held), self.value(switches, t, y, held)

        return evaluate

    @cached_property
    def perturbed(self) -> list[tuple[int, int]]:
        """Indices of each velocity and its perturbation in the variational form."""
        if f"delta_{self.module.STATE[-1]}" not in self.state:
            return []
        velocities = self.module.STATE[len(self.module.COORDINATES) :]
        return [(self.state.index(v), self.state.index(f"delta_{v}")) for v in velocities]

    def _feedback_jacobian(self, t: float, z: Array) -> Array:
        """∂u/∂z, shape (inputs, state), by differences."""
        feedback = self.feedback
        assert feedback is not None
        return _differences(lambda y: feedback(t, y), z)

    def from_ordinary(self, t: float, y: Array) -> Array:
        """The state of this form for the ordinary state `y` at time `t`."""
        if self.name == "hamiltonian":
            return np.array(self.module.hamiltonian_state(t, y, self.params))
        return self.rearranged(y[np.newaxis])[0]

    def rearranged(self, y: Array) -> Array:
        """States of this form for ordinary states, in rows; not in Hamilton's form."""
        z = np.empty((len(y), len(self.state)))
        for k, i in self.shared_columns:
            z[:, i] = y[:, k]
        for k, i in self.angle_columns:
            z[:, i], z[:, i + 1] = np.sin(y[:, k]), np.cos(y[:, k])
        return z

    @property
    def has_constraints(self) -> bool:
        """Whether motions have constraints."""
        return has_constraints(self.module)

    @property
    def correction(self) -> str:
        """Name of the function that removes residuals of constraints."""
        if has_perturbation(self.name):
            return named("correction", self.name)
        return named("correction", "rational" if self.angle_columns else "lagrangian")

    def to_ordinary(
        self, t: float | Array, z: Array, before: Array, elapsed: float | Array
    ) -> Array:
        """The ordinary state of `z` at time `t`, or states in columns at several times.

        Whole turns of angles known by sine and cosine are counted from the ordinary state
        `before`, `elapsed` seconds ago (negative backwards), with the mean of both velocities.
        """
        if self.name == "hamiltonian":
            many = "lagrangian_state_many" if z.ndim > 1 else "lagrangian_state"
            return np.array(function(self.module, many)(t, z, self.params))
        y = np.empty((len(before), *z.shape[1:]))
        for k, i in self.shared_columns:
            y[k] = z[i]
        n = len(self.module.COORDINATES)
        for k, i in self.angle_columns:
            angle = np.arctan2(z[i], z[i + 1])
            expected = before[k] + elapsed * (before[n + k] + y[n + k]) / 2
            y[k] = angle + 2 * np.pi * np.round((expected - angle) / (2 * np.pi))
        return y

    def from_ordinary_many(self, t: ArrayLike, y: Array) -> tuple[Array, Array]:
        """As `from_ordinary`, for states (n, state); and whole turns, shape (n, angles)."""
        if self.name == "hamiltonian":
            return self.many("hamiltonian_state_many", t, y, self.params), np.empty((len(y), 0))
        z = self.rearranged(y)
        wrapped = [y[:, k] - np.arctan2(z[:, i], z[:, i + 1]) for k, i in self.angle_columns]
        turns = np.reshape(wrapped, (len(self.angle_columns), len(y))).T / (2 * np.pi)
        return z, np.round(turns)

    def to_ordinary_many(self, t: ArrayLike, z: Array, turns: Array) -> Array:
        """The ordinary states (n, state) from the results of `from_ordinary_many`."""
        if self.name == "hamiltonian":
            return self.many("lagrangian_state_many", t, z, self.params)
        y = np.empty((len(z), len(self.ordinary)))
        for k, i in self.shared_columns:
            y[:, k] = z[:, i]
        for (k, i), whole in zip(self.angle_columns, turns.T, strict=True):
            y[:, k] = np.arctan2(z[:, i], z[:, i + 1]) + 2 * np.pi * whole
        return y

    def many(self, name: str, t: ArrayLike, states: Array, params: Sequence[Any]) -> Array:
        """A vectorised function of the module at states in rows; NaN and infinity propagate."""
        numbers = [np.asarray(p, float) for p in params]
        with np.errstate(all="ignore"):
            return np.asarray(function(self.module, name)(t, states.T, numbers)).T


def _differences(values: Callable[[Array], Array], z: Array) -> Array:
    """The Jacobian of a function of the state, by differences."""
    steps = np.diag(STEP * np.maximum(np.abs(z), 1.0))
    columns = [(values(z + dz) - values(z - dz)) / (2 * dz.sum()) for dz in steps]
    return np.array(columns).T


def fastest_form(module: GeneratedModule) -> str:
    """The form that a compiled loop integrates fastest."""
    return "rational" if "rational" in module.FORMS else "lagrangian"
