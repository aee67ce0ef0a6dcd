"""Normal modes about an equilibrium, and eigenvalues of the equations along a motion."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from solvers.equations.module import GeneratedModule, function, has_function

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Modes:
    """Small oscillations about a stable equilibrium: M₀ ẍ + K x = 0."""

    mass_matrix: Array  # M₀
    stiffness_matrix: Array  # K
    frequencies: Array  # ω in rad/s, ascending; the eigenvalues of the equations are ±iω
    shapes: Array  # a column for each mode, with unit mass: shapesᵀ M₀ shapes = 1

    @classmethod
    def at_rest(cls, module: GeneratedModule, params: Sequence[float]) -> "Modes":
        """The modes about the equilibrium of the module's function ``linear``.

        `ValueError` if the system has no known equilibrium, or it is not stable.
        """
        name = module.SYSTEM
        if not has_function(module, "linear"):
            raise ValueError(f"{name} has no equilibrium: small motions have no modes")
        mass_matrix, stiffness_matrix = np.array(function(module, "linear")(params))
        try:
            squares, shapes = _generalized_eigh(stiffness_matrix, mass_matrix)
        except np.linalg.LinAlgError as error:
            text = "the mass matrix is not positive definite at the equilibrium"
            raise ValueError(
                f"{name} has no modes with {_values(module, params)}: {text}"
            ) from error
        except ValueError as error:
            text = "its matrices are not finite at the equilibrium"
            raise ValueError(
                f"{name} has no modes with {_values(module, params)}: {text}"
            ) from error
        if squares[0] <= 0:
            reason = f"squared frequencies are {', '.join(f'{x:.6g}' for x in squares)} rad^2/s^2"
            at = f"about rest with {_values(module, params)}"
            raise ValueError(f"{name} does not oscillate {at}: {reason}")
        return cls(mass_matrix, stiffness_matrix, np.sqrt(squares), shapes)

    @property
    def matrix(self) -> Array:
        """A of y' = A y for y = (x, ẋ)."""
        n = len(self.frequencies)
        acceleration = -np.linalg.solve(self.mass_matrix, self.stiffness_matrix)
        return np.block([[np.zeros((n, n)), np.eye(n)], [acceleration, np.zeros((n, n))]])

    def size(self, y: Array) -> float:
        """√(2 energy) of a small motion y = (x, ẋ)."""
        x, velocity = np.split(y, 2)
        twice = velocity @ self.mass_matrix @ velocity + x @ self.stiffness_matrix @ x
        return float(np.sqrt(twice))


def _generalized_eigh(stiffness_matrix: Array, mass_matrix: Array) -> tuple[Array, Array]:
    """Squares ω², ascending, and shapes s of K s = ω² M s, with sᵀ M s = 1.

    By the eigenvalues of L⁻¹ K L⁻ᵀ with M = L Lᵀ. SciPy's function would load a part of SciPy that
    takes longer than a run. `ValueError` if a matrix is not finite, `LinAlgError` if the mass
    matrix is not positive definite.
    """
    if not (np.isfinite(stiffness_matrix).all() and np.isfinite(mass_matrix).all()):
        raise ValueError("matrices are not finite")
    root = np.linalg.cholesky(mass_matrix)
    reduced = np.linalg.solve(root, np.linalg.solve(root, stiffness_matrix).T)
    squares, vectors = np.linalg.eigh((reduced + reduced.T) / 2)
    return squares, np.linalg.solve(root.T, vectors)


def _values(module: GeneratedModule, params: Sequence[float]) -> str:
    """Parameters with their values, for messages."""
    return ", ".join(f"{n} = {x:.6g}" for n, x in zip(module.PARAMETERS, params, strict=True))


def local_eigenvalues(
    module: GeneratedModule, params: Sequence[float], states: Array
) -> NDArray[np.complex128]:
    """Eigenvalues of the Lagrangian form linearised at each of `states`, shape (n, state)."""
    return np.array([np.linalg.eigvals(np.array(module.jacobian(0.0, y, params))) for y in states])


def mode_spread(module: GeneratedModule, params: Sequence[float]) -> float:
    """Ratio of the largest to the smallest frequency about rest; 1 if no modes are known."""
    try:
        frequencies = Modes.at_rest(module, params).frequencies
    except ValueError:
        return 1.0
    return float(frequencies[-1] / frequencies[0])
