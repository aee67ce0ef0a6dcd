"""Runs of the report's scenes, for the verdicts on its claims."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from solvers.equations.energy import energy_error
from solvers.integration.checks.predictability import ignore_predictability
from solvers.integration.integrate import integrate
from solvers.integration.results.solution import Solution
from solvers.references.extrapolation import extrapolated
from solvers.references.taylor import taylor
from solvers.runge_kutta.method_catalogue import load
from solvers.scenes.scene import Scene
from solvers.studies.failure_modes.chaos import Mean, lyapunov
from solvers.studies.work_precision.measured_curves import REPORT_METHODS

Array = NDArray[np.float64]
Times = Sequence[float] | Array | None


#: Largest number of tolerances or step sizes that are tried to reach an error.
MAX_ATTEMPTS = 15


@dataclass(frozen=True)
class Evidence:
    """Runs of the scenes of the prose and the three programs, computed when a claim needs them."""

    prose: Scene
    first: Scene
    second: Scene
    third: Scene

    def motion(self, scene: Scene, times: Times = None) -> Array:
        """States at `times`, or after every step, by the Lagrangian form and DOP853."""
        return _reference(scene.module.rhs, scene.y0, scene, times)

    @cached_property
    def end(self) -> Array:
        """Final state of the prose's scene, by Taylor series."""
        return self._final(taylor)

    @cached_property
    def references_apart(self) -> float:
        """Largest difference between the final angles of two reference solutions."""
        return float(np.abs(self._final(extrapolated) - self.end)[:2].max())

    def _final(self, reference: Callable[..., Array]) -> Array:
        scene = self.prose
        return reference(scene.module, scene.params, scene.y0, [0, scene.duration])[-1]

    @cached_property
    def disagreement(self) -> float:
        """Largest difference between the final angles of the two forms of the equations.

        The Hamiltonian form is integrated by DOP853, the Lagrangian form by Taylor series: the
        report compares neither method.
        """
        prose = self.prose
        module = prose.module
        start = module.hamiltonian_state(0.0, prose.y0, prose.params)
        end = _reference(module.rhs_hamiltonian, start, prose, None)[:, -1]
        return float(np.abs(end - module.hamiltonian_state(0.0, self.end, prose.params))[:2].max())

    def stepped(
        self, method: str, h: float, scene: Scene | None = None, times: Times = None
    ) -> Array:
        """States of a method with fixed step at `times`, or after every step."""
        solution = _run(scene or self.prose, method=REPORT_METHODS[method], h=h, t_eval=times)
        if not solution.success:
            raise RuntimeError(f"{method} with h = {h}: {solution.message}")
        return solution.y

    def error(self, method: str, h: float) -> float:
        """Largest error of an angle at the end of the prose's scene, in rad."""
        end = self.stepped(method, h, times=[self.prose.duration])[:, -1]
        return float(np.abs(end[:2] - self.end[:2]).max())

    def energy_change(self, states: Array, scene: Scene) -> float:
        """Largest energy error along `states`, relative to the energy above rest."""
        energy = scene.module.energy_many(0.0, states, scene.params)
        return float(np.abs(energy_error(scene.module, scene.params, energy)).max())

    def speed_ratio(self, scene: Scene) -> float:
        """Mean angular speed in the second half of a run, relative to the first half."""
        speed = np.abs(self.motion(scene, np.linspace(0.0, scene.duration, 2001))[2:]).sum(axis=0)
        return float(speed[1001:].mean() / speed[:1000].mean())

    def calls(self, method: str, error: float) -> int:
        """Evaluations of the right-hand side until the final state is within `error`."""
        scene = self.prose
        controlled = load(method).estimates_error
        for k in range(MAX_ATTEMPTS):
            tolerance, h = 10.0**-k, scene.duration / (10 * 2**k)
            setting = {"rtol": tolerance, "atol": tolerance} if controlled else {"h": h}
            with ignore_predictability():
                solution = _run(scene, method=method, t_eval=[scene.duration], **setting)
            if solution.success and np.abs(solution.y[:, -1] - self.end).max() < error:
                return solution.nfev
        raise RuntimeError(f"{method} does not come within {error} of the motion")

    def exponent(self, **changed: float) -> Mean:
        """Largest Lyapunov exponent of the prose's scene with other parameters."""
        module = self.prose.module
        params = dict(zip(module.PARAMETERS, self.prose.params, strict=True)) | changed
        return lyapunov(module, tuple(params.values()), self.prose.y0, 1500.0)

    def divergence(self, offset: float, duration: float) -> float:
        """Growth factor of an initial difference in the first angle after `duration`."""
        scene = replace(self.prose, duration=duration)
        moved = replace(scene, y0=(scene.y0[0] + offset, *scene.y0[1:]))
        apart = self.motion(scene)[:, -1] - self.motion(moved)[:, -1]
        return float(np.linalg.norm(apart) / offset)


@ignore_predictability()
def _run(scene: Scene, **options: Any) -> Solution:
    run = partial(integrate, scene.module, (0.0, scene.duration), scene.y0, scene.params)
    return run(form="lagrangian", **options)


def _reference(rhs: object, y0: Sequence[float], scene: Scene, times: Times) -> Array:
    run = partial(solve_ivp, rhs, (0.0, scene.duration), y0, args=(scene.params,))
    solution = run(method="DOP853", rtol=1e-13, atol=1e-13, t_eval=times)
    if not solution.success:
        raise RuntimeError(f"the reference run stopped at t = {solution.t[-1]}: {solution.message}")
    return np.asarray(solution.y)
