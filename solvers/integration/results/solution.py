"""Module and parameters of a solution, with which its motion shows itself."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from solvers.equations.energy import supplied_energy
from solvers.equations.module import GeneratedModule, has_function, title
from solvers.integration.problem.status import Status
from solvers.io.exports import data_frame, dataset
from solvers.io.figure_names import plain_symbol
from solvers.io.quantity import with_unit
from solvers.io.suggestion import counted
from solvers.player.playable import Playable
from solvers.player.sampled_motion import SampledMotion, sample_times
from solvers.runge_kutta.stepper import Array

#: Most coordinates in a label.
MOST_NAMES = 3


@dataclass(frozen=True)
class SolvedEquations:
    """The module of a motion, its parameters, and its states at any times.

    `states` takes times in s, in the direction of the motion, and returns rows (q, q̇); None where
    that would be another motion, as of longer numbers. `varies` is whether inputs do.
    """

    module: GeneratedModule
    params: tuple[float, ...]
    begin: float
    states: Callable[[Array], Array] | None
    varies: bool

    def sampled(self, t: Array, y: Array, end: float, note: str) -> SampledMotion:
        """The motion up to a time, at evenly spaced times if its states are known there."""
        module, size = self.module, len(self.module.STATE)
        if self.states is not None:
            t = sample_times(self.begin, end)
            y = self.states(t).T
        y = y[:size]
        energy = self._energy(t, y)
        if len(t) > 1 and t[-1] < t[0]:
            t, y, energy = t[::-1], y[:, ::-1], None if energy is None else energy[::-1]
        return SampledMotion(
            module, self.params, t, y, title(module), self._start(y[:, 0]), note, (), energy
        )

    def _start(self, y: Array) -> str:
        """The first coordinates at the start, in words."""
        units = self.module.UNITS
        names = self.module.COORDINATES[:MOST_NAMES]
        return ", ".join(
            f"{plain_symbol(name)} = {with_unit(x, units[name])}"
            for name, x in zip(names, y.tolist(), strict=False)
        )

    def _energy(self, t: Array, y: Array) -> Array | None:
        """Energy in J without that which forces have supplied; None where that is not known."""
        module = self.module
        if not has_function(module, "energy") or self.varies:
            return None
        energy = np.asarray(module.energy_many(t, y, self.params))
        if not has_function(module, "power"):
            return energy
        if self.states is None:
            return None
        return energy - supplied_energy(module, self.params, t, self.states)


@dataclass(frozen=True, repr=False)
class Solution(Playable):
    """An integrated motion, with the field names of SciPy's ``solve_ivp``.

    Attributes
    ----------
    t : ndarray of shape (n,)
        Times in s: those requested, or the start and every step's end.
    y : ndarray of shape (state, n)
        Coordinates and velocities at these times, whatever the form; in the variational form with
        their linear perturbations below.
    t_events, y_events : list of ndarray
        Times in s and states, the latter of shape (occurrences, state), of each event.
    nfev, njev : int
        Evaluations of the right-hand side and of its Jacobian.
    status : Status
        How it ended.
    message : str
        The same in words, with time and state where it ended early.
    steps, rejected : int
        Accepted and rejected steps.
    energy : ndarray of shape (n,) or None
        Energy in J at these times, if requested.
    run : str
        Method, form, step control, and backend.
    backend : str
        ``compiled``, ``python`` or ``scipy``.
    end : pair of float and ndarray
        Time in s and state where it ended, from which another integration can resume.
    units : dict of str to str
        Units of the components of the state, in their order.
    compare : callable or None
        Takes times and states and returns their estimated errors, for the next one.
    inputs : ndarray of shape (inputs, n) or None
        The inputs at these times, held ones from there on; None for a system without inputs.
    error_estimate : float or None
        Largest estimated error of any value of `y`, if an accuracy is requested. Of numbers longer
        than doubles, evaluations and steps are not counted.
    equations : SolvedEquations or None
        Module and parameters, with which the motion shows itself.
    global_error_estimate : ndarray of shape (state, n)
        Estimated errors of `y`, computed on first use, which takes longer than the run.

    Examples
    --------
    >>> import generated.single_pendulum as sp
    >>> from solvers import integrate
    >>> integrate(sp, (0, 1), {"theta": 0.1}, sp.DEFAULTS, method="rk4", h=0.01, backend="python")
    Solution: the integration reached the end of the time span
      t = 0 to 1 s, 101 times, 100 steps, 0 rejected
      Classical fourth order, lagrangian form, h = 0.01, python
      final state, t = 1 s: theta = -0.0599313 rad, theta_dot = -0.177191 rad/s
    """

    t: Array
    y: Array
    t_events: list[Array]
    y_events: list[Array]
    nfev: int
    njev: int
    status: Status
    message: str
    steps: int
    rejected: int
    run: str
    backend: str
    energy: Array | None
    end: tuple[float, Array]
    units: Mapping[str, str]
    compare: Callable[[Array, Array], Array] | None = field(default=None, compare=False)
    inputs: Array | None = None
    error_estimate: float | None = None
    equations: SolvedEquations | None = field(default=None, compare=False)

    def __getstate__(self) -> dict[str, Any]:
        """The attributes to copy or send to other processes, which modules cannot be."""
        return {k: v for k, v in vars(self).items() if k not in ("compare", "equations")}

    @cached_property
    def global_error_estimate(self) -> Array:
        """Estimated errors of `y`, of its shape, computed on first use.

        They are differences from a run by another method of high order in another form, with a
        hundredth of the tolerances (at least 1e-14). The estimate assumes that this run is much
        more accurate: true up to the time from which the motion is not predictable. Where rounding
        errors prevail, as at tolerances near 1e-13, both runs have errors of one size, and so has
        the estimate.

        Raises
        ------
        ValueError
            For a solution from a file or another process.
        """
        if self.compare is None:
            raise ValueError("a copied solution has no equations for its error: integrate again")
        return self.compare(self.t, self.y)

    @property
    def success(self) -> bool:
        """Whether it reached the end, or a terminal event."""
        return self.status in (Status.FINISHED, Status.EVENT)

    def __repr__(self) -> str:
        t_end, y_end = self.end
        # requested times need contain neither the start nor the end
        t = " to ".join(dict.fromkeys(f"{t:.6g}" for t in (*self.t[:1], *self.t[-1:])))
        components = zip(self.units.items(), y_end, strict=True)
        state = [f"{name} = {with_unit(y, unit)}" for (name, unit), y in components]
        error = "" if self.error_estimate is None else f", error below {self.error_estimate:.1e}"
        headline = self.message.partition(" (t = ")[0]  # the state follows anyway
        times, steps = counted(len(self.t), "time"), counted(self.steps, "step")
        return (
            f"Solution: {headline}\n"
            f"  {t and f't = {t} s, '}{times}, {steps}, {self.rejected} rejected\n"
            f"  {self.run}{error}\n"
            f"  final state, t = {t_end:.6g} s: {', '.join(state)}"
        )

    def sampled_motions(self) -> list[SampledMotion]:
        """The motion for pages, films and plots, integrated again at evenly spaced times.

        Numbers longer than doubles, and solutions from a file, have the times of `t` only.

        Raises
        ------
        ValueError
            For a solution from a file or another process.
        """
        if self.equations is None:
            raise ValueError("a copied solution has no equations to show it: integrate again")
        message = self.message.partition(" (t = ")[0]
        note = f"{message[:1].upper()}{message[1:]}: {self.run}."
        return [self.equations.sampled(self.t, self.y, self.end[0], note)]

    def _columns(self) -> dict[str, Array]:
        table = {"t": self.t, **dict(zip(self.units, self.y, strict=True))}
        return table if self.energy is None else {**table, "energy": self.energy}

    def to_table(self) -> Any:
        """Columns: ``t``, the components, and ``energy`` if requested.

        A ``pandas.DataFrame`` where pandas is installed, else a dict of arrays.
        """
        return data_frame(self._columns())

    def to_xarray(self) -> Any:
        """An ``xarray.Dataset`` of the components, and ``energy`` if requested, along ``t``."""
        units = {**self.units, "energy": "J"}
        columns = self._columns()
        t = columns.pop("t")
        variables = {name: ("t", y, {"units": units[name]}) for name, y in columns.items()}
        about = {"run": self.run, "status": self.status.name, "message": self.message}
        return dataset(variables, {"t": ("t", t, {"units": "s"})}, about)


class Interrupted(KeyboardInterrupt):
    """The user has interrupted an integration; `solution` holds the results up to then."""

    def __init__(self, solution: object) -> None:
        super().__init__("interrupted; its attribute `solution` holds the results so far")
        self.solution = solution
