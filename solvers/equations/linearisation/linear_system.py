"""Equations of motion linearised about a state: matrices, stability, modes."""

from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from solvers.equations.assembly import Assembly
from solvers.equations.consistent_start import consistent
from solvers.equations.module import (
    GeneratedModule,
    function,
    has_constraints,
    position_constraints,
)
from solvers.equations.module import inputs as input_names
from solvers.equations.module import outputs as output_names
from solvers.equations.number_checks import Values, quantities, real_number
from solvers.equations.signature_checks import checked
from solvers.io.argument_types import check_type
from solvers.io.suggestion import did_you_mean

Array = NDArray[np.float64]

#: Real parts of eigenvalues, relative to the largest eigenvalue, that count as 0: a double
#: eigenvalue 0, as of a free coordinate, has errors of the square root of rounding errors.
NEUTRAL = 1e-7


@dataclass(frozen=True)
class Mode:
    """A solution exp(λ t) of the linear system, or a pair of complex ones.

    Attributes
    ----------
    eigenvalue : complex
        λ in 1/s, of a pair the one with positive imaginary part.
    frequency : float
        Frequency in Hz, imaginary part of λ over 2π; 0 where it does not oscillate.
    damping_ratio : float
        -Re λ/|λ|: 0 without damping, 1 without oscillation, negative where it grows.
    shape : ndarray of shape (coordinates,)
        Coordinates in proportion, the largest 1; complex where they are out of phase.
    """

    eigenvalue: complex
    frequency: float
    damping_ratio: float
    shape: NDArray[np.complex128]


@dataclass(frozen=True, repr=False)
class LinearSystem:
    """x' = A x + B w and z = C x + D w, for small changes x of a state and w of the inputs.

    Constraints determine some components of the state by the others, which are x.

    Attributes
    ----------
    t : float
        Time in s.
    y : ndarray of shape (state,)
        The state (q, q̇).
    params : tuple of float
        All parameters, with the inputs.
    rate : ndarray of shape (state,)
        Rate of the state at the point: 0 at an equilibrium.
    A, B, C, D : ndarray
        Matrices of shape (state, state), (state, inputs), (outputs, state), (outputs, inputs).
    states, inputs, outputs : tuple of str
        Names of the components of x, w and z.
    names : tuple of str
        Names of the components of `y`.
    tangent : ndarray of shape (len(y), len(x))
        Derivatives of `y` with respect to x: the unit matrix without constraints.

    Examples
    --------
    >>> import generated.single_pendulum as sp
    >>> from solvers import linearise
    >>> upright = linearise(sp, {"theta": 3.141592653589793}, {"l": 9.81})
    >>> upright.stability, upright.to_scipy().A.round(9).tolist()
    ('unstable', [[0.0, 1.0], [1.0, 0.0]])
    """

    t: float
    y: Array
    params: tuple[float, ...]
    rate: Array
    A: Array
    B: Array
    C: Array
    D: Array
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    names: tuple[str, ...]
    tangent: Array

    @property
    def eigenvalues(self) -> NDArray[np.complex128]:
        """Eigenvalues of A in 1/s."""
        return np.linalg.eigvals(self.A).astype(complex)

    @property
    def stability(self) -> str:
        """``asymptotically stable``, ``unstable``, or ``neutral``: linear terms do not decide.

        An equilibrium about which motions conserve their energy and oscillate is neutral.
        """
        values = self.eigenvalues
        limit = NEUTRAL * max(1.0, float(np.abs(values).max()))
        if values.real.max() > limit:
            return "unstable"
        return "asymptotically stable" if values.real.max() < -limit else "neutral"

    @property
    def modes(self) -> list[Mode]:
        """The modes, the fastest growing first, of equal growth the slowest first."""
        values, vectors = np.linalg.eig(self.A)
        scale = max(1.0, float(np.abs(values).max()))
        modes = []
        for value, vector in zip(values.astype(complex), vectors.T, strict=True):
            if value.imag < 0:
                continue
            shape = (self.tangent @ vector)[: len(self.y) // 2].astype(complex)
            # an eigenvector (q, λ q) has coordinates
            shape = shape / shape[np.argmax(np.abs(shape))]
            number, size = complex(value), float(abs(value))
            damping = -number.real / size if size > NEUTRAL * scale else 0.0
            modes.append(Mode(number, number.imag / (2 * np.pi), damping, shape))
        return sorted(modes, key=lambda m: (-round(m.eigenvalue.real / scale, 6), m.frequency))

    def to_scipy(self) -> Any:
        """A ``scipy.signal.StateSpace``."""
        return scipy.signal.StateSpace(self.A, self.B, self.C, self.D)

    def to_control(self) -> Any:
        """A ``control.ss`` with names, if python-control is installed."""
        try:
            control = import_module("control")
        except ImportError as error:
            raise ImportError("to_control needs python-control: pip install control") from error
        names = {"states": self.states, "inputs": self.inputs, "outputs": self.outputs}
        lists = {key: list(value) for key, value in names.items()}
        return control.ss(self.A, self.B, self.C, self.D, **lists)

    def __repr__(self) -> str:
        state = ", ".join(f"{n} = {x:.6g}" for n, x in zip(self.names, self.y, strict=True))
        values = ", ".join(f"{value:.4g}" for value in self.eigenvalues)
        return f"LinearSystem at {state}: {self.stability}, eigenvalues {values} 1/s"


@checked
def linearise(
    module: GeneratedModule,
    y: Values,
    params: Values,
    *,
    inputs: Values | None = None,
    t: float = 0.0,
    outputs: Sequence[str] | None = None,
) -> LinearSystem:
    """The equations of motion linearised about any state, exactly, by the generated Jacobians.

    Parameters
    ----------
    module : module
        A generated module.
    y : array_like of shape (state,), or mapping of str to float
        Coordinates and velocities (q, q̇); by name, those that are left out are 0.
    params : array_like of shape (parameters,), or mapping of str to float
        In the order of ``module.PARAMETERS``, or by name.
    inputs : array_like of shape (inputs,), or mapping of str to float, optional
        Inputs in place of those in `params`; by name, those that are left out are 0.
    t : float, optional
        Time in s.
    outputs : sequence of str, optional
        Names of the system's outputs, or of components of the state, that are measured; by default
        all outputs, or the state of a system without outputs. `derive.Derivation.state_space`
        takes formulas.

    Returns
    -------
    LinearSystem

    Raises
    ------
    ValueError
        When an argument is invalid, the state violates a constraint, or the Jacobian is not finite.

    Examples
    --------
    >>> import generated.single_pendulum as sp
    >>> from solvers import linearise
    >>> hanging = linearise(sp, {"theta": 0.0}, {"l": 2.0})
    >>> hanging
    LinearSystem at theta = 0, theta_dot = 0: neutral, eigenvalues 0+2.215j, 0-2.215j 1/s
    >>> round(hanging.modes[0].frequency, 6)  # in Hz
    0.352484
    """
    names, controls = module.STATE, input_names(module)
    state = _vector(module, "y", names, y, dict.fromkeys(names, 0.0))
    constants = with_inputs(module, params, inputs)
    time = real_number("t", t, "s")
    check_type("outputs", outputs, Sequence | None, "a list of names")
    declared = output_names(module)
    measured = tuple((declared or names) if outputs is None else outputs)
    known = (*names, *declared)
    for name in measured:
        if name not in known:
            raise ValueError(
                f"outputs has {name!r}{did_you_mean(str(name), known)}; known are "
                f"{', '.join(known)}"
            )
    if has_constraints(module):
        assembly = Assembly(module, np.array([constants]), time)
        state = consistent(assembly, state[np.newaxis], names)[0]
    point = (time, state.tolist(), constants)
    try:
        A = np.array(module.jacobian(*point))
        rate = np.array(module.rhs(*point))
        B = np.empty((len(names), 0))
        if controls:
            B = np.array(function(module, "input_jacobian")(*point))
    except ArithmeticError as error:
        raise ValueError(f"the equations have no derivative at y = {state}: {error}") from error
    if not all(np.isfinite(part).all() for part in (A, B, rate)):
        raise ValueError(f"the equations have no finite derivative at y = {state}")
    rows = [known.index(name) for name in measured]
    C, D = (matrix[rows] for matrix in _of_outputs(module, point))
    if not (np.isfinite(C).all() and np.isfinite(D).all()):
        raise ValueError(f"the outputs have no finite derivative at y = {state}")
    tangent, independent = _tangent(module, point)
    A, B, C = A[independent] @ tangent, B[independent], C @ tangent
    states = tuple(names[k] for k in independent)
    return LinearSystem(
        time, state, constants, rate, A, B, C, D, states, controls, measured, names, tangent
    )


def _tangent(
    module: GeneratedModule, point: tuple[float, list[float], tuple[float, ...]]
) -> tuple[Array, list[int]]:
    """All small changes of a state by those that constraints leave free, and their indices."""
    n = len(module.STATE)
    if not has_constraints(module):
        return np.eye(n), [*range(n)]
    G = np.array(function(module, "constraints_jacobian")(*point))
    # of coordinates and of velocities, those that determine the others best
    parts = [np.arange(n // 2), np.arange(n // 2, n)]
    holonomic = position_constraints(module)
    rows = [slice(0, holonomic), slice(holonomic, None)]
    chosen = [
        own[scipy.linalg.qr(G[row][:, own], pivoting=True, mode="r")[1][: len(G[row])]]
        for own, row in zip(parts, rows, strict=True)
    ]
    dependent = np.concatenate(chosen)
    others = np.setdiff1d(np.arange(n), dependent)
    tangent = np.zeros((n, len(others)))
    tangent[others] = np.eye(len(others))
    tangent[dependent] = -np.linalg.solve(G[:, dependent], G[:, others])
    return tangent, others.tolist()


def _of_outputs(
    module: GeneratedModule, point: tuple[float, list[float], tuple[float, ...]]
) -> tuple[Array, Array]:
    """Derivatives of the state, then of the outputs, by the state and by the inputs."""
    count = len(input_names(module))
    C, D = np.eye(len(module.STATE)), np.zeros((len(module.STATE), count))
    if not output_names(module):
        return C, D
    C = np.vstack([C, function(module, "outputs_jacobian")(*point)])
    by_inputs = np.zeros((len(module.OUTPUTS), 0))
    if count:
        by_params = np.array(function(module, "outputs_parameter_jacobian")(*point))
        by_inputs = by_params[:, -count:]
    return C, np.vstack([D, by_inputs])


def with_inputs(
    module: GeneratedModule, params: Values, inputs: Values | None
) -> tuple[float, ...]:
    """All parameters in order, the last of which are `inputs` where these are given."""
    defaults = dict(zip(module.PARAMETERS, module.DEFAULTS, strict=True))
    constants = _vector(module, "params", module.PARAMETERS, params, defaults).tolist()
    if inputs is not None:
        names = input_names(module)
        values = _vector(module, "inputs", names, inputs, dict.fromkeys(names, 0.0))
        constants[len(constants) - len(names) :] = values.tolist()
    return tuple(constants)


def _vector(
    module: GeneratedModule,
    what: str,
    names: Sequence[str],
    values: Values,
    defaults: dict[str, float],
) -> Array:
    array = quantities(module, what, names, values, defaults)
    if array.shape != (len(names),):
        raise ValueError(
            f"{what} has shape {array.shape}: give {len(names)} numbers, "
            f"{', '.join(names) or 'none'}"
        )
    return array
