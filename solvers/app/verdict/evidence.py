"""Runs of the report's scenes, for the verdicts on its claims."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from solvers.equations.energy import energy_error
from solvers.equations.module import GeneratedModule
from solvers.integration.integrate import integrate
from solvers.integration.predictability import ignore_predictability
from solvers.integration.solution import Solution
from solvers.references.extrapolation import extrapolated
from solvers.references.taylor import taylor
from solvers.runge_kutta.catalogue import load
from solvers.studies.failure_modes.lyapunov import Mean, lyapunov
from solvers.studies.work_precision.measurement import REPORT_METHODS

Array = NDArray[np.float64]
Times = Sequence[float] | Array | None


@dataclass(frozen=True)
class Setting:
    """Parameters, initial state (q, q̇) and duration, as numbers."""

    params: tuple[float, ...]
    y0: tuple[float, ...]
    duration: float


#: Largest number of tolerances or step sizes that are tried to reach an error.
MAX_ATTEMPTS = 15


@dataclass(frozen=True)
class Evidence:
    """Runs of the scenes of the prose and the three programs, computed when a claim needs them."""

    module: GeneratedModule
    prose: Setting
    first: Setting
    second: Setting
    third: Setting

    def motion(self, setting: Setting, times: Times = None) -> Array:
        """States at `times`, or at the end, by the Lagrangian form."""
        return _reference(self.module.rhs, setting.y0, setting, times)

    @cached_property
    def end(self) -> Array:
        """Final state of the prose's scene, by Taylor series."""
        return taylor(self.module, self.prose.params, self.prose.y0, [0, self.prose.duration])[-1]

    @cached_property
    def references_apart(self) -> float:
        """Largest difference between the final angles of two reference solutions."""
        scene = self.prose
        other = extrapolated(self.module, scene.params, scene.y0, [0, scene.duration])[-1]
        return float(np.abs(other - self.end)[:2].max())

    @cached_property
    def disagreement(self) -> float:
        """Largest difference between the final angles of the two forms of the equations.

        The Hamiltonian form is integrated by DOP853, the Lagrangian form by Taylor series: the
        report compares neither method.
        """
        module, prose = self.module, self.prose
        start = module.hamiltonian_state(0.0, prose.y0, prose.params)
        end = _reference(module.rhs_hamiltonian, start, prose, None)[:, -1]
        return float(np.abs(end - module.hamiltonian_state(0.0, self.end, prose.params))[:2].max())

    def stepped(
        self, method: str, h: float, setting: Setting | None = None, times: Times = None
    ) -> Array:
        """States of a method with fixed step at `times`, or after every step."""
        setting = setting or self.prose
        solution = self._run(setting, method=REPORT_METHODS[method], h=h, t_eval=times)
        if not solution.success:
            raise RuntimeError(f"{method} with h = {h}: {solution.message}")
        return solution.y

    def error(self, method: str, h: float) -> float:
        """Largest error of an angle at the end of the prose's scene, in rad."""
        end = self.stepped(method, h, times=[self.prose.duration])[:, -1]
        return float(np.abs(end[:2] - self.end[:2]).max())

    def _run(self, setting: Setting, **options: Any) -> Solution:
        run = partial(integrate, self.module, (0.0, setting.duration), setting.y0, setting.params)
        return run(form="lagrangian", **options)

    def energy_change(self, states: Array, setting: Setting) -> float:
        """Largest energy error along `states`, relative to the energy above rest."""
        energy = self.module.energy_many(0.0, states, setting.params)
        return float(np.abs(energy_error(self.module, setting.params, energy)).max())

    def speed_ratio(self, setting: Setting) -> float:
        """Mean angular speed in the second half of a run, relative to the first half."""
        times = np.linspace(0.0, setting.duration, 2001)
        speed = np.abs(self.motion(setting, times)[2:]).sum(axis=0)
        return float(speed[1001:].mean() / speed[:1000].mean())

    def calls(self, method: str, error: float) -> int:
        """Evaluations of the right-hand side until the final state is within `error`."""
        scene = self.prose
        controlled = bool(load(method).b_hat)
        for k in range(MAX_ATTEMPTS):
            tolerance, h = 10.0**-k, scene.duration / (10 * 2**k)
            setting = {"rtol": tolerance, "atol": tolerance} if controlled else {"h": h}
            with ignore_predictability():
                solution = self._run(scene, method=method, t_eval=[scene.duration], **setting)
            if solution.success and np.abs(solution.y[:, -1] - self.end).max() < error:
                return solution.nfev
        raise RuntimeError(f"{method} does not come within {error} of the motion")

    def exponent(self, **changed: float) -> Mean:
        """Largest Lyapunov exponent of the prose's scene with other parameters."""
        params = dict(zip(self.module.PARAMETERS, self.prose.params, strict=True)) | changed
        return lyapunov(self.module, tuple(params.values()), self.prose.y0, 1500.0)

    def divergence(self, offset: float, duration: float) -> float:
        """Growth factor of an initial difference in the first angle after `duration`."""
        setting = replace(self.prose, duration=duration)
        moved = replace(setting, y0=(setting.y0[0] + offset, *setting.y0[1:]))
        apart = self.motion(setting)[:, -1] - self.motion(moved)[:, -1]
        return float(np.linalg.norm(apart) / offset)


def _reference(rhs: object, y0: Sequence[float], setting: Setting, times: Times) -> Array:
    run = partial(solve_ivp, rhs, (0.0, setting.duration), y0, args=(setting.params,))
    solution = run(method="DOP853", rtol=1e-13, atol=1e-13, t_eval=times)
    if not solution.success:
        raise RuntimeError(f"the reference run stopped at t = {solution.t[-1]}: {solution.message}")
    states: Array = solution.y
    return states
