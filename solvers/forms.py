"""Forms of the equations of motion: the state outside is always (q, q̇), inside it may differ."""

from __future__ import annotations

from collections.abc import Sequence
from types import ModuleType

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Form:
    """One form of a generated module's equations, with fixed parameters.

    Parameters
    ----------
    module : module
        A generated module.
    name : str
        ``lagrangian``, ``hamiltonian`` or ``rational``.
    params : sequence of float
        In the order of ``module.PARAMETERS``.

    Raises
    ------
    ValueError
        When the module has no such form.
    """

    def __init__(self, module: ModuleType, name: str, params: Sequence[float]) -> None:
        suffix = "" if name == "lagrangian" else f"_{name}"
        if not hasattr(module, f"rhs{suffix}"):
            known = [f for f in ("lagrangian", "hamiltonian", "rational") if _has(module, f)]
            raise ValueError(f"form {name!r}: {module.__name__} has {', '.join(known)}")
        self.name, self._module, self._params = name, module, tuple(params)
        self._rhs = getattr(module, f"rhs{suffix}")
        self._jacobian = getattr(module, f"jacobian{suffix}", None)
        if name == "rational":
            self._angles = [
                (k, module.STATE_RATIONAL.index(f"sin_{q}"))
                for k, q in enumerate(module.COORDINATES)
                if f"sin_{q}" in module.STATE_RATIONAL
            ]
            self._others = [
                (k, module.STATE_RATIONAL.index(name))
                for k, name in enumerate(module.STATE)
                if name in module.STATE_RATIONAL
            ]

    @property
    def has_jacobian(self) -> bool:
        """Whether implicit methods can solve their stages in this form."""
        return self._jacobian is not None

    def rhs(self, t: float, z: Array) -> Array:
        """The right-hand side."""
        return np.array(self._rhs(t, z, self._params))

    def jacobian(self, t: float, z: Array) -> Array:
        """Its Jacobian."""
        assert self._jacobian is not None
        return np.array(self._jacobian(t, z, self._params))

    def inside(self, y: Array) -> Array:
        """The state of this form that belongs to the ordinary state `y`."""
        if self.name == "lagrangian":
            return y.copy()
        return np.array(getattr(self._module, f"{self.name}_state")(y, self._params))

    def settled(self, z: Array) -> Array:
        """`z` with sin² + cos² = 1 restored to rounding."""
        if self.name != "rational":
            return z
        z = z.copy()
        for _, i in self._angles:
            z[i : i + 2] /= np.hypot(z[i], z[i + 1])
        return z

    def outside(self, z: Array, before: Array, elapsed: float) -> Array:
        """The ordinary state of `z`.

        Turns of angles that are known by sine and cosine only are counted from the
        state `before`, `elapsed` seconds ago, with the mean of both velocities.
        """
        if self.name == "lagrangian":
            return z.copy()
        if self.name == "hamiltonian":
            return np.array(self._module.lagrangian_state(z, self._params))
        y = np.empty_like(before)
        for k, i in self._others:
            y[k] = z[i]
        half = len(y) // 2
        for k, i in self._angles:
            angle = np.arctan2(z[i], z[i + 1])
            expected = before[k] + elapsed * (before[half + k] + y[half + k]) / 2
            y[k] = angle + 2 * np.pi * np.round((expected - angle) / (2 * np.pi))
        return y


def _has(module: ModuleType, form: str) -> bool:
    return hasattr(module, "rhs" if form == "lagrangian" else f"rhs_{form}")
