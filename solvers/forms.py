"""Forms of the equations of motion: the state outside is always (q, q̇), inside it may differ."""

from __future__ import annotations

from collections.abc import Sequence
from types import ModuleType
from typing import Any

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
    params : sequence of float or ndarray
        In the order of ``module.PARAMETERS``; arrays if motions differ in them.

    Raises
    ------
    ValueError
        When the module has no such form.
    """

    def __init__(self, module: ModuleType, name: str, params: Sequence[Any]) -> None:
        suffix = "" if name == "lagrangian" else f"_{name}"
        if not hasattr(module, f"rhs{suffix}"):
            known = [f for f in ("lagrangian", "hamiltonian", "rational") if _has(module, f)]
            raise ValueError(f"form {name!r}: {module.__name__} has {', '.join(known)}")
        self.name, self.module, self.params = name, module, tuple(params)
        self._rhs = getattr(module, f"rhs{suffix}")
        self._jacobian = getattr(module, f"jacobian{suffix}", None)
        self.state: tuple[str, ...] = getattr(module, f"STATE{suffix.upper()}")
        # where angles stand outside, and their sines inside; the same for all that stays as it is
        self.turning = [
            (k, self.state.index(f"sin_{q}"))
            for k, q in enumerate(module.COORDINATES)
            if f"sin_{q}" in self.state
        ]
        self.kept = [
            (k, self.state.index(part)) for k, part in enumerate(module.STATE) if part in self.state
        ]

    @property
    def angles(self) -> list[tuple[int, int]]:
        """For each angle known by sine and cosine: where in the state its sine and velocity are."""
        half = len(self.module.COORDINATES)
        rates = dict(self.kept)
        return [(i, rates[half + k]) for k, i in self.turning]

    def where(self, component: str) -> tuple[bool, int] | None:
        """Which angle a component of ``module.STATE`` is, or else which number of this state."""
        k = self.module.STATE.index(component)
        turning = [angle for angle, _ in self.turning]
        if k in turning:
            return True, turning.index(k)
        return (False, dict(self.kept)[k]) if k in dict(self.kept) else None

    @property
    def has_jacobian(self) -> bool:
        """Whether implicit methods can solve their stages in this form."""
        return self._jacobian is not None

    def rhs(self, t: float, z: Array) -> Array:
        """The right-hand side."""
        return np.array(self._rhs(t, z, self.params))

    def jacobian(self, t: float, z: Array) -> Array:
        """Its Jacobian."""
        assert self._jacobian is not None
        return np.array(self._jacobian(t, z, self.params))

    def inside(self, y: Array) -> Array:
        """The state of this form that belongs to the ordinary state `y`."""
        if self.name == "lagrangian":
            return y.copy()
        return np.array(getattr(self.module, f"{self.name}_state")(y, self.params))

    def settled(self, z: Array) -> Array:
        """`z` with sin² + cos² = 1 restored to rounding."""
        if self.name != "rational":
            return z
        z = z.copy()
        for _, i in self.turning:
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
            return np.array(self.module.lagrangian_state(z, self.params))
        y = np.empty_like(before)
        for k, i in self.kept:
            y[k] = z[i]
        half = len(y) // 2
        for k, i in self.turning:
            angle = np.arctan2(z[i], z[i + 1])
            expected = before[k] + elapsed * (before[half + k] + y[half + k]) / 2
            y[k] = angle + 2 * np.pi * np.round((expected - angle) / (2 * np.pi))
        return y

    def inside_many(self, y: Array) -> tuple[Array, Array]:
        """As `inside`, of states (n, state); and the turns of angles, shape (n, angles)."""
        if self.name == "lagrangian":
            return y, np.empty((len(y), 0))
        z = self._many(f"{self.name}_state_many", y)
        wrapped = [y[:, k] - np.arctan2(z[:, i], z[:, i + 1]) for k, i in self.turning]
        turns = np.reshape(wrapped, (len(self.turning), len(y))).T / (2 * np.pi)
        return z, np.round(turns)

    def _many(self, function: str, states: Array) -> Array:
        """A function of the module over states in rows; what is not a number stays so."""
        params = [np.asarray(p, float) for p in self.params]
        with np.errstate(all="ignore"):
            return np.asarray(getattr(self.module, function)(states.T, params)).T

    def outside_many(self, z: Array, turns: Array) -> Array:
        """The ordinary states, shape (n, state), of `z` and `turns` as `inside_many` gives them."""
        if self.name == "lagrangian":
            return z.copy()
        if self.name == "hamiltonian":
            return self._many("lagrangian_state_many", z)
        y = np.empty((len(z), len(self.module.STATE)))
        for k, i in self.kept:
            y[:, k] = z[:, i]
        for (k, i), whole in zip(self.turning, turns.T, strict=True):
            y[:, k] = np.arctan2(z[:, i], z[:, i + 1]) + 2 * np.pi * whole
        return y


def fastest_form(module: ModuleType) -> str:
    """The form that a compiled loop runs fastest."""
    return "rational" if hasattr(module, "rhs_rational") else "lagrangian"


def _has(module: ModuleType, form: str) -> bool:
    return hasattr(module, "rhs" if form == "lagrangian" else f"rhs_{form}")
