"""Runs of the report's scenes that several verdicts rest on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from solvers.equations.energy import energy_error
from solvers.equations.module import GeneratedModule
from solvers.integration.integrate import integrate
from solvers.integration.predictability import ignore_predictability
from solvers.references.extrapolation import extrapolated
from solvers.references.taylor import taylor
from solvers.runge_kutta.catalogue import load
from solvers.studies.failure_modes.lyapunov import Mean, lyapunov
from solvers.studies.work_precision.measurement import REPORT_METHODS

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Setting:
    """Parameters, initial state (q, q̇) and duration, as numbers."""

    params: tuple[float, ...]
    y0: tuple[float, ...]
    duration: float


#: So often a tolerance is divided by ten, or a step by two, to reach an error.
MOST_TRIES = 15


class Evidence:
    """Runs of the report's scene that several claims rest on.

    Parameters
    ----------
    module : module
        The generated double pendulum.
    prose, first, second, third : Setting
        What the prose describes, and what the three programs are set to.
    """

    def __init__(
        self,
        module: GeneratedModule,
        prose: Setting,
        first: Setting,
        second: Setting,
        third: Setting,
    ) -> None:
        self._module = module
        self.prose, self.first, self.second, self.third = prose, first, second, third

    def motion(self, setting: Setting, times: Sequence[float] | Array | None = None) -> Array:
        """States at `times`, or at the end, by the Lagrangian form."""
        return _reference(self._module.rhs, setting.y0, setting, times)

    @cached_property
    def end(self) -> Array:
        """State of the prose's scene at its end, by Taylor series."""
        return taylor(self._module, self.prose.params, self.prose.y0, [0, self.prose.duration])[-1]

    @cached_property
    def references_apart(self) -> float:
        """Largest difference between two references' angles there."""
        scene = self.prose
        other = extrapolated(self._module, scene.params, scene.y0, [0, scene.duration])[-1]
        return float(np.abs(other - self.end)[:2].max())

    @cached_property
    def disagreement(self) -> float:
        """Largest difference between the two forms' angles at the end of the prose's scene.

        Hamilton's is run by DOP853, Lagrange's by Taylor series: neither is a method that
        the report compares.
        """
        module, prose = self._module, self.prose
        start = module.hamiltonian_state(0.0, prose.y0, prose.params)
        end = _reference(module.rhs_hamiltonian, start, prose, None)[:, -1]
        return float(np.abs(end - module.hamiltonian_state(0.0, self.end, prose.params))[:2].max())

    def stepped(self, method: str, h: float, setting: Setting | None = None) -> Array:
        """States at every step of a method with fixed step."""
        return self._integrated(method, h, setting or self.prose, None)

    def error(self, method: str, h: float) -> float:
        """Largest error of an angle at the end of the prose's scene, in rad."""
        end = self._integrated(method, h, self.prose, [self.prose.duration])[:, -1]
        return float(np.abs(end[:2] - self.end[:2]).max())

    def _integrated(
        self, method: str, h: float, setting: Setting, times: Sequence[float] | None
    ) -> Array:
        solution = integrate(
            self._module, (0.0, setting.duration), setting.y0, setting.params,
            method=REPORT_METHODS[method], form="lagrangian", h=h, t_eval=times,
        )  # fmt: skip
        if not solution.success:
            raise RuntimeError(f"{method} with h = {h}: {solution.message}")
        return solution.y

    def energy_change(self, states: Array, setting: Setting) -> float:
        """Largest change of energy along `states`, in parts of the energy above rest."""
        energy = self._module.energy_many(0.0, states, setting.params)
        return float(np.abs(energy_error(self._module, setting.params, energy)).max())

    def liveliness(self, setting: Setting) -> float:
        """Mean speed of the angles in the second half, in parts of the first half's."""
        times = np.linspace(0.0, setting.duration, 2001)
        speed = np.abs(self.motion(setting, times)[2:]).sum(axis=0)
        return float(speed[1001:].mean() / speed[:1000].mean())

    def calls(self, method: str, error: float) -> int:
        """Right-hand sides that a method takes to end the prose's scene within `error`."""
        scene = self.prose
        controlled = bool(load(method).b_hat)
        for k in range(MOST_TRIES):
            setting = {"rtol": 10.0**-k, "atol": 10.0**-k} if controlled else {
                "h": scene.duration / (10 * 2**k)
            }  # fmt: skip
            with ignore_predictability():
                run = integrate(
                    self._module, (0.0, scene.duration), scene.y0, scene.params, method=method,
                    form="lagrangian", t_eval=[scene.duration], **setting,
                )  # fmt: skip
            if run.success and np.abs(run.y[:, -1] - self.end).max() < error:
                return run.nfev
        raise RuntimeError(f"{method} does not come within {error} of the motion")

    def exponent(self, **changed: float) -> Mean:
        """Largest Lyapunov exponent of the prose's scene with other parameters."""
        params = dict(zip(self._module.PARAMETERS, self.prose.params, strict=True)) | changed
        return lyapunov(self._module, tuple(params.values()), self.prose.y0, 1500.0)

    def divergence(self, offset: float, duration: float) -> float:
        """By what factor `offset` in the first angle has grown after `duration`."""
        setting = Setting(self.prose.params, self.prose.y0, duration)
        moved = Setting(
            self.prose.params, (self.prose.y0[0] + offset, *self.prose.y0[1:]), duration
        )
        apart = self.motion(setting)[:, -1] - self.motion(moved)[:, -1]
        return float(np.linalg.norm(apart) / offset)


def _reference(
    rhs: object, y0: Sequence[float], setting: Setting, times: Sequence[float] | Array | None
) -> Array:
    solution = solve_ivp(
        rhs, (0.0, setting.duration), y0, method="DOP853", rtol=1e-13, atol=1e-13,
        t_eval=times, args=(setting.params,),
    )  # fmt: skip
    if not solution.success:
        raise RuntimeError(f"the reference run stopped at t = {solution.t[-1]}: {solution.message}")
    states: Array = solution.y
    return states
