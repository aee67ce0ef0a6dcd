"""What the report says of its results, in chapters 3 to 5, put to the test.

Each claim is judged by a number that anybody can compute again: ``supported``,
``contradicted``, or ``untestable`` where it has no content that a number could
decide. The reference is SciPy's DOP853 at its tightest, and what two forms of
the equations disagree on is taken as its error.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from types import ModuleType

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from solvers.catalogue import load
from solvers.fixed_step import fixed_step

Array = NDArray[np.float64]

#: What the report's figures call its methods.
METHODS = {"RK1": "rk1", "RK2": "midpoint", "RK3": "rk3", "RK4": "rk4"}


@dataclass(frozen=True)
class Claim:
    """A claim of the report, in our words, and what was found.

    Attributes
    ----------
    id : str
        Section, and a letter.
    claim : str
        What is said there.
    verdict : {"supported", "contradicted", "untestable"}
        What was found.
    number : str
        The number that says so, or why there is none.
    """

    id: str
    claim: str
    verdict: str
    number: str


@dataclass(frozen=True)
class Setting:
    """Parameters, initial state (q, q̇) and duration, as numbers."""

    params: tuple[float, ...]
    y0: tuple[float, ...]
    duration: float


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
        self, module: ModuleType, prose: Setting, first: Setting, second: Setting, third: Setting
    ) -> None:
        self._module = module
        self.prose, self.first, self.second, self.third = prose, first, second, third

    def motion(self, setting: Setting, times: Sequence[float] | Array | None = None) -> Array:
        """States at `times`, or at the end, by the Lagrangian form."""
        return _tightest(self._module.rhs, setting.y0, setting, times)

    @cached_property
    def end(self) -> Array:
        """State of the prose's scene at its end."""
        return self.motion(self.prose)[:, -1]

    @cached_property
    def disagreement(self) -> float:
        """Largest difference between the two forms' angles at the end of the prose's scene."""
        module, prose = self._module, self.prose
        start = module.hamiltonian_state(prose.y0, prose.params)
        end = _tightest(module.rhs_hamiltonian, start, prose, None)[:, -1]
        return float(np.abs(end - module.hamiltonian_state(self.end, prose.params))[:2].max())

    def stepped(self, method: str, h: float, setting: Setting | None = None) -> Array:
        """States at every step of a method with fixed step."""
        scene = setting or self.prose
        steps = round(scene.duration / h)

        def rhs(t: float, y: Sequence[float]) -> Sequence[float]:
            derivative: tuple[float, ...] = self._module.rhs(t, y, scene.params)
            return derivative

        return fixed_step(rhs, scene.y0, scene.duration / steps, steps, load(METHODS[method]))

    def error(self, method: str, h: float) -> float:
        """Largest error of an angle at the end of the prose's scene, in rad."""
        return float(np.abs(self.stepped(method, h)[:2, -1] - self.end[:2]).max())

    def energy_change(self, states: Array, setting: Setting) -> float:
        """Largest change of energy along `states`, in parts of the energy above rest."""
        energy = self._module.energy_many(states, setting.params)
        lowest = self._module.energy((0.0,) * len(setting.y0), setting.params)
        return float(np.abs(energy - energy[0]).max() / (energy[0] - lowest))

    def divergence(self, offset: float, duration: float) -> float:
        """By what factor `offset` in the first angle has grown after `duration`."""
        setting = Setting(self.prose.params, self.prose.y0, duration)
        moved = Setting(
            self.prose.params, (self.prose.y0[0] + offset, *self.prose.y0[1:]), duration
        )
        apart = self.motion(setting)[:, -1] - self.motion(moved)[:, -1]
        return float(np.linalg.norm(apart) / offset)


def claims(evidence: Evidence) -> list[Claim]:
    """Every claim with its verdict, in the order of the report."""
    return [*_chapter_3(evidence), *_chapter_4(evidence), *_chapter_5(evidence)]


def _chapter_3(e: Evidence) -> list[Claim]:
    shorter = np.abs(e.motion(e.first)[:2, -1] - e.end[:2]).max()
    faster = np.abs(e.motion(e.second)[:2, -1] - e.end[:2]).max()
    steps = [0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001, 5e-4, 2e-4]
    errors = [e.error("RK4", h) for h in steps]
    falling = all(a > b for a, b in pairwise(errors))
    flips = [int(np.sum(np.diff(np.sign(e.stepped("RK4", h)[0])) != 0)) for h in (0.01, 0.005)]
    methods = [e.error(name, 0.01) for name in METHODS]
    times = np.linspace(0.0, e.prose.duration, 2001)
    speed = np.abs(e.motion(e.prose, times)[2:]).sum(axis=0)
    ratio = float(speed[1001:].mean() / speed[:1000].mean())
    return [
        Claim("3.1a", "the figure of the Lagrangian belongs to m = 1 kg, l = 2 m, g = 9.81",
              _verdict(shorter < 1e-3),
              f"its program has other lengths; at 5 s its angles are {shorter:.2g} rad away"),
        Claim("3.1b", "there is less movement as time goes on", _verdict(ratio < 1),
              f"mean speed of the angles in the second half: {ratio:.2f} of the first half's"),
        Claim("3.1c", "the Mathematica solution is the exact curve", _verdict(e.disagreement == 0),
              "no closed form exists; even at the tightest tolerance two forms of the equations "
              f"differ by {e.disagreement:.1g} rad at 5 s"),
        Claim("3.2a", "the Euler-Lagrange run has the same data as the Lagrangian one",
              _verdict(faster < 1e-3),
              f"its program starts with velocities; at 5 s its angles are {faster:.2g} rad away"),
        Claim("3.2b", "the curve looks wavy because 5 s are short", "untestable",
              "the figure is lost, and no number is tied to 'wavy'"),
        Claim("3.3a", "the smaller the step, the smaller the error",
              _verdict(falling),
              f"RK4: {errors[0]:.1g} rad with h = {steps[0]} s, falling to {errors[-1]:.1g} with "
              f"{steps[-1]:g} s, where the reference's own {e.disagreement:.1g} ends the test"),
        Claim("3.3b", "with a smaller step the curves repeat more often",
              _verdict(flips[1] > flips[0]),
              f"upper rod through the vertical: {flips[0]} times with h = 0.01 s, "
              f"{flips[1]} with 0.005 s"),
        Claim("3.3c", "RK1 to RK4 give the same pattern, but oscillate differently",
              _verdict(max(methods) < 0.1),
              "no program makes RK1 to RK3; run here with h = 0.01 s they end "
              + ", ".join(f"{error:.1g}" for error in methods)
              + " rad from the motion"),
        Claim("3.3d", "Runge-Kutta is the best tool to measure the error", "untestable",
              "the rule (20) to (25) has no embedded weights and measures no error"),
    ]  # fmt: skip


def _chapter_4(e: Evidence) -> list[Claim]:
    times = np.linspace(0.0, e.prose.duration, 5001)
    turns = float(np.ptp(e.motion(e.prose, times)[1]) / (2 * np.pi))
    euler = e.stepped("RK1", 0.01)
    rough = e.stepped("RK4", 0.1)
    smooth = e.error("RK4", 0.1)
    return [
        Claim("4.1", "the pendulum moves extremely for the whole 5 s", "untestable",
              f"'extremely' has no measure; the lower rod sweeps {turns:.2f} turns"),
        Claim("4.2", "Euler's method is unsuitable for as long as 5 s",
              _verdict(e.error("RK1", 0.01) > 0.1),
              f"h = 0.01 s: energy off by {100 * e.energy_change(euler, e.prose):.0f} %, angles by "
              f"{e.error('RK1', 0.01):.2g} rad; yet 4.2 shows the Euler-Lagrange equations, "
              "which are no such method"),
        Claim("4.3", "Runge-Kutta is the best, for its curves are smooth", _verdict(smooth < 1e-3),
              f"RK4 with h = 0.1 s is as smooth ({rough.shape[1]} points), and wrong by "
              f"{smooth:.2g} rad at 5 s"),
    ]  # fmt: skip


def _chapter_5(e: Evidence) -> list[Claim]:
    growth = e.divergence(1e-9, 5.0), e.divergence(1e-9, 20.0)
    third = e.stepped("RK4", 0.01, e.third)
    third_error = np.abs(third[:2, -1] - e.motion(e.third)[:2, -1]).max()
    long_step = e.error("RK4", 0.25)
    return [
        Claim("5a", "the motion depends sensitively on its start", _verdict(growth[1] > 100),
              f"1e-9 rad has grown {growth[0]:.3g} times after 5 s, {growth[1]:.3g} after 20 s"),
        Claim("5b", "Lagrange, Hamilton and their equations are related to each other",
              _verdict(e.disagreement < 1e-8),
              f"both forms give one motion: {e.disagreement:.1g} rad apart at 5 s"),
        Claim("5c", "with the same data, Runge-Kutta beats Lagrange's and Euler's method",
              _verdict(e.first == e.second == e.prose),
              "the data differ (3.1a, 3.2a), and Lagrange's equations are what Runge-Kutta solves"),
        Claim("5d", "Euler's method suits short steps only",
              _verdict(e.error("RK1", 1e-3) > 100 * e.error("RK4", 1e-3)),
              f"h = 0.001 s: Euler is off by {e.error('RK1', 1e-3):.2g} rad, RK4 by "
              f"{e.error('RK4', 1e-3):.1g}"),
        Claim("5e", "Runge-Kutta is best for long steps as for short ones",
              _verdict(long_step < 1e-3), f"h = 0.25 s: RK4 is off by {long_step:.2g} rad"),
        Claim("5f", "the fourth-order program (h = 0.01 s, 50 s) shows the motion",
              _verdict(third_error < 1e-3),
              f"its angles at 50 s are off by {third_error:.1g} rad, its "
              f"energy by {e.energy_change(third, e.third):.1g} of what is in play"),
    ]  # fmt: skip


def _verdict(holds: bool | np.bool) -> str:
    return "supported" if holds else "contradicted"


def _tightest(
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
